#include "passes/surfaces/texture_knobs.h"
#include "plan/caster_hash.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

// Two opaque items, a masked and a blended one.
struct Content {
  DrawList draws;
  FrameUpload upload;
  Pose pose;
  TextureKnobs textures;

  Content() {
    draws.batches = {{.first = 0, .count = 2},
                     {.alpha = AlphaMode::mask, .first = 2, .count = 1},
                     {.alpha = AlphaMode::blend, .first = 3, .count = 1}};
    for (uint32_t i = 0; i < 4; ++i) {
      shared::Item item{};
      item.transform = item.geometry = item.material = i;
      item.index_count = 3;
      upload.items.push_back(item);
      upload.transforms.push_back({{1, 0, 0, float(i)}, {0, 1, 0, 0}, {0, 0, 1, 0}});
      upload.places.push_back({{float(i), 0, 0}, {0, 0, 0}});
      upload.geometries.push_back({.position = i});
      pose.materials.emplace_back();
    }
    pose.materials[2].alpha_mode = AlphaMode::mask;
  }
  std::optional<Hash128> hash() const { return caster_hash(draws, upload, pose, textures); }
};

}  // namespace

TEST(CasterHash, ChangesWithWhatCasts) {
  const auto same = Content().hash();
  ASSERT_TRUE(same);
  const auto changed = [&](auto change) {
    Content content;
    change(content);
    return content.hash() != same;
  };
  EXPECT_FALSE(changed([](Content&) {}));
  EXPECT_TRUE(changed([](Content& c) { c.upload.transforms[1].row0.w += 1e-6f; }));
  EXPECT_TRUE(changed([](Content& c) { c.upload.transforms[2].row0.w += 1e-6f; }));
  EXPECT_TRUE(changed([](Content& c) { c.upload.items[0].index_count = 6; }));
  EXPECT_TRUE(changed([](Content& c) { c.upload.items[0].bounds_extent.x = 1; }));
  EXPECT_TRUE(changed([](Content& c) { c.upload.geometries[0].position = 9; }));
  EXPECT_TRUE(changed([](Content& c) { c.draws.batches[0].count = 1; }));
  EXPECT_TRUE(changed([](Content& c) { c.pose.materials[2].alpha_cutoff = 0.25f; }));
  EXPECT_TRUE(changed([](Content& c) { c.pose.materials[2].base_color.w = 0.5f; }));
  EXPECT_TRUE(changed([](Content& c) { c.pose.materials[2].base_color_texture.offset.x = 0.5f; }));
  EXPECT_TRUE(changed([](Content& c) { c.textures.anisotropy = 1; }));
  // Not with what casts nothing, nor with colours, nor with the places of things in the frame's buffers.
  EXPECT_FALSE(changed([](Content& c) { c.upload.transforms[3].row0.w = 9; }));
  EXPECT_FALSE(changed([](Content& c) { c.pose.materials[0].base_color = glm::vec4(0.5f); }));
  EXPECT_FALSE(changed([](Content& c) { c.pose.materials[2].base_color.x = 0.5f; }));
  EXPECT_FALSE(changed([](Content& c) {
    std::swap(c.upload.transforms[0], c.upload.transforms[1]);
    std::swap(c.upload.items[0].transform, c.upload.items[1].transform);
  }));
}

TEST(CasterHash, ThereIsNoneOfWhatIsDeformed) {
  Content content;
  content.upload.geometries[3].flags = shared::geometry_deformed;  // blended
  EXPECT_TRUE(content.hash());
  content.upload.geometries[1].flags = shared::geometry_deformed;
  EXPECT_FALSE(content.hash());
}

namespace {
// As Content has it, wherever the camera is.
std::vector<CasterHash> hashes_of(const Content& c) {
  CasterHashes hashes;
  caster_hashes(FrameData{}, c.draws, c.upload, c.pose, hashes);
  return {hashes.items.begin(), hashes.items.end()};
}
bool same(const CasterHash& a, const CasterHash& b) {
  return a.low == b.low && a.high == b.high && a.deformed == b.deformed;
}
}  // namespace

TEST(CasterHash, OfEachThingIsOfWhatItIsAndWhereInTheWorld) {
  const std::vector<CasterHash> before = hashes_of(Content());
  ASSERT_EQ(before.size(), 4u);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < i; ++k) EXPECT_FALSE(same(before[size_t(i)], before[size_t(k)]));
  // Which of them change.
  const auto changed = [&](auto change) {
    Content content;
    change(content);
    const std::vector<CasterHash> after = hashes_of(content);
    std::vector<int> list;
    for (int i = 0; i < 4; ++i)
      if (!same(after[size_t(i)], before[size_t(i)])) list.push_back(i);
    return list;
  };
  using List = std::vector<int>;
  EXPECT_EQ(changed([](Content&) {}), List{});
  EXPECT_EQ(changed([](Content& c) { c.upload.places[1].place.x += 1e-6f; }), List{1});
  EXPECT_EQ(changed([](Content& c) { c.upload.places[1].rest.x += 1e-9f; }), List{1});
  EXPECT_EQ(changed([](Content& c) { c.upload.transforms[0].row1.y = 2; }), List{0});
  EXPECT_EQ(changed([](Content& c) { c.upload.items[0].index_count = 6; }), List{0});
  EXPECT_EQ(changed([](Content& c) { c.upload.geometries[2].position = 9; }), List{2});
  EXPECT_EQ(changed([](Content& c) { c.pose.materials[2].alpha_cutoff = 0.25f; }), List{2});
  EXPECT_EQ(changed([](Content& c) { c.upload.geometries[1].flags = shared::geometry_deformed; }), List{1});
  // Not where they are from the camera, nor what casts nothing.
  EXPECT_EQ(changed([](Content& c) {
              for (shared::Transform& t : c.upload.transforms) t.row0.w += 1, t.row2.w -= 7;
              for (shared::Item& i : c.upload.items) i.bounds_centre.x += 1;
            }),
            List{});
  EXPECT_EQ(changed([](Content& c) { c.upload.places[3].place.x += 1; }), List{});
  CasterHash some = before[0], others = before[2];
  some.add(before[2]), others.add(before[0]);
  EXPECT_TRUE(same(some, others)) << "in any order";
}

TEST(CasterHash, MapsDifferByTheirViews) {
  ViewImage image{"maps", 512, 1, {shared::View{}}};
  const Hash128 casters = *Content().hash(), key = depth_views_key(casters, image);
  EXPECT_EQ(depth_views_key(casters, image), key);
  ViewImage moved = image;
  moved.views[0].clip_from_relative[3][0] = 0.5f;
  EXPECT_NE(depth_views_key(casters, moved), key);
  moved = image, moved.size_px = 256;
  EXPECT_NE(depth_views_key(casters, moved), key);
  EXPECT_NE(depth_views_key(hash128("other"), image), key);
}

}  // namespace candela
