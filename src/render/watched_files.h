#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "job/job.h"
#include "scene/scene.h"

namespace candela {

// The files that a job's picture is made of, by what has to be read again when they change.
struct JobFiles {
  std::vector<std::filesystem::path> scene;  // with buffers, images and instances
  std::vector<std::filesystem::path> look;   // with the sky's images and the files of paths
  std::filesystem::path shader_folder;       // empty: shaders are built in
};
// Of a job whose scene was loaded, and what the scene's file names that is not there, or was not when the loading
// began. Where the look cannot be read now, without what it names.
JobFiles files_of(const Job& job, const Scene& scene, const std::string& shader_folder,
                  std::filesystem::file_time_type begun);

// What differs from the picture that stands.
struct FileChanges {
  bool scene = false, look = false, shaders = false;
  std::vector<std::string> names;  // of the files, without their folders
  bool any() const { return scene || look || shaders; }
};

// Remembers contents: a file that was touched, or written again as it was, has not changed.
class WatchedFiles {
 public:
  // The picture is of these as they were seen last. Those that were not seen yet are so now; written since its making
  // began, they count as changed.
  void take(const JobFiles& files, std::filesystem::file_time_type begun);
  FileChanges changes();
  std::vector<std::filesystem::path> files() const;    // but shaders
  std::vector<std::filesystem::path> folders() const;  // of shaders
  const JobFiles& of_job() const { return files_; }

 private:
  struct State {
    std::filesystem::file_time_type time;
    uintmax_t size = 0;
    bool there = false;
    Hash128 content;
  };
  static State state_of(const std::filesystem::path& file, const State* before);
  std::vector<std::filesystem::path> shaders() const;
  bool differs(const std::filesystem::path& file, FileChanges& changes);
  JobFiles files_;
  std::map<std::filesystem::path, State> taken_, seen_;  // of the picture; as they were looked at last
};

}  // namespace candela
