// Rays that shaders/lib/trace.glsl sends, against those of the CPU.
#include "../unit/reference_bvh_fixture.h"
#include "gltf/gltf.h"
#include "gpu/acceleration.h"
#include "gpu/device_select.h"
#include "passes_fixture.h"
#include "plan/frame_rays.h"
#include "shared/scene.h"
#include "shared/trace.h"

namespace candela {
namespace {

using namespace bvh_test;

struct TestRay {
  glm::vec3 origin;
  float t_min;
  glm::vec3 direction;
  float t_max;
};
struct TestHit {
  float t, u, v;
  uint32_t item, primitive, back, found, any;
  glm::vec3 position, normal;
  float error_m;
};

int64_t ulps_between(float a, float b) {
  const auto ordered = [](float x) {
    const int32_t bits = std::bit_cast<int32_t>(x);
    return int64_t(bits < 0 ? INT32_MIN - bits : bits);
  };
  return std::abs(ordered(a) - ordered(b));
}

class Traced : public gpu::test::PassTest {
 protected:
  std::vector<TestHit> trace(const FrameRays& trees, const std::vector<TestRay>& rays,
                             const std::string& shader = "trace_rays.comp") {
    std::vector<std::byte> bytes(trees.bytes.begin(), trees.bytes.end());
    std::optional<gpu::AccelerationStructures> structures;
    if (!trees.on_device.levels.empty()) {
      const uint64_t address = structures.emplace(*device, trees.on_device).address();
      std::memcpy(bytes.data() + offsetof(shared::TraceScene, acceleration), &address, sizeof address);
    }
    const gpu::Buffer tree_buffer = upload(bytes, "trees");
    const gpu::Buffer ray_buffer = upload(rays, "rays");
    const gpu::Buffer constants = upload(std::vector<shared::FrameConstants>(1), "constants");
    GraphBuilder builder;
    const BufferHandle tree = import(builder, tree_buffer, "trees"), ray = import(builder, ray_buffer, "rays");
    const BufferHandle frame = import(builder, constants, "constants");
    builder.begin_pass("trace");
    builder.read(tree, Access::compute_read, "trees");
    builder.read(ray, Access::compute_read, "rays");
    builder.read(frame, Access::uniform_read, "constants");
    BufferHandle hits = builder.create(BufferDesc{.name = "hits", .size_bytes = rays.size() * sizeof(TestHit)});
    hits = builder.write(hits, Access::compute_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{shader, {{0, "STACK", trees.stack}}});
    builder.end_pass([=, count = uint32_t(rays.size())](CommandList& commands) {
      struct {
        uint64_t trees, rays, hits;
        uint32_t count, mode;
      } const push{commands.address(tree), commands.address(ray), commands.address(hits), count, 0};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(count);
    });
    const BufferHandle out = read_words(builder, "hits", hits, rays.size() * sizeof(TestHit));
    const auto result = run_all(builder);
    const auto found = result.readbacks.find(out.resource);
    if (found == result.readbacks.end()) return {};
    return gpu::test::values_of<TestHit>(*found->second);
  }

  // Every ray meets what the CPU's does, but for ties within 4 ulp of t.
  uint32_t expect_same(const Made& m, uint64_t count, uint64_t first = 0) {
    const Accel accel(m.scene, m.pose, m.frame, bvh_test::with_instances());
    const bool instanced = accel.statistics().instances > 0;
    const FrameRays trees = lay_out_rays(accel, m.scene, m.pose, m.frame);
    const Rays rays(accel);
    std::vector<TestRay> list;
    for (uint64_t i = 0; i < count; ++i) {
      const Ray r = rays[first + i];
      list.push_back({r.origin, r.t_min, r.direction, r.t_max});
    }
    const std::vector<TestHit> hits = trace(trees, list);
    EXPECT_EQ(hits.size(), list.size());
    if (hits.size() != list.size()) return 0;
    // Of rays that begin on a surface t is what is left of sums that cancel: it is known to a fraction of the distances
    // from the origin, 2^-42 here, not of itself. An instance's rays are rounded in its space, once; that the two
    // round to different sides happens, and moves the ray by a unit in the last place of its origin.
    float reach = 0;
    for (const LeafBox& leaf : accel.leaves())
      for (int a = 0; a < 3; ++a) reach = std::max({reach, std::abs(leaf.box.min[a]), std::abs(leaf.box.max[a])});
    size_t met = 0, other = 0, ties = 0, worst = 0, near = 0;
    double farthest = 0, normals = 0;
    for (uint64_t i = 0; i < count; ++i) {
      const Ray r = rays[first + i];
      const std::optional<Hit> cpu = accel.closest(r);
      const TestHit& gpu = hits[i];
      met += cpu.has_value();
      const auto differs = [&] {
        const float size = std::max({reach, std::abs(r.origin.x), std::abs(r.origin.y), std::abs(r.origin.z)});
        const float rounding = size / glm::length(r.direction) * (instanced ? 0x1p-23f : 0x1p-42f);
        if ((gpu.any != 0) != (gpu.found != 0)) return true;
        std::optional<Hit> other = cpu;
        if (!cpu || !gpu.found || (ulps_between(cpu->t, gpu.t) > 4 && std::abs(cpu->t - gpu.t) > rounding)) {
          // One of them may have left out what lies at the ray's very beginning.
          Ray nudged = r;
          nudged.t_min = (gpu.found != 0 && (!cpu || gpu.t < cpu->t) ? -1 : 1) * rounding + r.t_min;
          if (const auto again = accel.closest(nudged); gpu.found != 0 == again.has_value()) other = again;
        }
        if (other.has_value() != (gpu.found != 0)) return true;
        if (!other) return false;
        const int64_t ulps = ulps_between(other->t, gpu.t);
        if (ulps > 4 && std::abs(other->t - gpu.t) <= rounding) return ++near, false;
        worst = std::max(worst, size_t(std::min<int64_t>(ulps, 1 << 30)));
        if (ulps > 4) return true;
        if (!cpu || cpu->t != other->t) return ++near, false;
        if (cpu->item == gpu.item && cpu->primitive == gpu.primitive) return (gpu.back != 0) != cpu->back;
        ++ties;
        return false;
      }();
      if (differs && other++ < 5)
        ADD_FAILURE() << m.name << ": ray " << first + i << " cpu " << (cpu ? cpu->t : -1) << " item "
                      << (cpu ? int(cpu->item) : -1) << " primitive " << (cpu ? int(cpu->primitive) : -1) << ", gpu "
                      << gpu.found << " any " << gpu.any << " t " << gpu.t << " item " << gpu.item << " primitive "
                      << gpu.primitive;
      if (differs || !cpu || cpu->item != gpu.item || cpu->primitive != gpu.primitive) continue;
      Hit hit = *cpu;
      const SurfacePoint p = accel.surface(hit);
      if (p.geometric_normal == glm::vec3(0)) continue;
      const double off = glm::length(glm::dvec3(p.position) - glm::dvec3(gpu.position)) / double(p.error_m);
      farthest = std::max(farthest, off);
      normals = std::max(normals, glm::length(glm::dvec3(p.geometric_normal) - glm::dvec3(gpu.normal)));
      EXPECT_NEAR(gpu.error_m, p.error_m, 1e-3f * p.error_m) << m.name << ": ray " << first + i;
    }
    fmt::print(
        "{}: {} of {} meet, {} differ; {} ties, {} begin on a surface, t within {} ulp; points within {:.2f} of their "
        "bound, normals within {:.1e}; stack {}\n",
        m.name, met, count, other, ties, near, worst, farthest, normals, trees.stack);
    EXPECT_LT(near, count / 500) << m.name;
    EXPECT_GT(met, count / 5) << m.name;
    EXPECT_EQ(other, 0u) << m.name;
    return trees.stack;
  }

  // Where a ray meets the plane of a triangle, in double: t, the least of its weights, and the sine of its angle to the
  // plane, by which what rounds the corners of placed instances is divided.
  struct Met {
    double t, least, sine;
  };
  static Met meet(const Accel& accel, const Ray& ray, uint32_t item, uint32_t primitive) {
    const PosedTriangle triangle = accel.triangle(item, primitive);
    const glm::dvec3 a(triangle.position[0]), b(triangle.position[1]), c(triangle.position[2]);
    const glm::dvec3 d(ray.direction), from(ray.origin), n = glm::cross(b - a, c - a);
    const double t = glm::dot(n, a - from) / glm::dot(n, d);
    const glm::dvec3 p = from + t * d;
    const auto weight = [&](glm::dvec3 e, glm::dvec3 f) {
      return glm::dot(glm::cross(f - e, p - e), n) / glm::dot(n, n);
    };
    return {t, std::min({weight(a, b), weight(b, c), weight(c, a)}),
            std::abs(glm::dot(n, d)) / (glm::length(n) * glm::length(d))};
  }

  // What queries of the device say, against the CPU: t within 4 ulp of it and of t as meet() has it, or of what
  // rounding does to the ray; other triangles only as near, or where the ray passes an edge.
  void expect_same_by_queries(const Made& m, uint64_t count) {
    if (!device->info().rays.queries) GTEST_SKIP() << device->info().name << " has no ray queries";
    const Accel accel(m.scene, m.pose, m.frame, bvh_test::with_instances());
    const FrameRays trees = lay_out_rays(accel, m.scene, m.pose, m.frame, false, false, true);
    const Rays rays(accel);
    std::vector<TestRay> list;
    for (uint64_t i = 0; i < count; ++i)
      if (const Ray r = rays[i]; r.t_min >= 0) list.push_back({r.origin, r.t_min, r.direction, r.t_max});
    const std::vector<TestHit> hits = trace(trees, list, "trace_rays.comp#TRACE_QUERY=1");
    ASSERT_EQ(hits.size(), list.size());
    float reach = 0;
    for (const LeafBox& leaf : accel.leaves())
      for (int a = 0; a < 3; ++a) reach = std::max({reach, std::abs(leaf.box.min[a]), std::abs(leaf.box.max[a])});
    size_t met = 0, edges = 0, ties = 0, other = 0;
    for (size_t i = 0; i < list.size(); ++i) {
      const Ray r{list[i].origin, list[i].t_min, list[i].direction, list[i].t_max};
      const std::optional<Hit> cpu = accel.closest(r);
      const TestHit& gpu = hits[i];
      const double rounding =
          double(std::max({reach, std::abs(r.origin.x), std::abs(r.origin.y), std::abs(r.origin.z)})) /
          double(glm::length(r.direction)) * 0x1p-21;
      const auto near_t = [&](double a, double b) {
        return ulps_between(float(a), float(b)) <= 4 || std::abs(a - b) <= rounding;
      };
      const auto on_edge = [&](uint32_t item, uint32_t primitive) {
        const Met at = meet(accel, r, item, primitive);
        return !(at.least > 1e-4) || near_t(at.t, r.t_min) || near_t(at.t, r.t_max);
      };
      met += gpu.found;
      if (!cpu && gpu.found == 0) continue;
      bool fine = (gpu.any != 0) == (gpu.found != 0);
      if (cpu && gpu.found != 0 && cpu->item == gpu.item && cpu->primitive == gpu.primitive) {
        const Met at = meet(accel, r, gpu.item, gpu.primitive);
        fine &= near_t(cpu->t, gpu.t) && !(std::abs(at.t - double(gpu.t)) > rounding / at.sine) &&
                cpu->back == (gpu.back != 0);
      } else if (cpu && gpu.found != 0 && near_t(cpu->t, gpu.t)) {
        ++ties;
      } else {
        ++edges;
        fine = (cpu && on_edge(cpu->item, cpu->primitive)) || (gpu.found != 0 && on_edge(gpu.item, gpu.primitive));
      }
      if (!fine && other++ < 5)
        ADD_FAILURE() << m.name << ": ray " << i << " cpu " << (cpu ? cpu->t : -1) << " item "
                      << (cpu ? int(cpu->item) : -1) << " primitive " << (cpu ? int(cpu->primitive) : -1) << ", gpu "
                      << gpu.found << " any " << gpu.any << " t " << gpu.t << " item " << gpu.item << " primitive "
                      << gpu.primitive << " back " << gpu.back;
    }
    fmt::print("{} by queries: {} of {} meet, {} ties, {} on edges alone, {} differ\n", m.name, met, list.size(), ties,
               edges, other);
    EXPECT_EQ(other, 0u) << m.name;
    EXPECT_GT(met, list.size() / 5) << m.name;
  }
};

// Each half as large as the one before, all at one corner: a tree that is deep for what it holds. No smaller than
// 2^-90: devices may take floats below 2^-126 for 0, which differences of corners of 2^-100 are.
std::vector<TriangleCorners> nested(int count) {
  std::vector<TriangleCorners> out;
  for (int i = 0; i < count; ++i) {
    const float s = std::ldexp(1.0f, 20 - i / 3), turn = float(i % 3);
    out.push_back({{glm::vec3(0.6f, 0.1f * turn, 0.2f) * s, glm::vec3(0.9f, 0.7f, 0.1f * turn) * s,
                    glm::vec3(0.1f * turn, 0.8f, 0.9f) * s}});
  }
  return out;
}

}  // namespace

TEST_F(Traced, RaysMeetWhatTheCpusMeet) {
  expect_same(*made("soup", random_soup(1, 120, 0.5)), 200'000);
  expect_same(*made("closed", closed_mesh(12, 6)), 200'000);
  expect_same(*made("slivers", slivers(3, 100)), 100'000);
  expect_same(*made("planks", planks(5, 6, 40)), 100'000);
  expect_same(*made("big closed", closed_mesh(60, 40)), 100'000);
  expect_same(*made("closed far off", closed_mesh(24, 16, -3e5f)), 50'000);
}

TEST_F(Traced, RaysMeetInstancesAsTheCpusDo) { expect_same(*instanced_scene(40), 200'000); }

// The stack is as large as the tree is deep, and no ray needs more. A tree that is no deeper than it must be has three
// levels for as many triangles.
TEST_F(Traced, DeepTreesFitTheirStack) { EXPECT_GE(expect_same(*made("nested", nested(330)), 100'000), 8u); }

TEST_F(Traced, RaysMeetPosedScenesAsTheCpusDo) {
  for (const char* name : {"skinned", "morph", "far-world", "near-world", "instanced"}) {
    auto scene = load_gltf(fmt::format("{}/scenes/{}/{}.glb", CANDELA_SOURCE_DIR, name, name));
    ASSERT_TRUE(scene) << name;
    Made m;
    m.name = name;
    m.scene = std::move(*scene);
    const auto animations = choose_animations(m.scene, "all");
    ASSERT_TRUE(animations) << name;
    m.pose = evaluate_pose(m.scene, *animations, 0.4);
    const auto view = make_view(m.scene, m.pose, {}, 64, 64, world_bounds(m.scene, m.pose));
    ASSERT_TRUE(view) << name;
    m.frame = make_frame_data(m.scene, m.pose, *view);
    expect_same(m, 50'000);
  }
}

TEST_F(Traced, QueriesMeetWhatTheCpusRaysMeet) {
  expect_same_by_queries(*made("soup", random_soup(1, 120, 0.5)), 20'000);
  expect_same_by_queries(*made("big closed", closed_mesh(60, 40)), 20'000);
  expect_same_by_queries(*instanced_scene(40), 20'000);
}

}  // namespace candela
