// What the device packs against what the host would make of the same texels, bit for bit.
#include "passes/post/pack.h"

#include <Imath/half.h>

#include <bit>

#include "passes_fixture.h"

namespace candela::gpu::test {
namespace {

std::vector<float> odd_values() {
  std::vector<float> values = {0.0f,      -0.0f,     1.0f,     -1.0f,     0.1f,  65504.0f,
                               65504.01f, 65519.99f, 65520.0f, -65520.0f, 1e30f, -1e30f};
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float v : {infinity, -infinity, std::numeric_limits<float>::max(), std::numeric_limits<float>::min()})
    values.push_back(v);
  // No numbers: of either sign, with a payload in the bits that halves keep, and in those that they lose.
  for (const uint32_t bits : {0x7fc00000u, 0xffc00000u, 0x7fe12345u, 0xffd00001u, 0x7fc00001u})
    values.push_back(std::bit_cast<float>(bits));
  // Denormal floats, and around the steps of denormal halves: 2^-24 and ties between two.
  for (const uint32_t bits : {1u, 0x80000001u, 0x007fffffu, 0x807fffffu}) values.push_back(std::bit_cast<float>(bits));
  for (const double steps :
       {0.25, 0.5, 0.50001, 1.0, 1.5, 2.5, 3.49999, 1022.5, 1023.0, 1023.5, 1023.99, 1024.0, 1024.5})
    for (const double sign : {1.0, -1.0}) values.push_back(float(sign * steps * 0x1p-24));
  // Ties and their neighbours above: a half has ten bits behind the point.
  for (int exponent = -14; exponent <= 15; ++exponent)
    for (const double mantissa :
         {1 + 1.0 / 2048, 1 + 3.0 / 2048, 1 + 1.0 / 2048 + 1e-7, 1 + 3.0 / 2048 - 1e-7, 2 - 1.0 / 2048})
      values.push_back(float(std::ldexp(mantissa, exponent)));
  Rng rng(7);
  for (int i = 0; i < 4000; ++i) {  // of all exponents
    const float v = std::bit_cast<float>(uint32_t(rng.next()));
    if (!std::isnan(v)) values.push_back(v);
  }
  return values;
}

std::vector<glm::vec4> odd_texels(uint32_t count) {
  const std::vector<float> values = odd_values();
  std::vector<glm::vec4> texels(count, glm::vec4(0.5f));
  for (size_t i = 0; i < values.size() && i < 4 * size_t(count); ++i) texels[i / 4][int(i % 4)] = values[i];
  return texels;
}

uint16_t half_by_host(float value, uint64_t& clamped) {
  clamped += std::isfinite(value) && std::abs(value) > 65504;
  return Imath::half(std::isfinite(value) ? std::clamp(value, -65504.0f, 65504.0f) : value).bits();
}

}  // namespace

class PackTest : public PassTest {
 protected:
  struct Packed {
    std::vector<uint32_t> words;
    shared::PackCounts counts;
  };
  Packed pack(const std::vector<glm::vec4>& texels, uint32_t width, Pack::In::Source source) {
    imports.clear();
    const uint32_t height = uint32_t(texels.size()) / width;
    const Buffer buffer = upload(texels, "texels");
    GraphBuilder builder;
    source.image = make_image(builder, import(builder, buffer, "texels"), width, height);
    source.layer = "picture";
    if (source.format == VK_FORMAT_UNDEFINED) source.format = VK_FORMAT_R32G32B32A32_SFLOAT;
    const Pack::Out out = add(builder, Pack{}, Pack::In{{source}, width, height});
    const FrameRun frame = run_all(builder);
    Packed packed;
    if (source.packing) packed.words = values_of<uint32_t>(*frame.readbacks.at(out.buffers[0].resource));
    packed.counts = values_of<shared::PackCounts>(*frame.readbacks.at(out.counts.resource)).at(0);
    return packed;
  }
  static const std::byte* at(const Packed& packed, const PackLayout& layout, uint32_t c, uint32_t y) {
    return reinterpret_cast<const std::byte*>(packed.words.data()) + c * layout.plane_bytes + y * layout.row_bytes;
  }
};

TEST_F(PackTest, HalvesAreThoseOfTheHost) {
  for (const uint32_t width : {61u, 60u})
    for (const float scale : {1.0f, 0.3f, 1024.0f, 1.0f / 3e5f})
      for (const uint32_t components : {4u, 3u, 1u}) {
        const std::vector<glm::vec4> texels = odd_texels(width * 23);
        const Packed packed =
            pack(texels, width, {.packing = Packing::half_planes, .components = components, .scale = scale});
        const PackLayout layout =
            pack_layout(Packing::half_planes, VK_FORMAT_R32G32B32A32_SFLOAT, components, width, 23);
        ASSERT_EQ(packed.words.size() * 4, layout.bytes);
        uint64_t clamped = 0;
        for (uint32_t y = 0; y < 23; ++y)
          for (uint32_t x = 0; x < width; ++x)
            for (uint32_t c = 0; c < components; ++c) {
              const float texel = texels[y * width + x][int(c)];
              uint16_t half = 0;
              std::memcpy(&half, at(packed, layout, c, y) + x * 2, 2);
              ASSERT_EQ(half, half_by_host(c == 3 ? texel : texel * scale, clamped))
                  << std::hex << std::bit_cast<uint32_t>(texel) << " times " << scale << ", channel " << c;
            }
        EXPECT_EQ(packed.counts.clamped, clamped);
        EXPECT_GT(clamped, 0u);
        EXPECT_EQ(packed.counts.nonfinite, 0u) << "nobody asked";
      }
}

TEST_F(PackTest, FloatsKeepTheirBits) {
  constexpr uint32_t width = 61;
  const std::vector<glm::vec4> texels = odd_texels(width * 23);
  const Packed packed = pack(texels, width, {.packing = Packing::float_planes, .scale = 0.3f});
  const PackLayout layout = pack_layout(Packing::float_planes, VK_FORMAT_R32G32B32A32_SFLOAT, 4, width, 23);
  ASSERT_EQ(packed.words.size() * 4, layout.bytes);
  for (uint32_t y = 0; y < 23; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < 4; ++c)
        ASSERT_EQ(std::memcmp(at(packed, layout, c, y) + x * 4, &texels[y * width + x][int(c)], 4), 0) << x << " " << y;
}

TEST_F(PackTest, DepthEndsAtTheBackground) {
  constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<glm::vec4> texels;
  for (const float z : {0.0f, 1.0f, 9.99e9f, 1e10f, 1.01e10f, infinity, nan, -2.0f, -infinity})
    texels.push_back(glm::vec4(z));
  const uint32_t width = uint32_t(texels.size());
  const Packed packed =
      pack(texels, width, {.packing = Packing::float_planes, .components = 1, .look = true, .depth = true});
  for (size_t i = 0; i < texels.size(); ++i) {
    const float z = texels[i].x, expected = z >= 1e10f ? 1e10f : z;
    EXPECT_EQ(packed.words[i], std::bit_cast<uint32_t>(expected)) << z;
  }
  EXPECT_EQ(packed.counts.nonfinite, 1u);
  EXPECT_EQ(~packed.counts.first_from_end, 6u);
}

TEST_F(PackTest, PixelsThatAreNotFiniteAreCountedAndTheFirstIsFound) {
  constexpr uint32_t width = 61, height = 23;
  constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::optional<Packing> packings[] = {std::nullopt, Packing::half_planes, Packing::float_planes};
  for (const auto& packing : packings) {
    std::vector<glm::vec4> texels(width * height, glm::vec4(1e38f));
    Pack::In::Source source{.packing = packing, .look = true};
    EXPECT_EQ(pack(texels, width, source).counts.nonfinite, 0u);
    texels[1000].y = nan;
    texels[17 * width + 3] = glm::vec4(infinity, nan, 0, -infinity);
    texels[777].w = -infinity;
    Packed packed = pack(texels, width, source);
    EXPECT_EQ(packed.counts.nonfinite, 3u);
    EXPECT_EQ(~packed.counts.first_from_end, 777u);
    source.components = 3;  // a channel that no file stores
    packed = pack(texels, width, source);
    EXPECT_EQ(packed.counts.nonfinite, 2u);
    EXPECT_EQ(~packed.counts.first_from_end, 1000u);
    source.components = 1;
    packed = pack(texels, width, source);
    EXPECT_EQ(packed.counts.nonfinite, 1u);
    EXPECT_EQ(~packed.counts.first_from_end, 17 * width + 3);
    texels[0].x = nan;
    EXPECT_EQ(~pack(texels, width, source).counts.first_from_end, 0u);
    EXPECT_EQ(packed.counts.covered, 0u) << "nobody asked";
  }
}

TEST_F(PackTest, CoverTellsWhetherAnyAlphaIsThere) {
  for (const std::optional<Packing> packing : {std::optional<Packing>(), std::optional(Packing::half_planes)}) {
    std::vector<glm::vec4> texels(33 * 5, glm::vec4(1, 1, 1, 0));
    EXPECT_EQ(pack(texels, 33, {.packing = packing, .cover = true}).counts.covered, 0u);
    texels.back().w = 1e-9f;  // no half
    EXPECT_NE(pack(texels, 33, {.packing = packing, .cover = true}).counts.covered, 0u);
  }
}

// The display picture is one of whole numbers: all of them, in rows that end anywhere.
TEST_F(PackTest, DisplayPicturesKeepTheirWholeNumbers) {
  for (const uint32_t width : {256u, 57u, 58u, 59u, 1u, 2u, 3u}) {
    constexpr uint32_t height = 257;
    std::vector<glm::vec4> texels(width * height);
    for (const uint32_t most : {255u, 65535u}) {
      Rng rng(3);
      std::vector<std::array<uint32_t, 3>> codes(texels.size());
      for (size_t i = 0; i < texels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          codes[i][size_t(c)] = c == 0 && i <= most ? uint32_t(i) : uint32_t(rng.next()) % (most + 1);
          texels[i][c] = float(double(codes[i][size_t(c)]) / most);
        }
      const VkFormat format = most == 255 ? VK_FORMAT_R8G8B8A8_UNORM : VK_FORMAT_R16G16B16A16_UNORM;
      const Packed packed = pack(texels, width, {.format = format, .packing = Packing::rgb});
      const PackLayout layout = pack_layout(Packing::rgb, format, 4, width, height);
      ASSERT_EQ(packed.words.size() * 4, layout.bytes);
      for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
          for (uint32_t c = 0; c < 3; ++c) {
            uint32_t code = 0;
            const uint32_t bytes = most == 255 ? 1 : 2;
            std::memcpy(&code, at(packed, layout, 0, y) + (x * 3 + c) * bytes, bytes);
            ASSERT_EQ(code, codes[y * width + x][c]) << x << " " << y << " of width " << width;
          }
    }
  }
}

}  // namespace candela::gpu::test
