#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

// A finding of the checks that need the JSON alone. code: the Khronos validator's name for it (NODE_LOOP, UNRESOLVED_REFERENCE).
struct Finding {
  bool fatal = false;   // fatal: no right picture can be made; otherwise a warning
  std::string code, path, message;
  std::string text() const { return path + ": " + message + " (" + code + ")"; }
};

// The two parts of a glTF file. For .gltf binary is empty.
struct GltfParts {
  std::span<const std::byte> json, binary;
  bool is_glb = false, has_binary = false;
};
// Splits a .glb (magic, version, lengths, chunk order and padding are checked; validator codes GLB_*), or passes .gltf through.
Expected<GltfParts> split_gltf(std::span<const std::byte> file, const std::string& name, std::vector<Finding>& findings);

// Structure, types, ranges and references of the whole document, before tinygltf sees it.
std::vector<Finding> validate_gltf(const nlohmann::json& document, const GltfParts& parts);

}  // namespace candela
