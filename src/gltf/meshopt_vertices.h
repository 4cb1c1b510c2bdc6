#pragma once
#include <cstddef>
#include <span>

namespace candela::gltf {

// What KHR_meshopt_compression has beyond EXT_meshopt_compression and Debian's library: version 1 of the coding of
// attributes, and the filter COLOR (Khronos, KHR_meshopt_compression, appendices A and B).
bool is_vertices_v1(std::span<const std::byte> stream);
// Fills `out`, elements of `stride` bytes (a multiple of 4 up to 256). False when the stream is damaged.
bool decode_vertices_v1(std::span<const std::byte> stream, size_t stride, std::span<std::byte> out);
// Colours of 4 channels of 8 or 16 bits, in place; stride 4 or 8.
void decode_filter_color(std::span<std::byte> out, size_t stride);

}  // namespace candela::gltf
