// KHR_meshopt_compression: version 1 of the coding of attributes, and the filter COLOR.
#include <gtest/gtest.h>

#include <cstring>

#include "gltf/meshopt_vertices.h"
#include "gltf_builder.h"

namespace candela::test {
namespace {

constexpr size_t stride = 16, count = 35;

// Made by meshoptimizer 1.3 (level 3, version 1) of elements(): with every way to write a byte, and differences of
// bytes, of pairs of bytes, and of turned words.
constexpr uint8_t stream[] = {
    0xa1, 0x38, 0xb7, 0x9d, 0x22, 0x1,  0x0,  0x1,  0x3,  0x0,  0x10, 0x50, 0xd0, 0x90, 0x90, 0xd0, 0x50, 0x10, 0x88,
    0xa8, 0xe8, 0x48, 0xc8, 0x58, 0x94, 0x84, 0x84, 0x94, 0xb4, 0xe4, 0xa4, 0xac, 0xea, 0xa2, 0x62, 0xaa, 0xfa, 0x92,
    0xb2, 0x9a, 0x89, 0x41, 0xc1, 0x45, 0xa,  0x0,  0x4d, 0xc4, 0xdc, 0x3,  0xff, 0x3,  0x7,  0x4c, 0x4c, 0x43, 0x13,
    0x3,  0xf,  0x3,  0x7,  0x0,  0x5a, 0x5a, 0x5a, 0x5a, 0x50, 0x5a, 0x5a, 0x5a, 0x5a, 0x50, 0x5a, 0x5a, 0x5a, 0x5a,
    0x50, 0x5a, 0x5a, 0x5a, 0x5a, 0x50, 0x5a, 0x5a, 0x5a, 0x5a, 0x50, 0x5a, 0x5a, 0x5a, 0x5a, 0x50, 0x5a, 0x5a, 0x5a,
    0x5a, 0x15, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xa8, 0x0,  0x0,  0x0,  0x0,  0x21, 0x21, 0x21, 0x21,
    0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21,
    0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x21, 0x15, 0x26, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66,
    0x66, 0x64, 0x0,  0x0,  0x0,  0x0,  0xe,  0x2a, 0x46, 0x62, 0x7e, 0x9a, 0xb6, 0xd2, 0xee, 0xf5, 0xd9, 0xbd, 0xa1,
    0x85, 0x69, 0x4d, 0x31, 0x15, 0x6,  0x22, 0x3e, 0x5a, 0x76, 0x92, 0xae, 0xca, 0xe6, 0xfd, 0xe1, 0xc5, 0xa9, 0x8d,
    0x71, 0x55, 0x0,  0x2,  0x18, 0x76, 0x75, 0x76, 0xc0, 0x0,  0x75, 0x76, 0x6,  0x0,  0x75, 0x76, 0x14, 0x1,  0x0,
    0x2,  0x1,  0x0,  0x2,  0x14, 0x1,  0x0,  0x2,  0x1,  0x0,  0x2,  0x0,  0x0,  0x0,  0x0,  0x0,  0x0,  0x80, 0x3f,
    0x0,  0x0,  0x60, 0xea, 0x0,  0x0,  0xc8, 0x9,  0x0,  0x0,  0x0,  0x0,  0x32, 0x1,  0x0,  0x0};

std::vector<std::byte> elements() {
  std::vector<std::byte> out(count * stride);
  for (uint32_t i = 0; i < count; ++i) {
    const float real = 1 + float(i * i) / 64;
    const uint16_t pair[] = {uint16_t(i * 300 + i % 5), uint16_t(60000 - i * 17)};
    const uint8_t bytes[] = {uint8_t(i & 1), uint8_t(i * i * 7), uint8_t(i % 11 == 0 ? 200 : 3), 9};
    const uint32_t word = (i >> 4) * 0x01000100;
    std::byte* const at = out.data() + i * stride;
    std::memcpy(at, &real, 4);
    std::memcpy(at + 4, pair, 4);
    std::memcpy(at + 8, bytes, 4);
    std::memcpy(at + 12, &word, 4);
  }
  return out;
}

TEST(MeshoptV1, DecodesWhatMeshoptimizerWrites) {
  std::vector<std::byte> out(count * stride);
  ASSERT_TRUE(gltf::is_vertices_v1(std::as_bytes(std::span(stream))));
  ASSERT_TRUE(gltf::decode_vertices_v1(std::as_bytes(std::span(stream)), stride, out));
  EXPECT_TRUE(out == elements());
}

TEST(MeshoptV1, DamageIsNoticed) {
  std::vector<std::byte> out(count * stride);
  const auto whole = std::as_bytes(std::span(stream));
  for (size_t cut = 0; cut < whole.size(); ++cut) {
    const std::vector<std::byte> shorter(whole.begin(), whole.begin() + ptrdiff_t(cut));
    EXPECT_FALSE(gltf::decode_vertices_v1(shorter, stride, out)) << cut;
  }
  std::vector<std::byte> longer(whole.begin(), whole.end());
  longer.insert(longer.begin() + 5, std::byte(0));
  EXPECT_FALSE(gltf::decode_vertices_v1(longer, stride, out));
  for (const int mode : {3, 0x10, 0x21, 0xff}) {
    std::vector<std::byte> other(whole.begin(), whole.end());
    other.back() = std::byte(mode);
    EXPECT_FALSE(gltf::decode_vertices_v1(other, stride, out)) << mode;
  }
}

// The specification's own formula.
TEST(MeshoptV1, ColoursAreOfLumaAndTwoDifferences) {
  const std::vector<int8_t> narrow = {20, 5, -3, int8_t(0x3f)};  // 6 bits: alpha 31 of 31
  std::vector<std::byte> out(4);
  std::memcpy(out.data(), narrow.data(), 4);
  gltf::decode_filter_color(out, 4);
  const int wanted[] = {(20 + 5 + 3) * 255 / 63, int(std::lround((20 - 3) * 255 / 63.0)),
                        int(std::lround((20 - 5 + 3) * 255 / 63.0)), 255};
  for (size_t c = 0; c < 4; ++c) EXPECT_EQ(int(out[c]), wanted[c]) << c;
  const uint16_t wide[] = {1000, uint16_t(-40), 70, 1 << 11 | 1};  // 12 bits
  out.resize(8);
  std::memcpy(out.data(), wide, 8);
  gltf::decode_filter_color(out, 8);
  uint16_t got[4];
  std::memcpy(got, out.data(), 8);
  const double scale = 65535 / 4095.0;
  EXPECT_EQ(got[0], std::lround((1000 - 40 - 70) * scale));
  EXPECT_EQ(got[1], std::lround((1000 + 70) * scale));
  EXPECT_EQ(got[2], std::lround((1000 + 40 - 70) * scale));
  EXPECT_EQ(got[3], std::lround(3 * scale));
}

// Positions as plain differences from zero.
GltfBuilder compressed(const char* name) {
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::vector<uint8_t> bytes = {0xa1, 0xff, 0xff, 0xff};
  for (size_t byte = 0; byte < 12; ++byte)
    for (size_t i = 0; i < 3; ++i) {
      uint32_t value = 0, before = 0;
      std::memcpy(&value, &corners[i * 3 + byte / 4], 4);
      if (i > 0) std::memcpy(&before, &corners[i * 3 - 3 + byte / 4], 4);
      bytes.push_back(uint8_t((value ^ before) >> (byte % 4 * 8)));
    }
  bytes.insert(bytes.end(), 24 - 3, 0);
  bytes.insert(bytes.end(), 3, 2);
  GltfBuilder b;
  b.use(name, true);
  const int packed = b.view(bytes);
  b.json["bufferViews"][size_t(packed)]["buffer"] = 0;
  b.json["bufferViews"].push_back(
      {{"buffer", 1},
       {"byteLength", 36},
       {"byteStride", 12},
       {"extensions",
        {{name,
          {{"buffer", 0}, {"byteLength", bytes.size()}, {"byteStride", 12}, {"mode", "ATTRIBUTES"}, {"count", 3}}}}}});
  b.json["accessors"] = {{{"bufferView", packed + 1},
                          {"componentType", 5126},
                          {"type", "VEC3"},
                          {"count", 3},
                          {"min", {0, 0, 0}},
                          {"max", {1, 1, 0}}}};
  b.primitive({{"POSITION", 0}});
  b.json["buffers"] = {{{"byteLength", b.binary.size()}}, {{"byteLength", 36}}};
  b.json["buffers"][1]["extensions"][name]["fallback"] = true;
  return b;
}

TEST(MeshoptV1, IsForTheExtensionOfKhronosAlone) {
  const auto scene = compressed("KHR_meshopt_compression").load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->extensions.at(0).support, Support::supported);
  const MeshSection& section = scene->meshes.at(0).sections.at(0);
  ASSERT_EQ(section.position.size(), 3u);
  EXPECT_EQ(section.position[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(section.position[2], glm::vec3(0, 1, 0));
  EXPECT_FALSE(compressed("EXT_meshopt_compression").load());
}

}  // namespace
}  // namespace candela::test
