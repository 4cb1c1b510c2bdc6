#include "passes/geometry/depth_pyramid.h"
#include "passes/geometry/occlusion_cull.h"
#include "passes_cull_fixture.h"
#include "shared/visibility.h"

namespace candela::gpu::test::occlusion_cull {

// Depths of a picture, sample by sample, as keys hold them.
struct Depths {
  uint32_t width = 0, height = 0, samples = 1;
  std::vector<float> values;
  float farthest(glm::ivec2 first, glm::ivec2 last) const {  // of all samples of pixels in the picture; 1 without any
    float least = 1;
    for (int y = std::max(first.y, 0); y <= std::min(last.y, int(height) - 1); ++y)
      for (int x = std::max(first.x, 0); x <= std::min(last.x, int(width) - 1); ++x)
        for (uint32_t s = 0; s < samples; ++s)
          least = std::min(least, values[(size_t(y) * width + size_t(x)) * samples + s]);
    return least;
  }
  std::vector<uint64_t> keys() const {
    std::vector<uint64_t> out;
    for (const float d : values) out.push_back(uint64_t(std::bit_cast<uint32_t>(d)) << 32 | 7u);
    return out;
  }
};

class OcclusionBoxes : public PassTest {
 protected:
  // Rectangles before a far wall, and single samples that show nothing behind them.
  static Depths depths(uint32_t width, uint32_t height, uint32_t samples, Rng& rng, double holes = 0.001) {
    Depths d{width, height, samples, std::vector<float>(size_t(width) * height * samples, 0.002f)};
    for (int i = 0; i < 12; ++i) {
      const float near = float(rng.uniform(0.003, 0.1));
      const glm::ivec2 low(int(rng.uniform(-0.3, 0.9) * width), int(rng.uniform(-0.3, 0.9) * height)),
          high = low + glm::ivec2(int(0.5 * width), int(0.5 * height));
      for (int y = std::max(low.y, 0); y < std::min(high.y, int(height)); ++y)
        for (int x = std::max(low.x, 0); x < std::min(high.x, int(width)); ++x)
          for (uint32_t s = 0; s < samples; ++s) {
            float& value = d.values[(size_t(y) * width + size_t(x)) * samples + s];
            value = std::max(value, near);
          }
    }
    for (float& value : d.values)
      if (rng.uniform() < holes) value = 0;
    return d;
  }

  // The pyramid's levels, from the finest on, and a bit for each item that it does not hide.
  struct Result {
    std::vector<std::vector<float>> levels;
    std::vector<glm::uvec2> sizes;
    std::vector<bool> visible;
    shared::OcclusionReport report{};
  };
  Result test(const Depths& d, const std::vector<shared::Item>& items, const glm::dmat4& clip_from_relative,
              bool hides = true) {
    imports.clear();
    std::vector<shared::CullGroup> groups = cull_groups({uint32_t(items.size())});
    for (shared::CullGroup& g : groups) g.hides = hides;
    const size_t words = groups.size() * shared::cull_mask_words;
    std::vector<uint32_t> all(words, 0), none(words, 0);
    for (uint32_t i = 0; i < items.size(); ++i) all[i / 32] |= 1u << (i % 32);
    const Buffer item_buffer = upload(items, "items"), group_buffer = upload(groups, "groups"),
                 key_buffer = upload(d.keys(), "keys"), kept = upload(all, "kept"), first = upload(none, "first");
    shared::FrameConstants frame{};
    frame.items = item_buffer.address();
    frame.clip_from_relative = glm::mat4(clip_from_relative);
    frame.size_px = {d.width, d.height};
    const Buffer constants = upload(std::vector{frame}, "constants");

    GraphBuilder builder;
    SceneInputs scene;
    scene.constants = import(builder, constants, "constants");
    scene.items = import(builder, item_buffer, "items");
    scene.cull_groups = import(builder, group_buffer, "groups");
    scene.cull_group_count = uint32_t(groups.size());
    DepthPyramid::In in{scene.constants, {{}, import(builder, key_buffer, "keys")}, d.width, d.height, d.samples};
    const DepthPyramid::Out pyramid = add(builder, DepthPyramid{}, in);
    OcclusionCull::In tested{scene, import(builder, kept, "kept"), import(builder, first, "first"), pyramid.pyramid};
    tested.reports = true;
    const OcclusionCull::Out out = add(builder, OcclusionCull{}, tested);
    const BufferHandle visible = read_words(builder, "visible", out.visible, words * 4);
    const ImageDesc desc = std::get<ImageDesc>(builder.resources()[size_t(pyramid.pyramid.resource)].desc);
    Result result;
    uint64_t texels = 0;
    for (uint32_t mip = 0; mip < desc.mips; ++mip) {
      result.sizes.emplace_back(mip_size(desc.width_px, mip), mip_size(desc.height_px, mip));
      texels += uint64_t(result.sizes.back().x) * result.sizes.back().y;
    }
    const BufferHandle read = add_readback(builder, "pyramid", pyramid.pyramid, texels * sizeof(float));
    const FrameRun frame_run = run_all(builder);
    const auto values = values_of<float>(*frame_run.readbacks.at(read.resource));
    size_t at = 0;
    for (const glm::uvec2 size : result.sizes) {
      const size_t count = size_t(size.x) * size.y;
      result.levels.emplace_back(values.begin() + long(at), values.begin() + long(at + count));
      at += count;
    }
    const auto bits = values_of<uint32_t>(*frame_run.readbacks.at(visible.resource));
    for (uint32_t i = 0; i < items.size(); ++i) result.visible.push_back((bits[i / 32] >> (i % 32) & 1) != 0);
    result.report = values_of<shared::OcclusionReport>(*frame_run.readbacks.at(out.report.resource))[0];
    return result;
  }

  // Where a box comes to lie, in double on the numbers that the device gets.
  struct Seen {
    bool before_near_plane = true;
    glm::dvec2 low_px{1e30}, high_px{-1e30};
    double nearest = 0;
  };
  static Seen seen(const shared::Item& item, const glm::dmat4& m, const Depths& d) {
    Seen out;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 side(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      const glm::dvec4 clip = m * glm::dvec4(glm::dvec3(item.bounds_centre) + side * glm::dvec3(item.bounds_extent), 1);
      out.before_near_plane = out.before_near_plane && clip.w > 0 && clip.z <= clip.w;
      out.nearest = std::max(out.nearest, clip.z / clip.w);
      const glm::dvec2 px = (0.5 * glm::dvec2(clip) / clip.w + 0.5) * glm::dvec2(d.width, d.height);
      out.low_px = glm::min(out.low_px, px), out.high_px = glm::max(out.high_px, px);
    }
    return out;
  }
};

// Every texel of every level is the farthest depth of all samples that it covers, with sizes that halve to odd ones.
TEST_F(OcclusionBoxes, APyramidHasTheFarthestDepthOfAllSamples) {
  Rng rng(1);
  const std::vector<shared::Item> one = {item({0, 0, -5}, glm::vec3(1), 0)};
  for (const auto& [width, height, samples] :
       {std::tuple(1u, 1u, 1u), {3u, 2u, 4u}, {9u, 70u, 1u}, {64u, 36u, 4u}, {101u, 67u, 1u}, {160u, 90u, 1u}}) {
    const Depths d = depths(width, height, samples, rng);
    const Result r = test(d, one, perspective_reversed_infinite(1, 1, 0.1));
    for (uint32_t level = 0; level < r.levels.size(); ++level) {
      const int side = 2 << level;
      const glm::uvec2 size = r.sizes[level];
      EXPECT_GE(uint64_t(size.x) * uint32_t(side), width);
      EXPECT_GE(uint64_t(size.y) * uint32_t(side), height);
      for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) {
          const glm::ivec2 first(int(x) * side, int(y) * side);
          ASSERT_EQ(r.levels[level][size_t(y) * size.x + x], d.farthest(first, first + side - 1))
              << width << "x" << height << ", level " << level << ", " << x << ", " << y;
        }
    }
    EXPECT_LE(std::max(r.sizes.back().x, r.sizes.back().y), 4u);
  }
}

// No box is hidden of which a sample may lie before the depths there; most of those behind all of them are.
TEST_F(OcclusionBoxes, HiddenBoxesLieBehindAllDepthsThatTheyCover) {
  Rng rng(2);
  for (const bool is_perspective : {true, false})
    for (const auto& [width, height, samples] : {std::tuple(160u, 90u, 1u), {61u, 45u, 4u}}) {
      const glm::dmat4 m =
          (is_perspective ? perspective_reversed_infinite(0.9, 0.6, 0.05) : orthographic_reversed(20, 14, 0.5, 60)) *
          rotation();
      Depths d = depths(width, height, samples, rng, 0.0002);
      if (!is_perspective)
        for (float& value : d.values) value = value > 0 ? std::min(0.3f + 6 * value, 0.9f) : 0;
      const std::vector<shared::Item> items = random_items(3000, rng);
      const Result r = test(d, items, m);
      size_t hidden = 0, hidden_in_picture = 0, hideable = 0, reaching = 0;
      for (size_t i = 0; i < items.size(); ++i) {
        const Seen s = seen(items[i], m, d);
        const float farthest = d.farthest(glm::ivec2(glm::clamp(glm::floor(s.low_px), -1e6, 1e6)),
                                          glm::ivec2(glm::clamp(glm::floor(s.high_px), -1e6, 1e6)));
        const bool may_hide = s.before_near_plane && s.nearest < double(farthest);
        if (!may_hide) EXPECT_TRUE(r.visible[i]) << i << ": " << s.nearest << " before " << farthest;
        const bool in_picture = s.high_px.x > 0 && s.high_px.y > 0 && s.low_px.x < width && s.low_px.y < height;
        hideable += may_hide && in_picture, hidden_in_picture += !r.visible[i] && in_picture;
        hidden += !r.visible[i];
        reaching += !s.before_near_plane;
      }
      EXPECT_GT(reaching, 100u);
      EXPECT_GT(hideable, 100u);
      EXPECT_GT(double(hidden_in_picture), 0.5 * double(hideable));
      EXPECT_EQ(r.report.kept, items.size());
      EXPECT_EQ(r.report.hidden, hidden);
      EXPECT_EQ(r.report.rest, items.size() - hidden);
    }
}

// What is no opaque or masked triangle stays, and so do bounds that are not finite.
TEST_F(OcclusionBoxes, OthersAndBoundsThatAreNotFiniteStay) {
  Rng rng(3);
  Depths d = depths(64, 36, 1, rng, 0);
  for (float& value : d.values) value = 0.9f;
  const glm::dmat4 m = perspective_reversed_infinite(0.9, 0.6, 0.05);
  std::vector<shared::Item> items;
  for (uint32_t i = 0; i < 40; ++i) {
    items.push_back(item({0, 0, -5}, glm::vec3(0.5), i));
    if (i % 5 == 0) items.back().bounds_centre[int(i / 5) % 3] = nan;
    if (i % 5 == 1) items.back().bounds_extent[int(i / 5) % 3] = nan;
    if (i % 5 == 2) items.back().bounds_centre = glm::vec3(0), items.back().bounds_extent = glm::vec3(infinite);
    if (i % 5 == 3) items.back().bounds_extent[int(i / 5) % 3] = infinite;
  }
  const Result r = test(d, items, m), others = test(d, items, m, false);
  for (uint32_t i = 0; i < 40; ++i) {
    EXPECT_EQ(r.visible[i], i % 5 != 4) << i;
    EXPECT_TRUE(others.visible[i]) << i;
  }
}

}  // namespace candela::gpu::test::occlusion_cull
