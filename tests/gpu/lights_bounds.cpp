#include <numbers>

#include "passes_fixture.h"
#include "render/light_grid.h"
#include "shared/scene.h"

namespace candela::gpu::test {
namespace {

constexpr double pi = std::numbers::pi;

struct Slab {
  glm::vec2 low, high;
  float z_near, z_far;
};
struct Pair {
  LightItem light;
  Slab slab;
};

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
  return l.type == LightType::point || d == 0 || glm::dot(v, glm::dvec3(l.direction)) > d * std::cos(double(l.outer_cone_rad));
}

// Slabs of 16-pixel tiles (60 degrees, 1080p, anywhere in the image) of a given depth ratio, and lights of all sizes near them.
std::vector<Pair> random_pairs(size_t count, double ratio, bool spots, bool perspective, Rng& rng) {
  std::vector<Pair> pairs(count);
  for (Pair& p : pairs) {
    const double side = 16 / 935.0, z_near = std::exp(rng.uniform(-1, 7));
    const glm::dvec2 low(rng.uniform(-1.7, 1.7), rng.uniform(-1, 1));
    const double scale = perspective ? 1 : z_near;
    p.slab = {low * scale, (low + side) * scale, float(z_near), float(z_near * ratio)};
    const glm::dvec3 inside = point_of(p.slab, rng.uniform(), rng.uniform(), z_near * std::pow(ratio, rng.uniform()), perspective);
    const double range = z_near * std::exp(rng.uniform(-5, 1.5));
    LightItem& l = p.light;
    l.type = spots ? LightType::spot : LightType::point;
    l.range_m = float(range);
    l.position = inside + direction(rng) * (range * rng.uniform(0, 2.5));
    l.outer_cone_rad = float(rng.uniform() < 0.2 ? std::pow(10, rng.uniform(-4, -1)) : rng.uniform(0.05, pi / 2));
    // Aimed near the slab, so that the question is open.
    l.direction = glm::normalize(glm::normalize(inside - glm::dvec3(l.position)) + rng.uniform(0, 1.5) * direction(rng));
  }
  return pairs;
}

}  // namespace

class LightBoundsTest : public PassTest {
 protected:
  // bits of the four tests for each pair. The slab is a tile's; view space is relative space here.
  std::vector<uint32_t> touches(const std::vector<Pair>& pairs, bool perspective) {
    shared::FrameConstants frame{};
    frame.camera_right = {1, 0, 0}, frame.camera_up = {0, 1, 0}, frame.camera_back = {0, 0, -1};
    frame.perspective = perspective;
    frame.size_px = {16, 16};
    frame.tan_half = {1e3f, 1e3f};  // everything is in view
    std::vector<LightItem> lights;
    std::vector<Slab> slabs;
    for (const Pair& p : pairs) lights.push_back(p.light), slabs.push_back(p.slab);
    std::vector<shared::LightBounds> bounds(pairs.size());
    const Buffer constants = upload(std::vector{frame}, "frame");
    for (size_t i = 0; i < pairs.size(); ++i) bounds[i] = inflated_bounds(pairs[i].light, frame);
    const Buffer bounds_buffer = upload(bounds, "bounds"), slab_buffer = upload(slabs, "slabs");
    GraphBuilder builder;
    const BufferHandle f = import(builder, constants, "frame"), b = import(builder, bounds_buffer, "bounds"),
                       s = import(builder, slab_buffer, "slabs");
    builder.begin_pass("touches");
    for (const BufferHandle handle : {f, b, s}) builder.read(handle, Access::compute_read, "input");
    const BufferHandle results =
        builder.write(builder.create(BufferDesc{.name = "results", .size_bytes = pairs.size() * 4}), Access::compute_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "light_touches.comp"});
    builder.end_pass([=, count = uint32_t(pairs.size())](CommandList& commands) {
      struct {
        uint64_t frame, bounds, slabs, results;
        uint32_t count, padding;
      } const push{commands.address(f), commands.address(b), commands.address(s), commands.address(results), count, 0};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(count);
    });
    const BufferHandle words = read_words(builder, "results", results, pairs.size() * 4);
    const FrameRun run = run_all(builder);
    std::vector<uint32_t> bits(pairs.size());
    std::memcpy(bits.data(), run.readbacks.at(words.resource)->bytes().data(), bits.size() * 4);
    return bits;
  }
};

// Points of the slab that the light reaches show that it must be listed: none of the tests may say no. And the ratio of what is
// listed to what is needed is what TECHNIQUES 6.4 reports, by its order of size.
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
            glm::dvec3 p = point_of(s, rng.uniform(), rng.uniform(), double(s.z_near) * std::pow(ratio, rng.uniform()), perspective);
            if (k % 3 == 0) {
              const double z = std::clamp(double(pairs[i].light.position.z) + rng.uniform(-1, 1) * double(pairs[i].light.range_m),
                                          double(s.z_near), double(s.z_far));
              p = point_of(s, rng.uniform(), rng.uniform(), z, perspective);
            }
            found = reaches(pairs[i].light, p);
          }
          needed += found;
          for (int test = 0; test < 4; ++test) {
            const bool yes = (bits[i] >> test & 1) != 0;
            listed[test] += yes;
            ASSERT_TRUE(yes || !found) << "test " << test << " misses pair " << i << " ratio " << ratio << " spots " << spots;
          }
        }
        ASSERT_GT(needed, 200u);
        if (perspective && ratio == 10) {
          const auto share = [&](int test) { return double(listed[test]) / double(needed); };
          if (!spots) capsule_points = share(2);
          if (spots) aabb_spots = share(0), cone_sphere_spots = share(1), separate_spots = share(2), joint_spots = share(3);
        }
      }
  RecordProperty("capsule_points", std::to_string(capsule_points));
  EXPECT_LT(capsule_points, 1.3);
  EXPECT_LT(joint_spots, 1.5);
  EXPECT_LT(joint_spots, separate_spots);
  EXPECT_LT(separate_spots, cone_sphere_spots);
  EXPECT_LT(joint_spots, aabb_spots);
}

// A ball beside a tapered capsule: at the foot of the perpendicular from its centre the capsule is still too thin; the ball that
// touches it lies further along.
TEST_F(LightBoundsTest, TheFootOfThePerpendicularIsNotTheClosestPoint) {
  Pair p;
  p.slab = {{-0.5f, -0.5f}, {0.5f, 0.5f}, 1, 100};
  p.light.type = LightType::point;
  p.light.position = {0, 30, 30};
  p.light.range_m = 14;  // (0, 0.5 z, z) comes nearest at z = 36: sqrt(18^2 + ...) = 13.4
  EXPECT_TRUE(reaches(p.light, {0, 18, 36}));
  EXPECT_EQ(touches({p}, true)[0], 0xfu);
}

// Lights that only touch by a hair, and numbers near the ends of what floats hold: yes is always allowed, no only if it is right.
TEST_F(LightBoundsTest, ExtremeNumbersAreKept) {
  std::vector<Pair> pairs;
  for (const float range : {1e-20f, 1e-3f, 1.0f, 1e6f, 1e18f})
    for (const float depth : {1e-3f, 1.0f, 1e5f, 1e12f})
      for (const float angle : {1e-6f, 0.5f, 1.5707f, 1.5707964f}) {
        Pair p;
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
