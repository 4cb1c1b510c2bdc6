#pragma once
#include "gltf/document.h"

namespace candela::gltf {
// The bytes that an EXT_meshopt_compression object stands for: count * byteStride. Throws Failure.
std::vector<std::byte> decompress_view(Document& document, const Json& meshopt, const std::string& path);
}  // namespace candela::gltf
