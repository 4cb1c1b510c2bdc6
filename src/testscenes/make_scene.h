#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace candela {

// Test scenes from formulas and a seed: scenes/<name>/<name>.glb is make_scene(name, 1, 0), where it is committed. The
// same arguments give the same bytes on every machine.
std::vector<std::string_view> scene_names();
std::string_view scene_description(std::string_view name);  // one line; empty for an unknown name

// Large scenes are made when they are needed instead.
bool scene_is_committed(std::string_view name);

// lights: how many lights a scene scatters that can; 0 is the scene's own choice. Errors (usage): unknown name, a light
// count for a scene with a fixed set of lights, no module that makes it; (output): the file could not be written.
Expected<std::vector<std::byte>> make_scene_bytes(const std::string& name, uint64_t seed, int lights);
bool scene_has_sky(std::string_view name);
// The sky that belongs to a scene, as a Radiance HDR; empty where none does.
Expected<std::vector<std::byte>> make_scene_sky(const std::string& name, uint64_t seed);
// A film has a look too, which `render` reads where it lies beside the scene.
bool scene_is_film(std::string_view name);

struct SceneFile {
  std::filesystem::path path;
  std::vector<std::byte> bytes;
};
// What lies beside a scene's file of that name: its sky, and of a film its sound, its look and what that names, a
// second sky or files of paths and instances.
Expected<std::vector<SceneFile>> make_files_beside(const std::string& name, uint64_t seed,
                                                   const std::filesystem::path& out);
// The scene's file and what lies beside it.
Expected<void> make_scene(const std::string& name, uint64_t seed, int lights, const std::filesystem::path& out);
std::filesystem::path sky_beside(std::filesystem::path scene);

}  // namespace candela
