#include "base/process.h"

#include <fcntl.h>
#include <pthread.h>
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

// Drivers and libraries go on with addresses that they were not given.
void end_without_addresses(int) {
  constexpr char line[] =
      "error: memory ran out in the driver or in a library: the address space is limited (ulimit -v, a container or "
      "the batch system); raise the limit, or take a smaller --size\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line, sizeof line - 1);
  _exit(int(ErrorKind::out_of_memory));
}

bool is_limited(int what, rlim_t least) {
  rlimit limit{};
  return getrlimit(__rlimit_resource(what), &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur < least;
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
  // Where memory is not limited a crash is a fault of the program, and keeps its core.
  if (is_limited(RLIMIT_AS, RLIM_INFINITY) || is_limited(RLIMIT_DATA, RLIM_INFINITY))
    for (const int fault : {SIGSEGV, SIGABRT}) std::signal(fault, end_without_addresses);
  return true;
}

int on_a_large_stack(const std::function<int()>& work) {
  constexpr size_t enough = size_t(1) << 20, large = size_t(8) << 20;
  if (!is_limited(RLIMIT_STACK, enough)) return work();
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, large);
  pthread_setattr_default_np(&attributes);  // the limit is also what threads get by default
  struct Call {
    const std::function<int()>& work;
    int code = 0;
  } call{work};
  const auto run = [](void* of) -> void* {
    Call& call = *static_cast<Call*>(of);
    call.code = call.work();
    return nullptr;
  };
  pthread_t thread{};
  const bool started = pthread_create(&thread, &attributes, run, &call) == 0;
  pthread_attr_destroy(&attributes);
  if (!started) return work();
  pthread_join(thread, nullptr);
  return call.code;
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
