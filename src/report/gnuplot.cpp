#include "report/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "base/files.h"
#include "base/scratch_folder.h"
#include "base/text.h"

extern char** environ;

namespace candela {
namespace fs = std::filesystem;
namespace {

// Runs `gnuplot -d FILE` and returns what it prints; nothing when it does not end with 0.
std::optional<std::string> output_of_gnuplot(const fs::path& script) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  // Its complaints would only confuse: the report says that the plot is missing.
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::string name = script.string();
  char program[] = "gnuplot", defaults[] = "-d";
  char* arguments[] = {program, defaults, name.data(), nullptr};
  pid_t process = -1;
  const int error = posix_spawnp(&process, program, &files, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  std::string text;
  char buffer[65536];
  while (error == 0) {
    const ssize_t n = read(ends[0], buffer, sizeof buffer);
    if (n > 0) text.append(buffer, size_t(n));
    if (n == 0 || (n < 0 && errno != EINTR)) break;
  }
  close(ends[0]);
  if (error != 0) return std::nullopt;
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || text.find("</svg>") == std::string::npos) return std::nullopt;
  return text;
}

}  // namespace

bool has_gnuplot() {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path ? path : "", ':'))
    if (!folder.empty() && access((fs::path(folder) / "gnuplot").c_str(), X_OK) == 0) return true;
  return false;
}

std::optional<std::string> gnuplot_svg(const std::string& script) {
  const ScratchFolder scratch("plot");
  const fs::path file = scratch.path() / "figure.gp";
  if (!write_file_atomically(file, std::string_view(script))) return std::nullopt;
  return output_of_gnuplot(file);
}

}  // namespace candela
