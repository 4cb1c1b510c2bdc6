#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "reference_bvh_fixture.h"

namespace candela {
namespace {

using namespace bvh_test;

std::vector<BoxReference> boxes_of(const std::vector<TriangleCorners>& triangles) {
  std::vector<BoxReference> out;
  for (const TriangleCorners& t : triangles) out.push_back(reference_to(t, uint32_t(out.size())));
  return out;
}

BinaryTree tree_of(const std::vector<TriangleCorners>& triangles, BvhBuilder builder) {
  BvhOptions options;
  options.builder = builder;
  return build_tree(boxes_of(triangles), triangles, options);
}

bool holds(const Aabb& box, glm::dvec3 p) {
  return glm::all(glm::lessThanEqual(glm::dvec3(box.min), p)) && glm::all(glm::lessThanEqual(p, glm::dvec3(box.max)));
}

// The boxes of each triangle's references in leaves; checks on the way that parents hold their children.
std::vector<std::vector<Aabb>> boxes_in_leaves(const BinaryTree& tree, size_t triangles) {
  std::vector<std::vector<Aabb>> out(triangles);
  std::vector<uint32_t> stack;
  if (!tree.empty()) stack.push_back(0);
  size_t references = 0;
  while (!stack.empty()) {
    const BinaryNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    const auto inside = [&](glm::vec3 low, glm::vec3 high) {
      EXPECT_TRUE(holds(node.box(), low) && holds(node.box(), high));
    };
    for (uint32_t i = node.first; !node.inner && i < node.first + node.count; ++i) {
      const BoxReference& r = tree.references[i];
      const Aabb box{{r.low[0], r.low[1], r.low[2]}, {r.high[0], r.high[1], r.high[2]}};
      inside(box.min, box.max);
      out[r.id].push_back(box);
      ++references;
    }
    if (!node.inner) continue;
    for (uint32_t c : {node.first, node.first + 1}) {
      inside(tree.nodes[c].box().min, tree.nodes[c].box().max);
      stack.push_back(c);
    }
  }
  EXPECT_EQ(references, tree.reference_count);
  return out;
}

void expect_covered(const std::vector<TriangleCorners>& triangles, BvhBuilder builder, const std::string& name) {
  const BinaryTree tree = tree_of(triangles, builder);
  const auto boxes = boxes_in_leaves(tree, triangles.size());
  Rng rng(9);
  size_t uncovered = 0;
  for (size_t i = 0; i < triangles.size(); ++i) {
    if (!splits_space(builder)) {
      EXPECT_EQ(boxes[i].size(), 1u) << name;
    }
    const glm::dvec3 a(triangles[i].corner[0]), b(triangles[i].corner[1]), c(triangles[i].corner[2]);
    for (int k = 0; k < 48; ++k) {
      double u = rng.uniform(), v = rng.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      if (k < 3)
        u = k == 1, v = k == 2;
      else if (k < 12)
        v = 0;
      else if (k < 20)
        v = 1 - u;
      const glm::dvec3 p = a * (1 - u - v) + b * u + c * v;
      // Points between corners are themselves rounded, in double.
      const double reach = std::max({glm::length(a), glm::length(b), glm::length(c)}) * 1e-15;
      uncovered += std::none_of(boxes[i].begin(), boxes[i].end(), [&](const Aabb& box) {
        const DAabb wider{glm::dvec3(box.min) - reach, glm::dvec3(box.max) + reach};
        return glm::all(glm::lessThanEqual(wider.min, p)) && glm::all(glm::lessThanEqual(p, wider.max));
      });
    }
  }
  EXPECT_EQ(uncovered, 0u) << name << " by builder " << int(builder);
}

std::vector<TriangleCorners> scaled(std::vector<TriangleCorners> triangles, float scale, float offset) {
  for (TriangleCorners& t : triangles)
    for (glm::vec3& p : t.corner) p = p * scale + offset;
  return triangles;
}

TEST(BvhBuild, EveryTriangleIsCoveredByItsLeaves) {
  for (BvhBuilder b : all_builders) {
    expect_covered(random_soup(1, 3000, 0.3), b, "soup");
    expect_covered(slivers(2, 3000), b, "slivers");
    expect_covered(planks(2, 6, 200), b, "planks");
    expect_covered(closed_mesh(40, 30), b, "closed");
    expect_covered(scaled(slivers(4, 600), 1e7f, 0), b, "huge");
    expect_covered(scaled(slivers(5, 600), 1e-8f, 0), b, "tiny");
    expect_covered(scaled(slivers(6, 600), 1, 1e5f), b, "far away");
    expect_covered(scaled(random_soup(7, 600, 0.5), 1e-8f, 1), b, "much the same point");
  }
}

TEST(BvhBuild, SpatialSplitsCostLessThanAreasAndThoseLessThanEqualCounts) {
  for (uint64_t seed : {2u, 3u, 4u}) {
    auto triangles = planks(seed, 12, 200);
    for (const TriangleCorners& t : random_soup(seed, 1000, 0.1)) triangles.push_back(t);
    const BvhOptions options;
    const BinaryTree equal = tree_of(triangles, BvhBuilder::equal_counts), sah = tree_of(triangles, BvhBuilder::sah),
                     sbvh = tree_of(triangles, BvhBuilder::sbvh);
    EXPECT_LT(sah_cost(sah, options), sah_cost(equal, options));
    EXPECT_LT(sah_cost(sbvh, options), 0.9 * sah_cost(sah, options));
    EXPECT_GT(sbvh.reference_count, triangles.size());
    EXPECT_LE(sbvh.reference_count, size_t((1 + options.split_budget) * double(triangles.size())));
    BvhOptions none;
    none.builder = BvhBuilder::sbvh, none.split_budget = 0;
    EXPECT_EQ(build_tree(boxes_of(triangles), triangles, none).reference_count, triangles.size());
  }
}

TEST(BvhBuild, TheTreeIsTheSameForAnyNumberOfThreads) {
  auto triangles = planks(5, 100, 200);
  for (const TriangleCorners& t : random_soup(6, 50'000, 0.02)) triangles.push_back(t);
  for (BvhBuilder b : all_builders) {
    std::vector<Hash128> hashes;
    for (int threads : {1, 2, 8}) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
      tbb::task_arena arena(threads);
      arena.execute([&] { hashes.push_back(hash_of(collapse(tree_of(triangles, b), triangles))); });
    }
    EXPECT_EQ(hashes[0], hashes[1]) << int(b);
    EXPECT_EQ(hashes[0], hashes[2]) << int(b);
  }
}

TEST(BvhBuild, HasNoBadCases) {
  const TriangleCorners one{{{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}};
  const TriangleCorners point{{{0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    const char* name;
    std::vector<TriangleCorners> triangles;
  };
  std::vector<Case> cases = {{"none", {}},
                             {"one", {one}},
                             {"one point", {point}},
                             {"the same 100000 times", std::vector<TriangleCorners>(100'000, one)},
                             {"the same point 1000 times", std::vector<TriangleCorners>(1000, point)},
                             {"not a number", {one, {{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, one}}};
  std::vector<TriangleCorners>
      concentric;  // centres are one point, sizes double: splits by area peel one off at a time
  for (int i = -60; i < 60; ++i) {
    const float r = std::ldexp(1.0f, i / 2);
    concentric.push_back({{{-r, -r, -1}, {r, -r, -1}, {0, 2 * r, -1}}});
  }
  cases.push_back({"concentric", concentric});
  std::vector<TriangleCorners> powers;  // each as far out again as all before it
  for (int i = 0; i < 120; ++i) {
    const float x = std::ldexp(1.0f, i - 60);
    powers.push_back({{{x, 0, -1}, {x * 1.1f, 0, -1}, {x, x * 0.1f, -1}}});
  }
  cases.push_back({"powers of two", powers});
  for (const Case& c : cases)
    for (BvhBuilder b : all_builders) {
      const auto m = made(c.name, c.triangles);
      const Accel accel(m->scene, m->pose, m->frame, built_by(b));
      const BruteForce brute(accel);
      EXPECT_LE(accel.trees().world.depth, 92u) << c.name;
      const Rays rays(accel);
      for (uint64_t i = 0; i < (c.triangles.size() > 1000 ? 20u : 500u); ++i)
        EXPECT_TRUE(same(accel.closest(rays[i]), brute.closest(rays[i]))) << c.name << " " << int(b) << ": ray " << i;
      size_t in_leaves = 0;
      for (const LeafBox& leaf : accel.leaves()) in_leaves += leaf.triangles;
      EXPECT_EQ(in_leaves, accel.statistics().references) << c.name;
      EXPECT_EQ(accel.statistics().left_out, std::string(c.name) == "not a number" ? 1u : 0u);
    }
}

// Triangles are tested four at once, so a split that only thins out blocks is not worth its step.
TEST(BvhBuild, CountingBlocksMakesFewerOfThem) {
  const auto triangles = random_soup(13, 20'000, 0.02);
  for (BvhBuilder b : {BvhBuilder::sah, BvhBuilder::sbvh}) {
    BvhOptions by_triangles;
    by_triangles.builder = b, by_triangles.block_shift = 0, by_triangles.node_cost = 1;
    const BinaryTree other = build_tree(boxes_of(triangles), triangles, by_triangles);
    const WideTree tree = collapse(tree_of(triangles, b), triangles);
    EXPECT_LT(double(tree.blocks.size()), 0.9 * double(collapse(other, triangles).blocks.size())) << int(b);
  }
}

// Very large and very small worlds behave as the same world in metres.
TEST(BvhBuild, HugeAndTinyCoordinatesMeetAsMiddlingOnesDo) {
  for (float scale : {0x1p-27f, 0x1p23f})
    for (BvhBuilder b : all_builders) {
      const auto near = made("near", random_soup(8, 300, 0.4)),
                 far = made("far", scaled(random_soup(8, 300, 0.4), scale, 0));
      const Accel plain(near->scene, near->pose, near->frame, built_by(b)),
          moved(far->scene, far->pose, far->frame, built_by(b));
      const BruteForce brute(moved);
      const Rays rays(plain), moved_rays(moved);
      size_t hits = 0, same_hits = 0;
      for (uint64_t i = 0; i < 4000; ++i) {
        const auto a = plain.closest(rays[i]);
        Ray ray = rays[i];
        ray.origin *= scale, ray.direction *= scale;
        const auto c = moved.closest(ray);
        EXPECT_TRUE(same(c, brute.closest(ray)));
        EXPECT_TRUE(same(moved.closest(moved_rays[i]), brute.closest(moved_rays[i])));
        hits += a.has_value();
        same_hits += a && c && a->primitive == c->primitive;
      }
      // Scaling by a power of two rounds nothing; only the limits between float and double arithmetic lie elsewhere.
      EXPECT_GE(double(same_hits), 0.99 * double(hits)) << scale;
    }
}

}  // namespace
}  // namespace candela
