#define GLM_ENABLE_EXPERIMENTAL
#include "plan/lamp_faces.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <glm/gtx/component_wise.hpp>

#include "base/rng.h"
#include "math/transforms.h"

namespace candela::frame_lamp_faces {
namespace {

glm::dvec3 random_direction(Rng& rng) {
  for (;;) {
    const glm::dvec3 d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (glm::length(d) > 0.1) return glm::normalize(d);
  }
}

Lamp spot(glm::dvec3 direction, double cone_rad) {
  Lamp lamp;
  lamp.direction = direction, lamp.cone_rad = cone_rad, lamp.range_m = 20;
  return lamp;
}

// Where a view draws a point: texels from its own corner, and its depth.
glm::dvec3 drawn_at(const shared::View& view, glm::dvec3 point) {
  const glm::dvec4 clip = glm::dmat4(view.clip_from_relative) * glm::dvec4(point, 1);
  const glm::dvec2 ndc = glm::dvec2(clip) / clip.w;
  return {(ndc * 0.5 + 0.5) * glm::dvec2(view.size_px), clip.z / clip.w};
}

// The face that the shader takes: shaders/lib/lamp_shadow.glsl.
int face_of(glm::dvec3 q) {
  const glm::dvec3 a = glm::abs(q);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return 2 * axis + (q[axis] < 0 ? 1 : 0);
}

}  // namespace

TEST(LampFaces, EveryDirectionLiesInOneFaceAndInsideItsBorder) {
  Rng rng(71);
  for (const uint32_t size : {64u, 512u}) {
    Lamp lamp;
    lamp.position = {3, -2, 5};
    lamp.range_m = 100;
    shared::LampShadow shadow = lamp_shadow(lamp, size, 2048);
    std::vector<shared::View> views;
    for (int face = 0; face < 6; ++face)
      views.push_back(place_lamp_face(lamp, face, size, {{0, 0}, uint32_t(face)}, shadow));
    EXPECT_EQ(shadow.form, 1u);
    const double reach = double(shared::lamp_kernel_texels), texel = double(shadow.texel_tangent);
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 q = random_direction(rng) * rng.uniform(0.01, 90);
      const int face = face_of(q);
      for (int other = 0; other < 6; ++other) {
        const double along = glm::dot(lamp_axes(lamp, other).forward, q);
        EXPECT_EQ(other == face, along >= glm::compMax(glm::abs(q))) << "one face is the nearest axis";
      }
      // All texels of the lookup are inside of the tile.
      const LampAxes axes = lamp_axes(lamp, face);
      const double z = glm::dot(axes.forward, q);
      const glm::dvec3 drawn = drawn_at(views[size_t(face)], lamp.position + q);
      for (int c = 0; c < 2; ++c) {
        EXPECT_GE(drawn[c], reach);
        EXPECT_LE(drawn[c], size - reach);
      }
      EXPECT_NEAR(drawn.z, double(shared::lamp_near_m) / z, 1e-5 * drawn.z);
      // What the shader computes from the struct is where the view drew it.
      const glm::dvec2 tangent(glm::dot(axes.right, q) / z, -glm::dot(axes.up, q) / z);
      const glm::dvec2 at =
          glm::dvec2(shadow.tiles[face].middle_px & 0xffffu, shadow.tiles[face].middle_px >> 16) + tangent / texel;
      EXPECT_NEAR(at.x, drawn.x, 1e-2);
      EXPECT_NEAR(at.y, drawn.y, 1e-2);
      EXPECT_LT(std::max(std::abs(tangent.x), std::abs(tangent.y)), double(shadow.most_tangent))
          << "nothing is clamped";
    }
  }
}

TEST(LampFaces, ANarrowSpotHasOneMapThatHoldsItsConeAndAWideOneACube) {
  Rng rng(72);
  for (const double cone : {0.01, 0.5, 1.1}) {
    const Lamp lamp = spot(random_direction(rng), cone);
    ASSERT_EQ(lamp.faces(), 1);
    shared::LampShadow shadow = lamp_shadow(lamp, 256, 2048);
    const shared::View view = place_lamp_face(lamp, 0, 256, {}, shadow);
    const LampAxes axes = lamp_axes(lamp, 0);
    for (int i = 0; i < 100; ++i) {
      const double turn = rng.uniform(0, 6.2831853), off = std::tan(cone * rng.uniform(0, 1));
      const glm::dvec3 at =
          drawn_at(view, 7.0 * (axes.forward + off * (std::cos(turn) * axes.right + std::sin(turn) * axes.up)));
      for (int c = 0; c < 2; ++c) EXPECT_NEAR(at[c], 128, 128 - double(shared::lamp_kernel_texels));
    }
    EXPECT_LT(double(shadow.most_tangent) + double(shared::lamp_kernel_texels) * double(shadow.texel_tangent),
              lamp_tangent(lamp, 256));
  }
  EXPECT_EQ(spot({0, -1, 0}, 1.2).faces(), 6);
  EXPECT_EQ(Lamp{}.faces(), 6);
}

TEST(LampFaces, TilesNeverOverlapAndLeaveNoGap) {
  Rng rng(73);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<uint32_t> sizes;
    for (int i = 0; i < 60; ++i) sizes.push_back(64u << rng.next() % 4);
    std::ranges::sort(sizes, std::ranges::greater());
    const auto tiles = pack_lamp_tiles(sizes, 1024);
    std::vector<std::vector<bool>> taken;
    uint64_t texels = 0;
    for (size_t i = 0; i < tiles.size(); ++i) {
      ASSERT_LE(tiles[i].origin_px.x + sizes[i], 1024u);
      ASSERT_LE(tiles[i].origin_px.y + sizes[i], 1024u);
      taken.resize(std::max<size_t>(taken.size(), tiles[i].layer + 1), std::vector<bool>(16 * 16));
      for (uint32_t y = 0; y < sizes[i] / 64; ++y)
        for (uint32_t x = 0; x < sizes[i] / 64; ++x) {
          const size_t at = (tiles[i].origin_px.y / 64 + y) * 16 + tiles[i].origin_px.x / 64 + x;
          ASSERT_FALSE(taken[tiles[i].layer][at]);
          taken[tiles[i].layer][at] = true;
        }
      texels += uint64_t(sizes[i]) * sizes[i];
      EXPECT_GE(tiles[i].layer, i ? tiles[i - 1].layer : 0) << "views of a layer are neighbours";
    }
    EXPECT_EQ(taken.size(), (texels + 1024 * 1024 - 1) / (1024 * 1024));
  }
}

// A face is left out only where no point of the view lies in it within the light's range.
TEST(LampFaces, AFaceThatAPointOfTheViewLiesInIsSeen) {
  Rng rng(74);
  const glm::dmat4 clip = perspective_reversed_infinite(0.9, 0.5, 0.01);
  const FrustumPlanes planes = frustum_planes(clip);
  int unseen = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Lamp lamp;
    lamp.position = glm::dvec3(rng.uniform(-20, 20), rng.uniform(-20, 20), rng.uniform(-40, 10));
    lamp.range_m = trial % 5 ? 15 : std::numeric_limits<double>::infinity();
    if (trial % 2) lamp.direction = random_direction(rng), lamp.cone_rad = rng.uniform(0.1, 1.5);
    std::vector<bool> seen;
    for (int face = 0; face < lamp.faces(); ++face) seen.push_back(lamp_face_is_seen(lamp, face, 256, planes));
    unseen += int(std::ranges::count(seen, false));
    for (int i = 0; i < 200; ++i) {
      const double depth = rng.uniform(0.01, 60);
      const glm::dvec3 point(depth * rng.uniform(-0.9, 0.9), depth * rng.uniform(-0.5, 0.5), -depth);
      const glm::dvec3 q = point - lamp.position;
      const double away = glm::length(q);
      if (away >= lamp.range_m) continue;
      if (lamp.cone_rad > 0 && glm::dot(q, lamp.direction) < away * std::cos(lamp.cone_rad)) continue;
      EXPECT_TRUE(seen[lamp.is_cube() ? size_t(face_of(q)) : 0]);
    }
  }
  EXPECT_GT(unseen, 300);
}

TEST(LampFaces, MapsGrowWithTheLightOnTheScreenInPowersOfTwo) {
  View view;
  view.tan_x = 0.9, view.tan_y = 0.5;
  Lamp lamp;
  lamp.range_m = 5;
  uint32_t before = 512;
  for (const double away : {1.0, 10.0, 40.0, 160.0, 1e4}) {
    lamp.position = {0, 0, -away};
    const uint32_t size = lamp_size_px(lamp, view, 180, 512);
    EXPECT_LE(size, before);
    EXPECT_EQ(size & (size - 1), 0u);
    before = size;
  }
  EXPECT_EQ(before, least_lamp_px);
  lamp.range_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(lamp_size_px(lamp, view, 180, 512), 512u);
}

}  // namespace candela::frame_lamp_faces
