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
// A film has a look too, which `render` reads where it lies beside the scene, and names two skies that it blends.
bool scene_is_film(std::string_view name);
// The look of a film in a file of that name; empty where the scene is none.
Expected<std::string> make_scene_look(const std::string& name, const std::filesystem::path& out);
// The scene's file, and beside it its sky where it has one: sky_beside(out); of a film also look and second sky.
Expected<void> make_scene(const std::string& name, uint64_t seed, int lights, const std::filesystem::path& out);
std::filesystem::path sky_beside(std::filesystem::path scene);
std::filesystem::path night_sky_beside(const std::filesystem::path& scene);
std::filesystem::path film_look_beside(std::filesystem::path scene);

}  // namespace candela
