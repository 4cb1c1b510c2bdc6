#include "base/scratch_folder.h"

#include <stdlib.h>

namespace candela {

ScratchFolder::ScratchFolder(std::string_view purpose) {
  std::error_code failed;
  std::string path =
      (std::filesystem::temp_directory_path(failed) / fmt::format("candela-{}-XXXXXX", purpose)).string();
  if (mkdtemp(path.data())) made_ = true;
  path_ = path;
}

ScratchFolder::~ScratchFolder() {
  if (!made_) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace candela
