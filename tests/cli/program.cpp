#include "program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

extern char** environ;

namespace candela::test {
namespace fs = std::filesystem;
namespace {

int spawn(std::vector<std::string>& arguments, int out, int err, const std::string& folder) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, err, STDERR_FILENO);
  if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  pid_t process = -1;
  if (posix_spawnp(&process, pointers[0], &files, nullptr, pointers.data(), environ) != 0) process = -1;
  posix_spawn_file_actions_destroy(&files);
  return process;
}

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

}  // namespace

Ended run_program(std::vector<std::string> arguments, const std::string& folder) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) return {};
  const int process = spawn(arguments, out[1], err[1], folder);
  close(out[1]);
  close(err[1]);
  Ended ended;
  pollfd sources[2] = {{out[0], POLLIN, 0}, {err[0], POLLIN, 0}};
  for (int open = 2; open > 0 && poll(sources, 2, -1) >= 0;)
    for (pollfd& source : sources) {
      if (source.fd < 0 || source.revents == 0) continue;
      char buffer[65536];
      const ssize_t n = read(source.fd, buffer, sizeof buffer);
      if (n > 0)
        (source.fd == out[0] ? ended.out : ended.err).append(buffer, size_t(n));
      else if (n == 0)
        source.fd = -1, --open;
    }
  close(out[0]);
  close(err[0]);
  int status = 0;
  if (process > 0 && waitpid(process, &status, 0) == process) ended.code = code_of(status);
  return ended;
}

Ended candela(std::vector<std::string> arguments, const std::string& folder) {
  arguments.insert(arguments.begin(), CANDELA_PROGRAM);
  return run_program(std::move(arguments), folder);
}

namespace {
int started_in_silence(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), CANDELA_PROGRAM);
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  const int process = spawn(arguments, nothing, nothing, "");
  close(nothing);
  return process;
}

bool killed(int process, int signal) {
  int status = 0;
  if (waitpid(process, &status, WNOHANG) == process) return false;
  kill(process, signal);
  waitpid(process, &status, 0);
  return WIFSIGNALED(status);
}
}  // namespace

int start_candela(std::vector<std::string> arguments, const std::string& out, const std::string& err) {
  arguments.insert(arguments.begin(), CANDELA_PROGRAM);
  const int to_out = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const int to_err = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const int process = spawn(arguments, to_out, to_err, "");
  close(to_out);
  close(to_err);
  return process;
}

bool candela_killed_after(std::vector<std::string> arguments, int milliseconds, int signal) {
  const int process = started_in_silence(std::move(arguments));
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  return killed(process, signal);
}

bool candela_killed_once_written(std::vector<std::string> arguments, const std::string& file, int signal) {
  const int process = started_in_silence(std::move(arguments));
  siginfo_t ended = {};
  while (!fs::exists(file) && waitid(P_PID, id_t(process), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && !ended.si_pid)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return killed(process, signal);
}

TestFolder::TestFolder() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  path_ = fs::temp_directory_path() /
          (std::string("candela-cli-") + test->test_suite_name() + "-" + test->name() + "-" + std::to_string(getpid()));
  fs::remove_all(path_);
  fs::create_directories(path_);
}
TestFolder::~TestFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string scene(const std::string& name) { return CANDELA_SOURCE_DIR "/scenes/" + name + "/" + name + ".glb"; }

}  // namespace candela::test
