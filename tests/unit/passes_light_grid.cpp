#include "passes/lights/light_grid.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "base/rng.h"
#include "passes/shared/light_knobs.h"

namespace candela {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

shared::FrameConstants camera(bool perspective, float tan_y, uint32_t width, uint32_t height) {
  shared::FrameConstants c{};
  const glm::vec3 back = glm::normalize(glm::vec3(0.3f, -0.2f, 0.9f)),
                  right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back));
  c.camera_back = back, c.camera_right = right, c.camera_up = glm::cross(back, right);
  c.size_px = {width, height};
  c.tan_half = {tan_y * float(width) / float(height), tan_y};
  c.perspective = perspective;
  return c;
}
LightItem point(glm::vec3 position, float range_m) {
  LightItem l{LightType::point};
  l.position = position, l.range_m = range_m, l.intensity = glm::vec3(1);
  return l;
}
glm::dvec3 direction(Rng& rng) {
  const double z = rng.uniform(-1, 1), a = rng.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

// The cell of a point as shaders/lib/light_cells.glsl looks it up, in 32-bit arithmetic; none for a point that no cell
// holds.
std::optional<glm::uvec3> cell_of(const shared::LightGrid& g, const shared::FrameConstants& c, glm::vec3 p) {
  const glm::vec3 v(glm::dot(p, c.camera_right), glm::dot(p, c.camera_up), -glm::dot(p, c.camera_back));
  const glm::vec2 q = c.perspective ? glm::vec2(v) / v.z : glm::vec2(v), size(c.size_px);
  const glm::vec2 px = size * 0.5f + g.px_scale * glm::vec2(q.x, -q.y);
  if (c.perspective && !(v.z > 0)) return {};
  if (!(px.x >= -1 && px.y >= -1 && px.x <= size.x + 1 && px.y <= size.y + 1)) return {};
  const glm::uvec2 tile(glm::clamp(px / float(g.tile_px), glm::vec2(0), glm::vec2(g.tiles) - 1.0f));
  const int s = int(std::bit_cast<uint32_t>(std::max(v.z, 0.0f)) >> g.slice_shift) - g.slice_base;
  return glm::uvec3(tile, uint32_t(std::clamp(s, 0, int(g.slices) - 1)));
}

FrameData frame_of(std::vector<LightItem> lights) {
  FrameData data;
  data.lights = std::move(lights);
  return data;
}
LightKnobs all_lights() {
  LightKnobs knobs;
  knobs.few = 0;
  return knobs;
}

}  // namespace

// Wherever a light reaches, the point's cell lies in the light's box of cells.
TEST(LightGrid, BoxesHoldEveryPointThatALightReaches) {
  Rng rng(1);
  size_t looked = 0;
  for (const auto& [perspective, tan_y] : {std::pair(true, 0.6f), {true, 6.0f}, {true, 0.01f}, {false, 3.0f}})
    for (const LightGridKind kind : {LightGridKind::clusters, LightGridKind::tiles}) {
      const shared::FrameConstants c = camera(perspective, tan_y, 203, 117);
      std::vector<LightItem> lights;
      for (int i = 0; i < 400; ++i) {
        LightItem l =
            point(glm::vec3(direction(rng) * std::exp(rng.uniform(-3, 4))), float(std::exp(rng.uniform(-4, 3))));
        if (i % 2) {
          l.type = LightType::spot;
          l.direction = glm::vec3(direction(rng));
          l.outer_cone_rad = float(rng.uniform(0.01, 1.5707));
        }
        lights.push_back(l);
      }
      const LightGrid grid = make_light_grid(kind, frame_of(lights), c, infinity, 100, all_lights());
      ASSERT_EQ(grid.shape.reason, "");
      std::vector<const shared::LightBounds*> of(lights.size(), nullptr);
      std::vector<bool> everywhere(lights.size(), false);
      for (const shared::LightBounds& b : grid.bounds) of[b.light] = &b;
      for (size_t i = 0; i < lights.size(); ++i)
        if (!grid.globals.empty())
          everywhere[i] = grid.shape.compact ? std::binary_search(grid.globals.begin(), grid.globals.end(), uint32_t(i))
                                             : (grid.globals[i / 32] >> (i % 32) & 1) != 0;
      for (size_t i = 0; i < lights.size(); ++i)
        for (int k = 0; k < 200; ++k) {
          const LightItem& l = lights[i];
          const glm::dvec3 d = direction(rng);
          if (l.type == LightType::spot && glm::dot(d, glm::dvec3(l.direction)) < std::cos(double(l.outer_cone_rad)))
            continue;
          const glm::vec3 p(glm::dvec3(l.position) + d * (double(l.range_m) * std::sqrt(rng.uniform())));
          const auto cell = cell_of(grid.constants, c, p);
          if (!cell || everywhere[i]) continue;
          ++looked;
          ASSERT_NE(of[i], nullptr) << i;
          for (int axis = 0; axis < (kind == LightGridKind::tiles ? 2 : 3); ++axis) {
            EXPECT_GE((*cell)[axis], of[i]->first[axis]) << i << " axis " << axis;
            EXPECT_LE((*cell)[axis], of[i]->last[axis]) << i << " axis " << axis;
          }
        }
    }
  EXPECT_GT(looked, 50000u);
}

TEST(LightGrid, SaysWhyThereAreNoLists) {
  const shared::FrameConstants c = camera(true, 0.6f, 64, 64);
  const glm::vec3 ahead = -c.camera_back * 5.0f;
  const std::vector<LightItem> few(8, point(ahead, 1)), behind(20, point(-ahead, 1)),
      sun(20, LightItem{LightType::directional});
  const auto reason = [&](LightGridKind kind, const std::vector<LightItem>& lights) {
    return make_light_grid(kind, frame_of(lights), c, infinity, infinity, {}).shape.reason;
  };
  EXPECT_NE(reason(LightGridKind::none, few).find("technique"), std::string::npos);
  EXPECT_NE(reason(LightGridKind::clusters, {}).find("no lights"), std::string::npos);
  EXPECT_NE(reason(LightGridKind::clusters, few).find("8 lights"), std::string::npos);
  EXPECT_NE(reason(LightGridKind::clusters, behind).find("no light reaches"), std::string::npos);
  EXPECT_NE(reason(LightGridKind::tiles, sun).find("covers all"), std::string::npos);
  EXPECT_EQ(reason(LightGridKind::clusters, std::vector<LightItem>(9, point(ahead, 1))), "");
}

TEST(LightGrid, ListsAreMasksForFewLightsAndCompactForMany) {
  const shared::FrameConstants c = camera(true, 0.6f, 640, 360);
  const glm::vec3 ahead = -c.camera_back * 5.0f;
  const auto grid = [&](size_t count) {
    return make_light_grid(LightGridKind::clusters, frame_of(std::vector<LightItem>(count, point(ahead, 0.5f))), c, 100,
                           100, {});
  };
  EXPECT_FALSE(grid(64).shape.compact);
  EXPECT_TRUE(grid(65).shape.compact);
  // Every chunk lies inside its light's box, and together they cover it.
  const LightGrid g = grid(100);
  uint64_t cells = 0;
  for (const shared::LightBounds& b : g.bounds) {
    const glm::uvec3 n = b.last - b.first + 1u;
    cells += (uint64_t(n.x) * n.y * n.z + shared::light_chunk_cells - 1) / shared::light_chunk_cells;
  }
  EXPECT_EQ(g.chunks.size(), cells);
}

// Where the GPU finds the boxes, there is room for them whatever the places of the lights in their clusters.
TEST(LightGrid, HasRoomForLightsThatTheGpuPoses) {
  Rng rng(5);
  size_t grids = 0;
  for (int round = 0; round < 60; ++round) {
    const bool perspective = round % 5 != 0;
    const shared::FrameConstants c = camera(perspective, perspective ? 0.6f : 8.0f, 640, 360);
    const LightGridKind kind = round % 2 ? LightGridKind::tiles : LightGridKind::clusters;
    LightSet set;
    LightGroup group{&set};
    group.light = point({}, float(std::exp(rng.uniform(-2, 2))));
    const glm::dvec3 axis = direction(rng), side = glm::normalize(glm::cross(axis, glm::dvec3(0.3, 0.5, -0.2)));
    group.linear = rng.uniform(0.5, 2) * glm::dmat3(axis, side, glm::cross(axis, side));
    group.linear[1] *= rng.uniform(0.2, 1);
    group.origin = -10.0 * glm::dvec3(c.camera_back);
    FrameData posed, clustered;
    const double spread = std::exp(rng.uniform(-5, 0.5)), reach = rng.uniform(2, 30);
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 centre = reach * rng.uniform() * direction(rng);
      LightCluster cluster{glm::vec3(centre), float(spread), 0, uint32_t(set.places.size()), 20};
      for (uint32_t i = 0; i < cluster.count; ++i) {
        const glm::dvec3 p = glm::dvec3(cluster.centre) + spread * std::cbrt(rng.uniform()) * direction(rng);
        set.places.emplace_back(glm::vec3(p), 0);
        LightItem light = group.light;
        light.position = glm::vec3(group.origin + group.linear * p);
        posed.lights.push_back(light);
      }
      set.clusters.push_back(cluster);
      set.count += cluster.count;
    }
    clustered.light_groups.push_back(group);
    const LightGrid all = make_light_grid(kind, posed, c, 8, 60, all_lights()),
                    most = make_light_grid(kind, clustered, c, 8, 60, all_lights());
    ASSERT_EQ(most.shape.reason, "");
    if (!all.shape.reason.empty()) continue;
    ++grids;
    ASSERT_EQ(all.shape.cells, most.shape.cells);
    // Lights of every cell have no box of their own on the CPU.
    const auto everywhere = uint32_t(all.globals.size());
    EXPECT_LE(uint64_t(all.bounds.size()) + everywhere, most.shape.most_bounds) << round;
    EXPECT_LE(all.chunks.size(), most.shape.most_chunks) << round;
    EXPECT_LE(all.shape.most_entries, most.shape.most_entries) << round;
    EXPECT_LE(most.shape.most_entries, 32 * all.shape.most_entries) << round;
  }
  EXPECT_GT(grids, 40u);
}

TEST(LightFloor, GivesALightTheRangeAtWhichItFallsToTheFloor) {
  std::vector<LightItem> lights = {point({}, std::numeric_limits<float>::infinity()), point({}, 3),
                                   LightItem{LightType::directional}};
  lights[0].intensity = {4, 1, 2};
  lights[2].range_m = std::numeric_limits<float>::infinity();
  auto untouched = lights;
  EXPECT_EQ(apply_light_floor(untouched, 0), 0u);
  EXPECT_TRUE(std::isinf(untouched[0].range_m));
  EXPECT_EQ(apply_light_floor(lights, 0.01f), 1u);
  EXPECT_NEAR(lights[0].range_m, 20, 1e-5);  // 4 cd / 20^2 m^2 = 0.01 lux
  EXPECT_EQ(lights[1].range_m, 3);
  EXPECT_TRUE(std::isinf(lights[2].range_m));
}

}  // namespace candela
