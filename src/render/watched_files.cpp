#include "render/watched_files.h"

#include <algorithm>

#include "base/files.h"
#include "gltf/gltf.h"
#include "image/cube_faces.h"
#include "job/job_look.h"
#include "sky/job_sky.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

void add_once(std::vector<fs::path>& to, const fs::path& file) {
  if (!file.empty() && std::ranges::find(to, file) == to.end()) to.push_back(file);
}

}  // namespace

JobFiles files_of(const Job& job, const Scene& scene, const std::string& shader_folder, fs::file_time_type begun) {
  JobFiles files{.shader_folder = shader_folder};
  for (const PathRequest& path : job.paths) add_once(files.look, path.points), add_once(files.look, path.times);
  if (!job.look.empty()) {
    add_once(files.look, job.look);
    if (const auto look = look_of(job)) {
      const fs::path folder = fs::path(job.look).parent_path();
      for (const PathRequest& path : look->paths)
        for (const std::string& name : {path.points, path.times})
          if (!name.empty()) add_once(files.look, folder / name);
      if (const auto skies = sky_files(job, *look))
        for (const std::string& sky : *skies) {
          if (!names_cube_faces(sky)) add_once(files.look, sky);
          if (const auto faces = names_cube_faces(sky) ? cube_face_files(sky) : Expected<std::array<fs::path, 6>>())
            for (const fs::path& face : *faces) add_once(files.look, face);
        }
    }
  }
  for (const std::string& file : scene.files)
    if (std::ranges::find(files.look, fs::path(file)) == files.look.end()) add_once(files.scene, file);
  for (const fs::path& file : files_named_by(job.scene)) {
    std::error_code failed;
    const fs::file_time_type written = fs::last_write_time(file, failed);
    if (failed || written > begun) add_once(files.scene, file);
  }
  return files;
}

// A file that is as large and as old as before is taken to be the same.
WatchedFiles::State WatchedFiles::state_of(const fs::path& file, const State* before) {
  State state;
  std::error_code failed;
  state.time = fs::last_write_time(file, failed);
  if (!failed) state.size = fs::file_size(file, failed);
  if (failed) return {};
  if (before && before->there && before->time == state.time && before->size == state.size) return *before;
  const auto bytes = read_file(file);
  if (!bytes) return {};
  state.there = true;
  state.content = hash128(*bytes);
  return state;
}

std::vector<fs::path> WatchedFiles::shaders() const {
  std::vector<fs::path> files;
  std::error_code failed;
  if (files_.shader_folder.empty()) return files;
  for (fs::recursive_directory_iterator entry(files_.shader_folder, failed), end; !failed && entry != end;
       entry.increment(failed))
    if (entry->is_regular_file(failed) && !entry->path().filename().string().starts_with('.'))
      files.push_back(entry->path());
  return files;
}

std::vector<fs::path> WatchedFiles::folders() const {
  std::vector<fs::path> folders;
  std::error_code failed;
  if (files_.shader_folder.empty()) return folders;
  folders.push_back(files_.shader_folder);
  for (fs::recursive_directory_iterator entry(files_.shader_folder, failed), end; !failed && entry != end;
       entry.increment(failed))
    if (entry->is_directory(failed)) folders.push_back(entry->path());
  return folders;
}

std::vector<fs::path> WatchedFiles::files() const {
  std::vector<fs::path> files = files_.scene;
  files.insert(files.end(), files_.look.begin(), files_.look.end());
  return files;
}

void WatchedFiles::take(const JobFiles& files, fs::file_time_type begun) {
  files_ = files;
  std::map<fs::path, State> taken, now;
  for (const std::vector<fs::path>& some : {files_.scene, files_.look, shaders()})
    for (const fs::path& file : some) {
      const auto seen = seen_.find(file);
      now[file] = seen == seen_.end() ? state_of(file, nullptr) : seen->second;
      taken[file] = seen == seen_.end() && now[file].time > begun ? State{} : now[file];
    }
  seen_ = std::move(now);
  taken_ = std::move(taken);
}

bool WatchedFiles::differs(const fs::path& file, FileChanges& changes) {
  const auto seen = seen_.find(file);
  const State now = state_of(file, seen == seen_.end() ? nullptr : &seen->second);
  seen_[file] = now;
  const auto taken = taken_.find(file);
  const State before = taken == taken_.end() ? State{} : taken->second;
  if (now.there == before.there && now.content == before.content) return false;
  changes.names.push_back(file.filename().string());
  return true;
}

FileChanges WatchedFiles::changes() {
  FileChanges changes;
  for (const fs::path& file : files_.scene) changes.scene |= differs(file, changes);
  for (const fs::path& file : files_.look) changes.look |= differs(file, changes);
  std::vector<fs::path> sources = shaders();
  for (const auto& [file, state] : taken_)  // and those that are gone
    if (!files_.shader_folder.empty() && file.string().starts_with(files_.shader_folder.string() + "/"))
      add_once(sources, file);
  for (const fs::path& file : sources) changes.shaders |= differs(file, changes);
  return changes;
}

}  // namespace candela
