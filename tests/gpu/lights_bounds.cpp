#include <numbers>

#include "lights_bounds_fixture.h"

namespace candela::gpu::test {
namespace {

using std::numbers::pi;

glm::dvec3 direction(Rng& rng) {
  const double z = rng.uniform(-1, 1), a = rng.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}
glm::dvec3 point_of(const Slab& s, double x, double y, double z, bool perspective) {
  const glm::dvec2 q = glm::mix(glm::dvec2(s.low), glm::dvec2(s.high), glm::dvec2(x, y));
  return perspective ? glm::dvec3(q * z, z) : glm::dvec3(q, z);
}
// Whether the light gives anything at a point: its range, and its cone, without any margin.
bool reaches(const LightItem& l, glm::dvec3 p) {
  const glm::dvec3 v = p - glm::dvec3(l.position);
  const double d = glm::length(v);
  if (d >= double(l.range_m)) return false;
  return l.type == LightType::point || d == 0 ||
         glm::dot(v, glm::dvec3(l.direction)) > d * std::cos(double(l.outer_cone_rad));
}

// Slabs of 16-pixel tiles (60 degrees, 1080p, anywhere in the image) of a given depth ratio, and lights of all sizes
// near them.
std::vector<SlabPair> random_pairs(size_t count, double ratio, bool spots, bool perspective, Rng& rng) {
  std::vector<SlabPair> pairs(count);
  for (SlabPair& p : pairs) {
    const double side = 16 / 935.0, z_near = std::exp(rng.uniform(-1, 7));
    const glm::dvec2 low(rng.uniform(-1.7, 1.7), rng.uniform(-1, 1));
    const double scale = perspective ? 1 : z_near;
    p.slab = {low * scale, (low + side) * scale, float(z_near), float(z_near * ratio)};
    const glm::dvec3 inside =
        point_of(p.slab, rng.uniform(), rng.uniform(), z_near * std::pow(ratio, rng.uniform()), perspective);
    const double range = z_near * std::exp(rng.uniform(-5, 1.5));
    LightItem& l = p.light;
    l.type = spots ? LightType::spot : LightType::point;
    l.range_m = float(range);
    l.position = inside + direction(rng) * (range * rng.uniform(0, 2.5));
    l.outer_cone_rad = float(rng.uniform() < 0.2 ? std::pow(10, rng.uniform(-4, -1)) : rng.uniform(0.05, pi / 2));
    // Aimed near the slab, so that the question is open.
    l.direction =
        glm::normalize(glm::normalize(inside - glm::dvec3(l.position)) + rng.uniform(0, 1.5) * direction(rng));
  }
  return pairs;
}

}  // namespace

// Points of the slab that the light reaches show that it must be listed: none of the tests may say no. And the ratio of
// what is listed to what is needed is published for cones and capsules, by its order of size.
TEST_F(LightBoundsTest, NeverMissesAndWastesLittle) {
  Rng rng(11);
  double capsule_points = 0, joint_spots = 0, aabb_spots = 0, separate_spots = 0, cone_sphere_spots = 0;
  for (const bool perspective : {true, false})
    for (const bool spots : {false, true})
      for (const double ratio : {1.0, 1.0001, 1.1, 2.0, 10.0, 1000.0}) {
        const auto pairs = random_pairs(1500, ratio, spots, perspective, rng);
        const auto bits = touches(pairs, perspective);
        size_t needed = 0, listed[4] = {};
        for (size_t i = 0; i < pairs.size(); ++i) {
          const Slab& s = pairs[i].slab;
          // Towards the light first: the slab's point nearest to its axis, then all over.
          bool found = false;
          for (int k = 0; k < 1500 && !found; ++k) {
            glm::dvec3 p = point_of(s, rng.uniform(), rng.uniform(), double(s.z_near) * std::pow(ratio, rng.uniform()),
                                    perspective);
            if (k % 3 == 0) {
              const double z =
                  std::clamp(double(pairs[i].light.position.z) + rng.uniform(-1, 1) * double(pairs[i].light.range_m),
                             double(s.z_near), double(s.z_far));
              p = point_of(s, rng.uniform(), rng.uniform(), z, perspective);
            }
            found = reaches(pairs[i].light, p);
          }
          needed += found;
          for (int test = 0; test < 4; ++test) {
            const bool yes = (bits[i] >> test & 1) != 0;
            listed[test] += yes;
            ASSERT_TRUE(yes || !found) << "test " << test << " misses pair " << i << " ratio " << ratio << " spots "
                                       << spots;
          }
        }
        ASSERT_GT(needed, 200u);
        if (perspective && ratio == 10) {
          const auto fraction = [&](int test) { return double(listed[test]) / double(needed); };
          if (!spots) capsule_points = fraction(2);
          if (spots)
            aabb_spots = fraction(0), cone_sphere_spots = fraction(1), separate_spots = fraction(2),
            joint_spots = fraction(3);
        }
      }
  RecordProperty("capsule_points", std::to_string(capsule_points));
  EXPECT_LT(capsule_points, 1.3);
  EXPECT_LT(joint_spots, 1.5);
  EXPECT_LT(joint_spots, separate_spots);
  EXPECT_LT(separate_spots, cone_sphere_spots);
  EXPECT_LT(joint_spots, aabb_spots);
}

// A ball beside a tapered capsule: at the foot of the perpendicular from its centre the capsule is still too thin; the
// ball that touches it lies further along.
TEST_F(LightBoundsTest, TheFootOfThePerpendicularIsNotTheClosestPoint) {
  SlabPair p;
  p.slab = {{-0.5f, -0.5f}, {0.5f, 0.5f}, 1, 100};
  p.light.type = LightType::point;
  p.light.position = {0, 30, 30};
  p.light.range_m = 14;  // (0, 0.5 z, z) comes nearest at z = 36: sqrt(18^2 + ...) = 13.4
  EXPECT_TRUE(reaches(p.light, {0, 18, 36}));
  EXPECT_EQ(touches({p}, true)[0], 0xfu);
}

// Cones along the view that hold one corner of a tile by a hair: the capsule's ball there is as wide as the tile's
// diagonal, and needs all of it.
TEST_F(LightBoundsTest, AConeThatHoldsACornerByAHairIsKept) {
  for (const bool perspective : {true, false}) {
    std::vector<SlabPair> pairs;
    const double half = perspective ? 0.1 : 1, tangent = 0.1, hair_m = 0.01;
    for (const double z_far : {10.0, 11.0, 20.0})
      for (const double z : {10.0, z_far})
        for (const double side_x : {-1.0, 1.0})
          for (const double side_y : {-1.0, 1.0})
            for (const double shines : {-1.0, 1.0}) {
              SlabPair p;
              p.slab = {glm::vec2(float(-half)), glm::vec2(float(half)), 10, float(z_far)};
              // Twenty metres before or behind the corner the cone is two metres wide.
              const double across = half * (perspective ? z : 1) + (20 * tangent - hair_m) / std::sqrt(2.0);
              const glm::dvec3 corner(glm::dvec2(side_x, side_y) * half * (perspective ? z : 1), z);
              p.light.type = LightType::spot;
              p.light.position = glm::vec3(float(side_x * across), float(side_y * across), float(z - 20 * shines));
              p.light.direction = {0, 0, float(shines)};
              p.light.range_m = 100;
              p.light.outer_cone_rad = float(std::atan(tangent));
              EXPECT_TRUE(reaches(p.light, corner));
              pairs.push_back(p);
            }
    const auto bits = touches(pairs, perspective);
    for (size_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(bits[i], 0xfu) << i << " perspective " << perspective;
  }
}

// Lights that only touch by a hair, and numbers near the ends of what floats hold: yes is always allowed, no only if it
// is right.
TEST_F(LightBoundsTest, ExtremeNumbersAreKept) {
  std::vector<SlabPair> pairs;
  for (const float range : {1e-20f, 1e-3f, 1.0f, 1e6f, 1e18f})
    for (const float depth : {1e-3f, 1.0f, 1e5f, 1e12f})
      for (const float angle : {1e-6f, 0.5f, 1.5707f, 1.5707964f}) {
        SlabPair p;
        p.slab = {{0.1f, -0.2f}, {0.12f, -0.18f}, depth, depth * 2};
        p.light.type = LightType::spot;
        p.light.position = glm::vec3(0.11f, -0.19f, 1.0f) * depth * 1.5f;
        p.light.direction = {0, 0, 1};
        p.light.range_m = range;
        p.light.outer_cone_rad = angle;
        pairs.push_back(p);
      }
  for (const uint32_t bits : touches(pairs, true)) EXPECT_EQ(bits, 0xfu);
}

}  // namespace candela::gpu::test
