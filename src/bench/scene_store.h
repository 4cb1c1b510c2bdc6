#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "base/scratch_folder.h"
#include "bench/suite.h"

namespace candela {

// Files of generated scenes in a folder of this process, made at first use and removed at the end.
class SceneStore {
 public:
  // The file of a configuration's scene. Errors: those of make_scene.
  Expected<std::string> file_of(const Configuration& configuration);
  Expected<std::string> generated(const std::string& name, uint64_t seed, int lights);
  void remove(const std::string& file);  // one that is no longer needed
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  ScratchFolder folder_{"bench"};
};

}  // namespace candela
