#include "base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <optional>
#include <set>

#include "base/hash.h"
#include "base/prepared_file.h"

namespace candela {
namespace fs = std::filesystem;

Expected<std::vector<std::byte>> read_file(const fs::path& path) {
  // Not blocked: a FIFO without a writer would hold the program.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return fail(ErrorKind::input, path.string(), "cannot open: {}", std::strerror(errno));
  struct stat info {};
  if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) {  // /dev/zero never ends
    close(file);
    return fail(ErrorKind::input, path.string(), "is {}, not a regular file",
                S_ISDIR(info.st_mode)    ? "a folder"
                : S_ISFIFO(info.st_mode) ? "a FIFO"
                                         : "a device");
  }
  std::vector<std::byte> bytes(size_t(info.st_size) + 1);  // one more, to see the end without growing
  size_t done = 0;
  for (;;) {
    if (done == bytes.size()) bytes.resize(2 * done);
    const ssize_t n = read(file, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int reason = errno;
      close(file);
      return fail(ErrorKind::input, path.string(), "cannot read: {}", std::strerror(reason));
    }
    if (n == 0) break;
    done += size_t(n);
  }
  close(file);
  bytes.resize(done);
  return bytes;
}

namespace {

constexpr std::string_view temporary_prefix = ".candela-";
constexpr size_t target_digits = 16, machine_digits = 8;

std::string target_mark(const fs::path& target) {
  return hash128(target.filename().string()).hex().substr(0, target_digits);
}

// Links are written through: the file that they name is the target.
fs::path without_link(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_symlink(path, failed)) return path;
  const fs::path target = fs::weakly_canonical(path, failed);
  return failed ? path : target;
}

// Who may ask the kernel whether a process lives: this boot of this machine, this space of process numbers. In
// containers everybody may be process 1, and folders are shared.
std::string machine_mark() {
  static const std::string mark = [] {
    std::string who(256, '\0');
    gethostname(who.data(), who.size() - 1);
    if (const auto boot = read_file("/proc/sys/kernel/random/boot_id"))
      who.append(reinterpret_cast<const char*>(boot->data()), boot->size());
    std::error_code failed;
    who += fs::read_symlink("/proc/self/ns/pid", failed).string();
    return hash128(who).hex().substr(0, machine_digits);
  }();
  return mark;
}

struct Temporary {
  std::string_view target, machine;  // marks
  int process = 0;
};
// The parts of ".candela-TARGET-MACHINE-PROCESS-NUMBER.tmp.exr"; nothing: no such name.
std::optional<Temporary> temporary_of(std::string_view name) {
  if (!name.starts_with(temporary_prefix)) return {};
  const size_t machine = temporary_prefix.size() + target_digits + 1, process = machine + machine_digits + 1;
  if (name.size() <= process || name[machine - 1] != '-' || name[process - 1] != '-') return {};
  Temporary temporary{name.substr(temporary_prefix.size(), target_digits), name.substr(machine, machine_digits)};
  const auto read = std::from_chars(name.data() + process, name.data() + name.size(), temporary.process);
  const std::string_view rest(read.ptr, size_t(name.data() + name.size() - read.ptr));
  if (read.ec != std::errc{} || temporary.process <= 0 || !rest.starts_with('-') || rest.find(".tmp") == rest.npos)
    return {};
  return temporary;
}

// Nobody is writing it any more. Of other machines only the clock of the file tells: nothing is written for a day.
bool is_stale(const Temporary& temporary, const fs::path& file) {
  if (temporary.machine == machine_mark()) return kill(temporary.process, 0) != 0 && errno == ESRCH;
  std::error_code failed;
  const auto written = fs::last_write_time(file, failed);
  return !failed && fs::file_time_type::clock::now() - written > std::chrono::hours(24);
}

}  // namespace

fs::path temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  constexpr size_t longest_ending = 16;
  std::string ending = target.extension().string();  // programs choose the format by it
  if (ending.size() > longest_ending) ending.clear();
  return target.parent_path() / fmt::format("{}{}-{}-{}-{}.tmp{}", temporary_prefix, target_mark(target),
                                            machine_mark(), getpid(), counter++, ending);
}

void remove_stale_temporaries(std::span<const fs::path> targets) {
  std::map<fs::path, std::set<std::string>> marks_in;
  for (const fs::path& path : targets) {
    const fs::path target = without_link(path);
    marks_in[target.has_parent_path() ? target.parent_path() : fs::path(".")].insert(target_mark(target));
  }
  for (const auto& [folder, marks] : marks_in) {
    std::error_code failed, ignored;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
      const std::string name = entry->path().filename().string();
      const auto temporary = temporary_of(name);
      if (temporary && marks.contains(std::string(temporary->target)) && is_stale(*temporary, entry->path()))
        fs::remove(entry->path(), ignored);
    }
  }
}

PreparedFile::PreparedFile(PreparedFile&& other) noexcept
    : path_(std::move(other.path_)), temporary_(std::exchange(other.temporary_, {})) {}
PreparedFile& PreparedFile::operator=(PreparedFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(temporary_, other.temporary_);
  return *this;
}
PreparedFile::~PreparedFile() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

Expected<void> PreparedFile::put_in_place() {
  if (rename(temporary_.c_str(), path_.c_str()) != 0)
    return fail(ErrorKind::output, path_.string(), "cannot put the finished file in place: {}", std::strerror(errno));
  temporary_.clear();
  return {};
}

Expected<PreparedFile> prepare_file(const fs::path& path, const WriteFile& write) {
  if (const fs::path target = without_link(path); target != path) return prepare_file(target, write);
  std::error_code absent;
  const fs::file_status status = fs::status(path, absent);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return fail(ErrorKind::output, path.string(), "is there and is no regular file; nothing is written over it");
  const fs::path temporary = temporary_beside(path);
  PreparedFile prepared(path, temporary);  // removes it on every way out
  if (auto written = write(temporary); !written) return std::unexpected(written.error());
  const int file = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 || fsync(file) != 0) {
    const int reason = errno;
    if (file >= 0) close(file);
    return fail(ErrorKind::output, path.string(), "cannot write: {}", std::strerror(reason));
  }
  close(file);
  return prepared;
}

Expected<PreparedFile> prepare_file(const fs::path& path, std::span<const std::byte> bytes) {
  return prepare_file(path, [&](const fs::path& temporary) -> Expected<void> {
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) return fail(ErrorKind::output, path.string(), "cannot create: {}", std::strerror(errno));
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        const int reason = errno;
        close(file);
        return fail(ErrorKind::output, path.string(), "cannot write: {}", std::strerror(reason));
      }
      done += size_t(n);
    }
    if (close(file) != 0) return fail(ErrorKind::output, path.string(), "cannot write: {}", std::strerror(errno));
    return {};
  });
}

Expected<void> write_atomically(const fs::path& path, const std::function<Expected<void>(const fs::path&)>& write) {
  auto prepared = prepare_file(path, write);
  if (!prepared) return std::unexpected(prepared.error());
  return prepared->put_in_place();
}
Expected<void> write_file_atomically(const fs::path& path, std::span<const std::byte> bytes) {
  auto prepared = prepare_file(path, bytes);
  if (!prepared) return std::unexpected(prepared.error());
  return prepared->put_in_place();
}
Expected<void> write_file_atomically(const fs::path& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

fs::path cache_folder() {
  fs::path folder;
  if (const char* own = std::getenv("CANDELA_CACHE_DIR"); own && *own)
    folder = own;
  else if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg)
    folder = fs::path(xdg) / "candela";
  else if (const char* home = std::getenv("HOME"); home && *home)
    folder = fs::path(home) / ".cache" / "candela";
  else
    return {};
  std::error_code failed;
  fs::create_directories(folder, failed);
  return failed ? fs::path{} : folder;
}

fs::path program_folder() {
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  return failed ? fs::path(".") : self.parent_path();
}
}  // namespace candela
