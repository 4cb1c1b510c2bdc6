#pragma once
#include "gltf/accessors.h"

namespace candela::gltf {

struct DracoPrimitive {
  size_t vertex_count = 0;
  std::vector<uint32_t> index;
  std::map<std::string, std::vector<std::byte>> values;  // by semantic, packed
  std::map<std::string, Elements> attributes;            // what lies in `values`
};

// Decodes KHR_draco_mesh_compression through its module. Nothing when the module cannot be opened; `why` then says so.
// Throws Failure when the data is damaged.
std::optional<DracoPrimitive> decode_draco(Document& document, const Json& draco, const tinygltf::Primitive& primitive,
                                           const std::string& path, std::string& why);

}  // namespace candela::gltf
