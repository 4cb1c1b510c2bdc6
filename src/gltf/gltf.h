#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "base/error.h"
#include "scene/scene.h"

namespace candela {

// What is going to be made of a scene. path_tracing: light goes through surfaces and bodies as their geometry is, so
// that these extensions are supported and nothing approximate; raster techniques take the file's word for a body's
// thickness.
enum class LoadFor : uint8_t { raster, direct_tracing, path_tracing };
struct LoadOptions {
  LoadFor use;
  std::string variant;   // of materials (KHR_materials_variants); empty: what primitives have without one
  bool animated = true;  // false: no animation is going to play, and what is wrong with them is no fault
  LoadOptions(LoadFor use = LoadFor::raster, std::string variant = {}, bool animated = true)
      : use(use), variant(std::move(variant)), animated(animated) {}
};

// Loads .gltf (files, base64) or .glb. Everything is checked before it is used: every index, every byte range, every
// size. A file that breaks the specification in a way that leaves no right picture is an error (kind input) whose
// message names what the Khronos validator names and whose place is "FILE: /json/path"; what can be used is used, with
// a line in Scene::warnings. An ignored extension in extensionsRequired is an error that names extension, node and
// consequence. Memory stays in proportion to the file's size.
Expected<Scene> load_gltf(const std::filesystem::path& path, const LoadOptions& options = {});

// The same from memory (fuzzing, tests); relative URIs resolve against `folder`.
Expected<Scene> load_gltf_from_memory(std::span<const std::byte> bytes, const std::string& name,
                                      const std::filesystem::path& folder, const LoadOptions& options = {});

// The files that a scene names, there or not, without loading it. What is no glTF names none.
std::vector<std::filesystem::path> files_named_by(const std::filesystem::path& path);
// Notes them as read (base/file_uses.h).
void note_scene_files(const std::filesystem::path& path);

}  // namespace candela
