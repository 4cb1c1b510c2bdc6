#include "base/files.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <ctime>
#include <map>
#include <optional>
#include <set>

#include "base/file_uses.h"
#include "base/hash.h"
#include "base/input.h"
#include "base/prepared_file.h"
#include "base/stale_files.h"

namespace candela {
namespace fs = std::filesystem;

namespace {
struct Opened {
  int file = -1;
  uint64_t size = 0;
};
Expected<Opened> open_regular(const fs::path& path) {
  // Not blocked: a FIFO without a writer would hold the program. Opened first, so that what is checked is what is read.
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
  if (auto allowed = check_opened_file(file, path); !allowed) {
    close(file);
    return std::unexpected(allowed.error());
  }
  note_read(file, path);
  return Opened{file, uint64_t(info.st_size)};
}
}  // namespace

Expected<FileReader> FileReader::open(const fs::path& path) {
  const auto opened = open_regular(path);
  if (!opened) return std::unexpected(opened.error());
  return FileReader(opened->file, opened->size);
}
FileReader& FileReader::operator=(FileReader&& other) noexcept {
  std::swap(file_, other.file_), std::swap(size_, other.size_);
  return *this;
}
FileReader::~FileReader() {
  if (file_ >= 0) close(file_);
}
size_t FileReader::read_at(uint64_t offset, std::span<std::byte> bytes) const {
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = pread(file_, bytes.data() + done, bytes.size() - done, off_t(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += size_t(n);
  }
  return done;
}

Expected<std::vector<std::byte>> read_file(const fs::path& path) {
  const auto opened = open_regular(path);
  if (!opened) return std::unexpected(opened.error());
  const int file = opened->file;
  std::vector<std::byte> bytes(size_t(opened->size) + 1);  // one more, to see the end without growing
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
// The parts of ".candela-TARGET-MACHINE-PROCESS-RANDOM.tmp.exr"; nothing: no such name.
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

// It is no longer being written. Of other machines only the clock of the file tells: nothing is written for a week, and
// clocks of machines are not off by as much.
bool is_stale(const Temporary& temporary, int folder, const std::string& name) {
  if (temporary.machine == machine_mark()) return kill(temporary.process, 0) != 0 && errno == ESRCH;
  struct stat info {};
  constexpr int64_t week_s = 7 * 24 * 60 * 60;
  return fstatat(folder, name.c_str(), &info, AT_SYMLINK_NOFOLLOW) == 0 &&
         int64_t(time(nullptr)) - int64_t(info.st_mtime) > week_s;
}

// A name for what becomes the target once it is whole. Its length does not depend on the target's, whose ending is kept
// last, and cannot be guessed.
Expected<std::string> temporary_name(const fs::path& target) {
  uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != ssize_t(sizeof random))
    return fail(ErrorKind::output, target.string(), "the system has no random numbers: {}", std::strerror(errno));
  constexpr size_t longest_ending = 16;
  std::string ending = target.extension().string();  // programs choose the format by it
  if (ending.size() > longest_ending) ending.clear();
  return fmt::format("{}{}-{}-{}-{:016x}.tmp{}", temporary_prefix, target_mark(target), machine_mark(), getpid(),
                     random, ending);
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

// As a place that openat() and others take; -1 with the reason in errno.
int open_folder(const fs::path& folder, int how) { return open(folder.c_str(), how | O_DIRECTORY | O_CLOEXEC); }

// What is to be written over, through any links: the path of a regular file or of none. A link of the kernel's, as
// /proc/self/fd/1, may name what is no path.
Expected<fs::path> target_of(const fs::path& path) {
  struct stat given {
  }, found{};
  const bool there = stat(path.c_str(), &given) == 0;
  if (there && !S_ISREG(given.st_mode))
    return fail(ErrorKind::output, path.string(), "is there and is no regular file; nothing is written over it");
  std::error_code failed;
  if (!fs::is_symlink(path, failed)) return path;
  const fs::path target = links_followed(path);
  if (target.empty())
    return fail(ErrorKind::output, path.string(), "is a link that leads to no file: {}", std::strerror(ELOOP));
  if (there && (stat(target.c_str(), &found) != 0 || found.st_dev != given.st_dev || found.st_ino != given.st_ino))
    return fail(ErrorKind::output, path.string(), "is a link to a file that has no name; name a file");
  return target;
}

// Null: of all targets.
void remove_stale(const fs::path& folder, const std::set<std::string>* marks) {
  const int there = open_folder(folder, O_RDONLY);
  DIR* entries = there < 0 ? nullptr : fdopendir(there);
  if (!entries) {
    if (there >= 0) close(there);
    return;
  }
  while (const dirent* entry = readdir(entries)) {
    const std::string name = entry->d_name;
    const auto temporary = temporary_of(name);
    if (temporary && (!marks || marks->contains(std::string(temporary->target))) && is_stale(*temporary, there, name))
      unlinkat(there, name.c_str(), 0);
  }
  closedir(entries);
}

}  // namespace

void remove_all_stale_temporaries(const fs::path& folder) { remove_stale(folder, nullptr); }

void remove_stale_temporaries(std::span<const fs::path> targets) {
  std::map<fs::path, std::set<std::string>> marks_in;
  for (const fs::path& path : targets) {
    const auto target = target_of(path);
    if (target) marks_in[folder_of(*target)].insert(target_mark(*target));
  }
  for (const auto& [folder, marks] : marks_in) remove_stale(folder, &marks);
}

void remove_stale_temporaries(const std::set<fs::path>& folders,
                              const std::function<void(const std::function<bool(const fs::path&)>&)>& each) {
  std::error_code failed;
  std::set<std::string> marks;
  for (const fs::path& folder : folders)
    for (fs::directory_iterator at(folder.empty() ? "." : folder, failed), end; !failed && at != end;
         at.increment(failed))
      if (const std::string name = at->path().filename().string(); const auto temporary = temporary_of(name))
        marks.emplace(temporary->target);
  if (marks.empty()) return;  // the usual case
  std::vector<fs::path> targets;
  each([&](const fs::path& target) {
    if (marks.erase(target_mark(target)) > 0) targets.push_back(target);
    return marks.empty();
  });
  remove_stale_temporaries(targets);
}

PreparedFile::PreparedFile(PreparedFile&& other) noexcept { *this = std::move(other); }
PreparedFile& PreparedFile::operator=(PreparedFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(name_, other.name_);
  std::swap(temporary_, other.temporary_);
  std::swap(folder_, other.folder_);
  std::swap(file_, other.file_);
  return *this;
}
PreparedFile::~PreparedFile() {
  if (file_ >= 0) close(file_);
  if (!temporary_.empty()) unlinkat(folder_, temporary_.c_str(), 0);
  if (folder_ >= 0) close(folder_);
}

Expected<PreparedFile> PreparedFile::create(const fs::path& path, Links links) {
  const auto target = links == Links::followed ? target_of(path) : Expected<fs::path>(path);
  if (!target) return std::unexpected(target.error());
  PreparedFile prepared;
  prepared.path_ = path;
  prepared.name_ = target->filename().string();
  const fs::path folder = folder_of(*target);
  prepared.folder_ = open_folder(folder, O_PATH);
  for (int tries = 0; prepared.folder_ >= 0 && prepared.file_ < 0 && tries < 8; ++tries) {
    const auto name = temporary_name(*target);
    if (!name) return std::unexpected(name.error());
    prepared.file_ =
        openat(prepared.folder_, name->c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (prepared.file_ >= 0) prepared.temporary_ = *name;
    if (prepared.file_ < 0 && errno != EEXIST) break;
  }
  if (prepared.file_ < 0)
    return fail(ErrorKind::output, path.string(), "cannot write in {}: {}", folder.string(), std::strerror(errno));
  return prepared;
}

Expected<void> PreparedFile::failed(const char* what) const {
  return fail(ErrorKind::output, path_.string(), "{}: {}", what, std::strerror(errno));
}

Expected<void> PreparedFile::write(std::span<const std::byte> bytes) {
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failed("cannot write");
    done += size_t(n);
  }
  return {};
}

Expected<void> PreparedFile::flush() {
  if (fsync(file_) != 0) return failed("cannot write");
  note_written(file_);
  if (close(std::exchange(file_, -1)) != 0) return failed("cannot write");
  return {};
}

Expected<void> PreparedFile::put_in_place() {
  if (renameat(folder_, temporary_.c_str(), folder_, name_.c_str()) != 0)
    return failed("cannot put the finished file in place");
  temporary_.clear();
  return {};
}

Expected<PreparedFile> prepare_file(const fs::path& path, std::span<const std::byte> bytes, Links links) {
  auto prepared = PreparedFile::create(path, links);
  if (!prepared) return prepared;
  if (auto written = prepared->write(bytes); !written) return std::unexpected(written.error());
  if (auto flushed = prepared->flush(); !flushed) return std::unexpected(flushed.error());
  return prepared;
}

Expected<void> write_file_atomically(const fs::path& path, std::span<const std::byte> bytes) {
  auto prepared = prepare_file(path, bytes);
  if (!prepared) return std::unexpected(prepared.error());
  return prepared->put_in_place();
}
Expected<void> replace_file_atomically(const fs::path& path, std::span<const std::byte> bytes) {
  auto prepared = prepare_file(path, bytes, Links::replaced);
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
