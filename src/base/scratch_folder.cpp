#include "base/scratch_folder.h"

#include <unistd.h>

#include <atomic>

namespace candela {

ScratchFolder::ScratchFolder(std::string_view purpose) {
  static std::atomic<int> count = 0;
  std::error_code failed;
  path_ = std::filesystem::temp_directory_path(failed) / fmt::format("candela-{}-{}-{}", purpose, getpid(), count++);
  std::filesystem::create_directories(path_, failed);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace candela
