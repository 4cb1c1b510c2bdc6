#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "base/error.h"

namespace candela {

// A file that is whole and flushed to disk under a temporary name in its folder. Without put_in_place() nothing is
// left.
class PreparedFile {
 public:
  PreparedFile(std::filesystem::path path, std::filesystem::path temporary)
      : path_(std::move(path)), temporary_(std::move(temporary)) {}
  PreparedFile(PreparedFile&& other) noexcept;
  PreparedFile& operator=(PreparedFile&& other) noexcept;
  ~PreparedFile();
  Expected<void> put_in_place();  // by a rename: a reader sees the old file or the new one, never a part

 private:
  std::filesystem::path path_, temporary_;  // temporary_: empty once there is none
};
// Calls write(temporary path) and flushes what it wrote. On any failure the temporary file is removed and the error has
// kind output.
using WriteFile = std::function<Expected<void>(const std::filesystem::path&)>;
Expected<PreparedFile> prepare_file(const std::filesystem::path& path, const WriteFile& write);
Expected<PreparedFile> prepare_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace candela
