#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace candela {

// The whole file. Errors (input): absent, no regular file, unreadable; the message names what it is or the reason.
Expected<std::vector<std::byte>> read_file(const std::filesystem::path& path);

// A file whose parts are read as they are needed. The same errors as read_file().
class FileReader {
 public:
  static Expected<FileReader> open(const std::filesystem::path& path);
  FileReader(FileReader&& other) noexcept : file_(std::exchange(other.file_, -1)), size_(other.size_) {}
  FileReader& operator=(FileReader&& other) noexcept;
  ~FileReader();
  uint64_t size() const { return size_; }
  // As many bytes as there are, at most those of the span; fewer at the end, or where the file cannot be read.
  size_t read_at(uint64_t offset, std::span<std::byte> bytes) const;

 private:
  FileReader(int file, uint64_t size) : file_(file), size_(size) {}
  int file_ = -1;
  uint64_t size_ = 0;
};

// Removes the temporaries (base/prepared_file.h) that runs which were killed left beside these targets: those whose
// process is gone from this machine. Of other targets none, because they may be written by another machine.
void remove_stale_temporaries(std::span<const std::filesystem::path> targets);
// The same of targets in these folders that are too many to list: `each` asks of one after the other, until true says
// that no more need be asked.
void remove_stale_temporaries(
    const std::set<std::filesystem::path>& folders,
    const std::function<void(const std::function<bool(const std::filesystem::path& target)>&)>& each);

// Writes a temporary in the same folder, flushes it to disk, then renames it over `path`: a reader sees the old file or
// the new one, never a part. On any failure the temporary is removed and the error has kind output.
Expected<void> write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Expected<void> write_file_atomically(const std::filesystem::path& path, std::string_view text);
// The same for a name that the program chose (a cache, a record): a link that stands there is replaced.
Expected<void> replace_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

// $CANDELA_CACHE_DIR, else $XDG_CACHE_HOME/candela, else ~/.cache/candela; empty when none can be made (then nothing is
// cached).
std::filesystem::path cache_folder();

// The folder that holds the running program: its modules (candela_oiio.so, ...) lie there.
std::filesystem::path program_folder();

}  // namespace candela
