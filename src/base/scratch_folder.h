#pragma once
#include <filesystem>
#include <string_view>

namespace candela {

// A folder of this process below the system's temporary one, removed with everything in it. Its name cannot be guessed,
// and no other user may open it. Where it cannot be made, what is written into it says so.
class ScratchFolder {
 public:
  explicit ScratchFolder(std::string_view purpose);  // a part of its name
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool made_ = false;
};

}  // namespace candela
