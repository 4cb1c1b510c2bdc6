#pragma once
#include "gltf/document.h"

namespace candela::gltf {
inline constexpr const char *ext_meshopt = "EXT_meshopt_compression", *khr_meshopt = "KHR_meshopt_compression";
// The bytes that an object of one of these two extensions stands for: count * byteStride. Throws Failure.
std::vector<std::byte> decompress_view(Document& document, const Json& meshopt, const std::string& name,
                                       const std::string& view_path);
}  // namespace candela::gltf
