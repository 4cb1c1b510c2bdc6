#include "bvh/trace.h"
#include "reference_bvh_fixture.h"

namespace candela {
namespace {

using namespace bvh_test;

std::vector<std::unique_ptr<Made>> scenes() {
  std::vector<std::unique_ptr<Made>> out;
  out.push_back(made("soup", random_soup(1, 120, 0.5)));
  out.push_back(made("closed", closed_mesh(12, 6)));
  out.push_back(made("slivers", slivers(3, 100)));
  out.push_back(instanced_scene());
  return out;
}

// Numbers of rays whose answer differs from brute force's, first few only.
template <class Differs>
std::vector<uint64_t> differing(uint64_t count, Differs differs) {
  std::vector<uint8_t> bad(count);
  tbb::parallel_for(uint64_t(0), count, [&](uint64_t i) { bad[i] = differs(i); });
  std::vector<uint64_t> out;
  for (uint64_t i = 0; i < count && out.size() < 10; ++i)
    if (bad[i]) out.push_back(i);
  return out;
}

TEST(BvhHits, EqualBruteForceOnAMillionRaysAScene) {
  for (const auto& m : scenes()) {
    std::vector<Accel> trees;
    for (BvhBuilder b : all_builders) trees.emplace_back(m->scene, m->pose, m->frame, built_by(b));
    const BruteForce brute(trees[0]);
    const Rays rays(trees[0]);
    std::atomic<uint64_t> met = 0;
    const auto bad = differing(1'000'000, [&](uint64_t i) {
      const Ray ray = rays[i];
      const std::optional<Hit> expected = brute.closest(ray);
      met += expected.has_value();
      const size_t n = std::size(all_builders);
      if (!same(trees[i % n].closest(ray), expected)) return true;
      return i % 4 == 0 && trees[(i + 1) % n].occluded(ray) != expected.has_value();
    });
    EXPECT_TRUE(bad.empty()) << m->name << ": ray " << (bad.empty() ? 0 : bad[0]) << " and " << bad.size() - 1
                             << " more";
    EXPECT_GT(met, 200'000u) << m->name;
  }
}

// Bigger ones with fewer rays: the trees have several levels and tasks.
TEST(BvhHits, EqualBruteForceInBigTrees) {
  std::vector<std::unique_ptr<Made>> big;
  big.push_back(made("big soup", random_soup(11, 6000, 0.1)));
  big.push_back(made("big closed", closed_mesh(60, 40)));
  for (const auto& m : big)
    for (BvhBuilder b : all_builders) {
      const Accel accel(m->scene, m->pose, m->frame, built_by(b));
      const BruteForce brute(accel);
      const Rays rays(accel);
      const auto bad =
          differing(8'000, [&](uint64_t i) { return !same(accel.closest(rays[i]), brute.closest(rays[i])); });
      EXPECT_TRUE(bad.empty()) << m->name << " " << int(b) << ": ray " << (bad.empty() ? 0 : bad[0]);
    }
}

TEST(BvhHits, AreTheSameWhateverTheVectorWidth) {
  const Kernels* others[] = {sse2_kernels(), avx2_kernels(), avx512_kernels()};
  for (const auto& m : scenes()) {
    AccelOptions options = with_instances();
    options.kernels = scalar_kernels();
    const Accel plain(m->scene, m->pose, m->frame, options);
    const Rays rays(plain);
    for (const Kernels* kernels : others) {
      if (!kernels) continue;
      options.kernels = kernels;
      const Accel wide(m->scene, m->pose, m->frame, options);
      const auto bad = differing(50'000, [&](uint64_t i) {
        TraceCounts a, b;
        const bool equal = same(plain.closest(rays[i], nullptr, &a), wide.closest(rays[i], nullptr, &b)) &&
                           plain.occluded(rays[i], nullptr, &a) == wide.occluded(rays[i], nullptr, &b);
        // Boxes are tested otherwise where nobody counts.
        const bool uncounted =
            same(plain.closest(rays[i]), wide.closest(rays[i])) && plain.occluded(rays[i]) == wide.occluded(rays[i]);
        return !equal || !uncounted || a.boxes != b.boxes || a.triangles != b.triangles || a.nodes != b.nodes;
      });
      EXPECT_TRUE(bad.empty()) << m->name << " " << kernels->name << ": ray " << (bad.empty() ? 0 : bad[0]);
    }
  }
}

// Rays from near one place to near another, which go together, and rays of any kinds, which do not; some are none.
std::vector<Ray> packet_of(const Rays& rays, uint64_t number) {
  Rng rng(number);
  std::vector<Ray> out;
  const Ray first = rays[number];
  const double spread = number % 3 == 0 ? 0.0 : number % 3 == 1 ? 1e-3 : 0.1;
  for (uint64_t i = 0; i < 1 + number % 20; ++i) {
    Ray ray = number % 4 == 3 ? rays[number + 7 * i] : first;
    ray.origin += random_in(rng, -1, 1) * float(spread * 0.1);
    ray.direction += random_in(rng, -1, 1) * float(spread) * glm::length(ray.direction);
    if (rng.next() % 32 == 0) ray.direction = glm::vec3(0);
    if (rng.next() % 32 == 0) ray.t_max = 0.5f;
    out.push_back(ray);
  }
  return out;
}

TEST(BvhHits, OfPacketsAreThoseOfRaysAlone) {
  auto all = scenes();
  all.push_back(made("big closed", closed_mesh(60, 40)));
  const Kernels* every[] = {scalar_kernels(), sse2_kernels(), avx2_kernels(), avx512_kernels()};
  struct Some final : HitFilter {
    bool accepts(const Hit& hit) const override { return (hit.primitive * 7 + hit.item + hit.back) % 3 != 0; }
  } const some;
  for (const auto& m : all)
    for (const Kernels* kernels : every) {
      if (!kernels) continue;
      AccelOptions options = with_instances();
      options.kernels = kernels;
      const Accel accel(m->scene, m->pose, m->frame, options);
      const Rays rays(accel);
      for (const HitFilter* filter : {static_cast<const HitFilter*>(nullptr), static_cast<const HitFilter*>(&some)}) {
        std::atomic<uint64_t> met = 0;
        const auto bad = differing(6'000, [&](uint64_t number) {
          const std::vector<Ray> packet = packet_of(rays, number);
          std::vector<std::optional<Hit>> hits(packet.size());
          const std::unique_ptr<bool[]> blocked(new bool[packet.size()]);
          accel.closest(packet, hits, filter), accel.occluded(packet, {blocked.get(), packet.size()}, filter);
          for (size_t i = 0; i < packet.size(); ++i) {
            const auto alone = accel.closest(packet[i], filter);
            met += alone.has_value();
            if (!same(hits[i], alone) || blocked[i] != accel.occluded(packet[i], filter)) return true;
          }
          return false;
        });
        EXPECT_TRUE(bad.empty()) << m->name << " " << kernels->name << ": packet " << (bad.empty() ? 0 : bad[0]);
        EXPECT_GT(met, 5'000u) << m->name;
      }
    }
}

// From inside a closed mesh, at its corners, edges and faces, near the origin and far from it.
TEST(BvhHits, NoRayEscapesAClosedMesh) {
  for (float centre : {0.0f, 1000.0f, -3e5f})
    for (BvhBuilder b : all_builders) {
      const auto triangles = closed_mesh(24, 16, centre);
      const auto m = made("closed", triangles);
      const Accel accel(m->scene, m->pose, m->frame, built_by(b));
      const auto bad = differing(120'000, [&](uint64_t i) {
        Rng rng(i);
        const TriangleCorners& t = triangles[rng.next() % triangles.size()];
        const glm::vec3 p = t.corner[rng.next() % 3], q = t.corner[rng.next() % 3], r = t.corner[rng.next() % 3];
        const float s = i % 3 == 0 ? 0.0f : float(rng.uniform()), u = i % 3 == 2 ? float(rng.uniform()) : 0.0f;
        Ray ray;
        ray.origin = glm::vec3(centre) + random_in(rng, -0.1, 0.1);
        ray.direction = glm::mix(glm::mix(p, q, s), r, u) - ray.origin;
        return !accel.closest(ray) || !accel.occluded(ray);
      });
      EXPECT_TRUE(bad.empty()) << centre << " " << int(b) << ": ray " << (bad.empty() ? 0 : bad[0]);
    }
}

// Of each hit whether the filter takes it depends on the item and the side: all kernels ask about the same ones.
TEST(BvhHits, FiltersAreAskedAlikeOfMixedMaterials) {
  auto m = instanced_scene();
  m->pose.materials.resize(3);
  m->pose.materials[1].double_sided = true, m->pose.materials[2].alpha_mode = AlphaMode::mask;
  for (size_t i = 0; i < m->frame.items.size(); ++i) m->frame.items[i].material = int(i % 3);
  struct Some final : HitFilter {
    bool accepts(const Hit& hit) const override { return (hit.primitive * 7 + hit.item + hit.back) % 3 != 0; }
  } const some;
  for (const size_t repeated : {size_t(0), size_t(1) << 16}) {
    AccelOptions options;
    options.repeated_triangles = repeated, options.kernels = scalar_kernels();
    const Accel plain(m->scene, m->pose, m->frame, options);
    options.kernels = nullptr;
    const Accel wide(m->scene, m->pose, m->frame, options);
    // What the filter is not asked about it takes: a filter that knows by itself must come to the same.
    options.always_ask_filter = true;
    const Accel asked(m->scene, m->pose, m->frame, options);
    struct Doubtful final : HitFilter {
      const HitFilter& some;
      const FrameData& frame;
      Doubtful(const HitFilter& s, const FrameData& f) : some(s), frame(f) {}
      bool accepts(const Hit& hit) const override {
        const int material = frame.items[hit.item].material;
        return (material == 2 || (material == 0 && hit.back)) ? some.accepts(hit) : true;
      }
    } const doubtful(some, m->frame);
    const Rays rays(plain);
    const auto bad = differing(50'000, [&](uint64_t i) {
      const auto hit = plain.closest(rays[i], &some);
      return !same(hit, wide.closest(rays[i], &some)) || !same(hit, asked.closest(rays[i], &doubtful)) ||
             wide.occluded(rays[i], &some) != hit.has_value() || plain.occluded(rays[i], &some) != hit.has_value();
    });
    EXPECT_TRUE(bad.empty()) << repeated << ": ray " << (bad.empty() ? 0 : bad[0]);
  }
}

struct Only final : HitFilter {
  uint32_t primitive;
  explicit Only(uint32_t p) : primitive(p) {}
  bool accepts(const Hit& hit) const override { return hit.primitive == primitive; }
};
struct Never final : HitFilter {
  bool accepts(const Hit&) const override { return false; }
};

TEST(BvhHits, FiltersSeeEveryLayer) {
  std::vector<TriangleCorners> layers;
  for (int i = 0; i < 40; ++i) {
    const float z = -1.0f - float(i);
    layers.push_back({{{-1, -1, z}, {1, -1, z}, {0, 1, z}}});
  }
  const auto m = made("layers", layers);
  AccelOptions options;
  options.always_ask_filter = true;
  const Accel accel(m->scene, m->pose, m->frame, options);
  const Ray ray;
  for (uint32_t i = 0; i < 40; ++i) {
    const Only only(i);
    const auto hit = accel.closest(ray, &only);
    ASSERT_TRUE(hit) << i;
    EXPECT_EQ(hit->primitive, i);
    EXPECT_EQ(hit->t, 1.0f + float(i));
    EXPECT_TRUE(accel.occluded(ray, &only));
    EXPECT_FALSE(hit->back);
  }
  EXPECT_FALSE(accel.closest(ray, &static_cast<const HitFilter&>(Never())));
  // Opaque fronts are not asked about, backs of surfaces that are not double sided are.
  const Accel trusting(m->scene, m->pose, m->frame);
  const Never never;
  EXPECT_TRUE(trusting.closest(ray, &never));
  Ray back;
  back.origin = {0, 0, -100}, back.direction = {0, 0, 1};
  EXPECT_TRUE(trusting.closest(back)->back);
  EXPECT_FALSE(trusting.closest(back, &never));
}

TEST(BvhHits, RaysThatAreNoneMeetNothing) {
  const auto m = made("one", {{{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}}}});
  const Accel accel(m->scene, m->pose, m->frame);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  Ray ray;
  EXPECT_TRUE(accel.closest(ray));
  for (float x : {nan, infinity}) {
    Ray broken = ray;
    broken.origin.x = x;
    EXPECT_FALSE(accel.closest(broken));
    broken = ray, broken.direction.y = x;
    EXPECT_FALSE(accel.closest(broken));
  }
  ray.direction = glm::vec3(0);
  EXPECT_FALSE(accel.closest(ray));
  ray.direction = {0, 0, -1}, ray.t_min = nan;
  EXPECT_FALSE(accel.closest(ray));
}

// A ray that leaves a surface by leaving_origin does not meet the triangle it comes from, and does meet one right
// behind.
TEST(BvhHits, SecondaryRaysLeaveTheirTriangle) {
  for (const auto& m : scenes())
    for (float scale : {1.0f, 1e-8f, 1e7f}) {
      Made moved = *m;
      for (glm::mat4& t : moved.frame.relative_from_local)
        t = glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(3, -2, 5) * scale), glm::vec3(scale)) * t;
      const Accel accel(moved.scene, moved.pose, moved.frame);
      const Rays rays(accel);
      const auto bad = differing(60'000, [&](uint64_t i) {
        const auto hit = accel.closest(rays[i]);
        if (!hit) return false;
        const SurfacePoint p = accel.surface(*hit);
        if (p.geometric_normal == glm::vec3(0)) return false;
        Rng rng(i);
        Ray away;
        away.direction = random_direction(rng);
        if (i % 4 == 0) away.direction -= 0.999f * glm::dot(away.direction, p.geometric_normal) * p.geometric_normal;
        away.origin = leaving_origin(p, away.direction);
        const auto next = accel.closest(away);
        return next && next->item == hit->item && next->primitive == hit->primitive;
      });
      EXPECT_TRUE(bad.empty()) << m->name << " x " << scale << ": ray " << (bad.empty() ? 0 : bad[0]);
    }
}

}  // namespace
}  // namespace candela
