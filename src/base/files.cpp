#include "base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

namespace candela {
namespace fs = std::filesystem;

Expected<std::vector<std::byte>> read_file(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return fail(ErrorKind::input, path.string(), "cannot open: {}", std::strerror(errno));
  struct stat info {};
  if (fstat(file, &info) != 0 || S_ISDIR(info.st_mode)) {
    close(file);
    return fail(ErrorKind::input, path.string(), "is a folder, not a file");
  }
  if (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode)) {  // /dev/zero never ends
    close(file);
    return fail(ErrorKind::input, path.string(), "is a device, not a file");
  }
  std::vector<std::byte> bytes(S_ISREG(info.st_mode) ? size_t(info.st_size) : 0);
  size_t done = 0;
  for (;;) {
    if (done == bytes.size()) bytes.resize(S_ISREG(info.st_mode) ? done + 1 : done + 65536);
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

Expected<void> write_atomically(const fs::path& path, const std::function<Expected<void>(const fs::path&)>& write) {
  std::error_code absent;
  if (fs::is_symlink(path, absent)) {  // the link stays, its target is replaced
    const fs::path target = fs::weakly_canonical(path, absent);
    if (!absent && target != path) return write_atomically(target, write);
  }
  const fs::file_status status = fs::status(path, absent);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return fail(ErrorKind::output, path.string(), "is there and is no regular file; nothing is written over it");
  static std::atomic<unsigned> counter{0};
  // The ending is kept last, because image libraries choose the format by it.
  const fs::path temporary = path.parent_path() / fmt::format(".{}.{}.{}.tmp{}", path.stem().string(), getpid(),
                                                              counter++, path.extension().string());
  const auto remove_temporary = [&] {
    std::error_code ignored;
    fs::remove(temporary, ignored);
  };
  Expected<void> written;
  try {
    written = write(temporary);
  } catch (...) {
    remove_temporary();
    throw;
  }
  if (!written) {
    remove_temporary();
    return written;
  }
  const int file = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 || fsync(file) != 0) {
    const int reason = errno;
    if (file >= 0) close(file);
    remove_temporary();
    return fail(ErrorKind::output, path.string(), "cannot write: {}", std::strerror(reason));
  }
  close(file);
  if (rename(temporary.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    remove_temporary();
    return fail(ErrorKind::output, path.string(), "cannot put the finished file in place: {}", std::strerror(reason));
  }
  return {};
}

Expected<void> write_file_atomically(const fs::path& path, std::span<const std::byte> bytes) {
  return write_atomically(path, [&](const fs::path& temporary) -> Expected<void> {
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
