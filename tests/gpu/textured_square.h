#pragma once
#include <cstring>

#include "frame_fixture.h"
#include "testscenes/procedural_textures.h"

namespace candela::test {

inline constexpr int nearest = 9728, linear_mipmap_linear = 9987, nearest_mipmap_nearest = 9984;

// One sampler a texture.
inline int add_texture(GltfBuilder& b, const std::vector<std::byte>& png, int min_filter = nearest) {
  std::vector<uint8_t> bytes(png.size());
  std::memcpy(bytes.data(), png.data(), png.size());
  b.json["images"].push_back({{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}});
  const int mag_filter = min_filter == linear_mipmap_linear ? 9729 : nearest;  // linear
  b.json["samplers"].push_back({{"magFilter", mag_filter}, {"minFilter", min_filter}});
  const size_t index = b.json["images"].size() - 1;
  b.json["textures"].push_back({{"source", index}, {"sampler", index}});
  return int(index);
}
inline int add_texel(GltfBuilder& b, glm::dvec3 codes) {
  return add_texture(b, png_from(1, 1, 3, [&](double, double) { return glm::dvec4(codes / 255.0, 1); }));
}

// The square with texture coordinates, (0, 0) at the top left, and tangents along +X.
inline int add_textured_square(GltfBuilder& b, int material) {
  const int square = add_square_mesh(b, 1, material);
  Json& attributes = b.json["meshes"][size_t(square)]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 1, 1, 1, 1, 0, 0, 0});
  attributes["TANGENT"] = b.accessor<float>("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  return square;
}

}  // namespace candela::test
