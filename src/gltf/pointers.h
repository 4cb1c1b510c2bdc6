#pragma once
#include <optional>

#include "scene/scene.h"

namespace candela::gltf {

// What a channel drives and how many numbers a key has.
struct PointerTarget {
  TargetPath path;
  int object = -1, element = -1;
  int components = 1;
};
// A pointer of the glTF object model ("/materials/3/pbrMetallicRoughness/baseColorFactor"). Nothing when it is unknown
// or names an object that is not there.
std::optional<PointerTarget> pointer_target(const Scene& scene, std::string_view pointer);

}  // namespace candela::gltf
