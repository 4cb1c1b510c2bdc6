#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

// A finding of the checks that need the JSON alone. code: the Khronos validator's name for it (NODE_LOOP,
// UNRESOLVED_REFERENCE).
struct Finding {
  bool fatal = false;  // fatal: no right picture can be made; otherwise a warning
  std::string code, path, message;
  std::string text() const { return path + ": " + message + " (" + code + ")"; }
};

// The two parts of a glTF file. For .gltf binary is empty.
struct GltfParts {
  std::span<const std::byte> json, binary;
  bool is_glb = false, has_binary = false;
};
// Splits a .glb (magic, version, lengths, chunk order and padding are checked; validator codes GLB_*), or passes .gltf
// through.
Expected<GltfParts> split_gltf(std::span<const std::byte> file, const std::string& name,
                               std::vector<Finding>& findings);

// The document of a .gltf or of a JSON chunk. Refused (INVALID_JSON, or VALUE_NOT_IN_RANGE for numbers beyond a
// double): bad syntax, a byte order mark, bytes that are not UTF-8, a key twice in one object, nesting deeper than any
// glTF needs. Whole numbers written as 1.0 or 1e0, which glTF allows as indices and counts, come back as integers.
// Memory grows with the text.
Expected<nlohmann::json> parse_gltf_json(std::span<const std::byte> json, const std::string& name);

// Structure, types, ranges and references of the whole document, before tinygltf sees it.
// With no fatal finding: every reference resolves, every byte range lies in its buffer's byteLength (and that in the
// GLB's binary chunk or data URI), the nodes form trees, and whatever an ignored extension does not replace has the
// type that the specification gives it. Whether external files are as long as byteLength, and what the bytes hold, is
// not known here.
std::vector<Finding> validate_gltf(const nlohmann::json& document, const GltfParts& parts);

}  // namespace candela
