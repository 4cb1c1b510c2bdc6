#include "bench/scene_store.h"

#include "testscenes/make_scene.h"

namespace candela {
namespace fs = std::filesystem;

Expected<std::string> SceneStore::generated(const std::string& name, uint64_t seed, int lights) {
  std::error_code failed;
  const fs::path file = folder() / fmt::format("{}-{}-{}.glb", name, seed, lights);
  if (!fs::exists(file, failed))
    if (auto made = make_scene(name, seed, lights, file); !made) return std::unexpected(made.error());
  return file.string();
}

Expected<std::string> SceneStore::file_of(const Configuration& c) {
  if (!c.scene.generated()) return c.scene.file;
  return generated(c.scene.label, c.seed, c.lights.value_or(0));
}

void SceneStore::remove(const std::string& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
}

}  // namespace candela
