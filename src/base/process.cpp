#include "base/process.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "base/error.h"

namespace candela {
namespace {

bool file_size_is_limited = false;

// A CPU driver keeps its memory in files without a name: where they may not grow, touching them is this signal.
void end_without_mapped_memory(int) {
  constexpr char line[] =
      "error: memory that is mapped from a file could not be had: the size of files is limited (ulimit -f), or shared "
      "memory is full\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line, sizeof line - 1);
  _exit(int(file_size_is_limited ? ErrorKind::output : ErrorKind::out_of_memory));
}

}  // namespace

bool prepare_process() {
  // In rising order: open() gives the lowest number that is free.
  for (int stream = 0; stream <= 2; ++stream)
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      if (open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY) != stream) return false;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit files{};
  file_size_is_limited = getrlimit(RLIMIT_FSIZE, &files) == 0 && files.rlim_cur != RLIM_INFINITY;
  std::signal(SIGBUS, end_without_mapped_memory);
  return true;
}

std::string what_runs_out() {
  constexpr size_t driver_bytes = size_t(320) << 20;
  void* room = mmap(nullptr, driver_bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) return "memory";
  munmap(room, driver_bytes);
  const size_t wanted = 3 * std::min(std::thread::hardware_concurrency(), 16u) + 4;
  std::mutex all_are_there;
  std::vector<std::thread> threads;
  bool refused = false;
  {
    const std::lock_guard hold(all_are_there);
    try {
      while (threads.size() < wanted) threads.emplace_back([&] { const std::lock_guard wait(all_are_there); });
    } catch (const std::system_error&) {
      refused = true;
    }
  }
  for (std::thread& thread : threads) thread.join();
  return refused ? "threads" : "";
}

}  // namespace candela
