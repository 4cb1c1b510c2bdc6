#pragma once
#include <cstddef>
#include <filesystem>
#include <span>

#include "base/error.h"

namespace candela {

// Of the path of an output: a person's link is written through; a link at a name that the program chose, in a folder
// that others may write in, is somebody else's, and the file takes its place.
enum class Links { followed, replaced };

// A file that is written under a temporary name in its folder. Without put_in_place() nothing is left. The name cannot
// be guessed, and the file is made anew, relative to the folder's descriptor: a link that somebody placed there is
// never followed. Links that `path` itself goes through are followed once, when it is made.
class PreparedFile {
 public:
  // Makes the temporary, empty. Error output: the folder is not there or takes no files, `path` is no regular file.
  static Expected<PreparedFile> create(const std::filesystem::path& path, Links links = Links::followed);
  PreparedFile(PreparedFile&& other) noexcept;
  PreparedFile& operator=(PreparedFile&& other) noexcept;
  ~PreparedFile();
  int file() const { return file_; }  // open for writing until it is flushed
  Expected<void> write(std::span<const std::byte> bytes);
  Expected<void> flush();         // to disk; nothing can be written afterwards
  Expected<void> put_in_place();  // by a rename: a reader sees the old file or the new one, never a part

 private:
  PreparedFile() = default;
  Expected<void> failed(const char* what) const;  // with the reason in errno
  std::filesystem::path path_;                    // for messages
  std::string name_, temporary_;                  // in the folder; temporary_: empty once there is none
  int folder_ = -1, file_ = -1;
};
// Written whole and flushed. Errors have kind output.
Expected<PreparedFile> prepare_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                                    Links links = Links::followed);

}  // namespace candela
