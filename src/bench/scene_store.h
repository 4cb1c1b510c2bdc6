#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "bench/suite.h"

namespace candela {

// Files of generated scenes in a folder of this process, made at first use and removed at the end.
class SceneStore {
 public:
  SceneStore();
  ~SceneStore();
  SceneStore(const SceneStore&) = delete;
  SceneStore& operator=(const SceneStore&) = delete;
  // The file of a configuration's scene. Errors: those of make_scene.
  Expected<std::string> file_of(const Configuration& configuration);
  Expected<std::string> generated(const std::string& name, uint64_t seed, int lights);
  void remove(const std::string& file);  // one that is no longer needed
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace candela
