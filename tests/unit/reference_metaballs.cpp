#include "scene/metaballs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include "base/rng.h"
#include "reference/metaballs.h"

namespace candela {
namespace {

PosedMetaballs body_of(std::vector<PosedBall> balls, double threshold, double cell_m) {
  PosedMetaballs body;
  body.balls = std::move(balls);
  body.threshold = threshold;
  body.lattice = make_metaball_lattice(body.balls, threshold, cell_m);
  return body;
}

// Vertices that are one place, bit for bit, are one.
struct Mesh {
  std::vector<uint32_t> index;
  std::vector<glm::vec3> place;

  explicit Mesh(const std::vector<glm::vec3>& corners) {
    std::map<std::array<uint32_t, 3>, uint32_t> known;
    for (const glm::vec3& p : corners) {
      std::array<uint32_t, 3> bits;
      std::memcpy(bits.data(), &p, sizeof p);
      const auto [at, is_new] = known.try_emplace(bits, uint32_t(place.size()));
      if (is_new) place.push_back(p);
      index.push_back(at->second);
    }
  }
  // Each edge is of two triangles, which run along it in opposite directions, and no triangle has a corner twice.
  void expect_closed() const {
    std::map<std::pair<uint32_t, uint32_t>, int> runs;
    for (size_t t = 0; t < index.size(); t += 3)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = index[t + k], b = index[t + (k + 1) % 3];
        ASSERT_NE(a, b);
        ASSERT_EQ(++runs[std::pair(a, b)], 1);
      }
    for (const auto& [edge, count] : runs) ASSERT_EQ(runs.count(std::pair(edge.second, edge.first)), 1u);
  }
  int euler() const { return int(place.size()) - int(index.size() / 2) + int(index.size() / 3); }
  double volume() const {
    double sum = 0;
    for (size_t t = 0; t < index.size(); t += 3)
      sum += glm::dot(glm::dvec3(place[index[t]]),
                      glm::cross(glm::dvec3(place[index[t + 1]]), glm::dvec3(place[index[t + 2]]))) /
             6;
    return sum;
  }
};

double alone_radius(double radius, double threshold) { return radius * std::sqrt(1 - std::cbrt(threshold)); }

std::vector<PosedBall> random_balls(Rng& rng, size_t count) {
  std::vector<PosedBall> balls;
  for (size_t i = 0; i < count; ++i)
    balls.push_back({{rng.uniform() * 2 - 1, rng.uniform() * 2 - 1, rng.uniform() * 2 - 1},
                     0.3 + 0.5 * rng.uniform(),
                     i % 4 == 3 ? -0.7 : 0.6 + rng.uniform()});
  return balls;
}

TEST(Metaballs, SurfacesAreClosed) {
  Rng rng(3);
  for (int round = 0; round < 12; ++round) {
    const double threshold = std::array{0.0, 0.05, 0.3, 0.9}[size_t(round) % 4];
    const PosedMetaballs body = body_of(random_balls(rng, 6), threshold, 0.06 + 0.05 * rng.uniform());
    const std::vector<glm::vec3> corners = polygonise(body);
    EXPECT_LE(corners.size() / 3, body.lattice.most_triangles);
    Mesh(corners).expect_closed();
  }
}

TEST(Metaballs, ShapesHaveTheirEulerCharacteristic) {
  const PosedBall ball{{0.1, 0.2, -0.3}, 1, 1};
  EXPECT_EQ(Mesh(polygonise(body_of({ball}, 0.3, 0.1))).euler(), 2);
  PosedBall apart = ball;
  apart.centre.x += 3;
  EXPECT_EQ(Mesh(polygonise(body_of({ball, apart}, 0.3, 0.1))).euler(), 4);
  std::vector<PosedBall> ring;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    ring.push_back({{2 * std::cos(angle), 2 * std::sin(angle), 0}, 1, 1});
  }
  const Mesh torus(polygonise(body_of(ring, 0.4, 0.1)));
  torus.expect_closed();
  EXPECT_EQ(torus.euler(), 0);
  // A hollow ball: one surface inside the other.
  const Mesh hollow(polygonise(body_of({{{0, 0, 0}, 1, 1}, {{0, 0, 0}, 0.5, -2}}, 0.3, 0.05)));
  hollow.expect_closed();
  EXPECT_EQ(hollow.euler(), 4);
}

// Nodes where F is 0: kernels of whole numbers of cells about nodes, and thresholds that they have at nodes.
TEST(Metaballs, NodesOnTheSurfaceKeepItClosed) {
  for (const double threshold : {0.0, 27.0 / 64, 0.125, 1.0 / 64}) {  // at 0.5, 1/sqrt(2), sqrt(0.75) and 1 radii
    const PosedMetaballs body = body_of({{{0, 0, 0}, 4, 1}}, threshold, 1);
    const Mesh mesh(polygonise(body));
    mesh.expect_closed();
    EXPECT_EQ(mesh.euler(), 2) << threshold;
  }
}

TEST(Metaballs, ExtremesAreThereOrNot) {
  const PosedBall ball{{0, 0, 0}, 1, 1};
  // A threshold that no sum reaches.
  EXPECT_TRUE(body_of({ball, ball}, 2, 0.1).lattice.blocks.empty());
  EXPECT_TRUE(polygonise(body_of({ball, ball}, 2.5, 0.1)).empty());
  // At 0 the surface is that of the supports.
  const Mesh all(polygonise(body_of({ball}, 0, 0.05)));
  all.expect_closed();
  EXPECT_NEAR(all.volume(), 4 * std::numbers::pi / 3, 0.15 * 4 * std::numbers::pi / 3);
  // Two at one place are one of twice the strength.
  PosedBall strong = ball;
  strong.strength = 2;
  EXPECT_EQ(polygonise(body_of({ball, ball}, 0.3, 0.1)), polygonise(body_of({strong}, 0.3, 0.1)));
  // Balls that touch: their supports share a point.
  PosedBall beside = ball;
  beside.centre.x = 2;
  Mesh(polygonise(body_of({ball, beside}, 0, 0.1))).expect_closed();
  // A cell larger than the ball: what no node sees is not there, and what is there is closed.
  Mesh(polygonise(body_of({{{0.5, 0.5, 0.5}, 0.3, 1}}, 0.1, 1))).expect_closed();
  EXPECT_TRUE(polygonise(body_of({{{0.5, 0.5, 0.5}, 0.3, 1}}, 0.1, 1)).empty());
  const Mesh coarse(polygonise(body_of({{{0, 0, 0}, 0.3, 1}}, 0.1, 1)));
  coarse.expect_closed();
  EXPECT_EQ(coarse.euler(), 2);
}

TEST(Metaballs, BlocksLeaveNothingOut) {
  Rng rng(8);
  const PosedMetaballs body = body_of(random_balls(rng, 5), 0.2, 0.08);
  // All blocks of the bounds, with all balls each.
  PosedMetaballs whole = body;
  whole.lattice.blocks.clear(), whole.lattice.ball_lists = {0, 1, 2, 3, 4};
  glm::ivec3 last(0);
  for (const MetaballBlock& b : body.lattice.blocks) {
    EXPECT_EQ(b.first_cell % 8, glm::ivec3(0));
    last = glm::max(last, b.first_cell);
  }
  for (int z = 0; z <= last.z; z += 8)
    for (int y = 0; y <= last.y; y += 8)
      for (int x = 0; x <= last.x; x += 8) whole.lattice.blocks.push_back({{x, y, z}, 0, 5});
  EXPECT_LT(body.lattice.blocks.size(), whole.lattice.blocks.size());
  auto some = polygonise(body), all = polygonise(whole);
  ASSERT_EQ(some.size(), all.size());
  EXPECT_EQ(Mesh(some).place.size(), Mesh(all).place.size());
  EXPECT_NEAR(Mesh(some).volume(), Mesh(all).volume(), 1e-6);
}

// What is laid out into what another frame left is the same as from nothing, and needs no more memory.
TEST(Metaballs, LatticesAreLaidOutIntoWhatIsKept) {
  Rng rng(11);
  const std::vector<PosedBall> first = random_balls(rng, 6), second = random_balls(rng, 5);
  MetaballLattice kept;
  lay_out_metaballs(first, 0.2, 0.06, kept);
  const MetaballBlock* const blocks = kept.blocks.data();
  const size_t room = kept.blocks.capacity(), list_room = kept.ball_lists.capacity();
  const auto expect_same = [&](const std::vector<PosedBall>& balls, double threshold, double cell_m) {
    lay_out_metaballs(balls, threshold, cell_m, kept);
    const MetaballLattice alone = make_metaball_lattice(balls, threshold, cell_m);
    EXPECT_EQ(kept.blocks, alone.blocks);
    EXPECT_EQ(kept.ball_lists, alone.ball_lists);
    EXPECT_EQ(kept.most_triangles, alone.most_triangles);
    EXPECT_EQ(kept.origin_cell, alone.origin_cell);
    EXPECT_EQ(kept.cell_m, alone.cell_m);
    EXPECT_EQ(kept.enlarged, alone.enlarged);
  };
  expect_same(second, 0.3, 0.1);
  expect_same({}, 0.3, 0.1);
  expect_same(first, 100, 0.1);
  expect_same(first, 0.2, 0.06);
  EXPECT_EQ(kept.blocks.data(), blocks);
  EXPECT_EQ(kept.blocks.capacity(), room);
  EXPECT_EQ(kept.ball_lists.capacity(), list_room);
}

// Blocks follow the surface, not the space: their number grows by four where that of all blocks grows by eight.
TEST(Metaballs, EmptyBlocksCostNothing) {
  std::vector<PosedBall> far = {{{0, 0, 0}, 1, 1}, {{1000, 0, 0}, 1, 1}};
  EXPECT_EQ(body_of(far, 0.3, 0.05).lattice.blocks.size(), 2 * body_of({far[0]}, 0.3, 0.05).lattice.blocks.size());
  const double coarse = double(body_of({far[0]}, 0.3, 0.04).lattice.blocks.size()),
               fine = double(body_of({far[0]}, 0.3, 0.01).lattice.blocks.size());
  EXPECT_LT(fine, 20 * coarse);
}

TEST(Metaballs, TooManyBlocksEnlargeTheCell) {
  const PosedMetaballs body = body_of({{{0, 0, 0}, 1, 1}}, 0.3, 1e-4);
  EXPECT_TRUE(body.lattice.enlarged);
  EXPECT_LE(body.lattice.blocks.size(), most_metaball_blocks);
}

TEST(Metaballs, PositionsConvergeByTheSquareOfTheCell) {
  const double radius = alone_radius(1, 0.3);
  double before = 0;
  for (const double cell : {0.2, 0.1, 0.05, 0.025}) {
    const PosedMetaballs body = body_of({{{0.013, 0.027, 0.041}, 1, 1}}, 0.3, cell);
    const std::vector<glm::vec3> corners = polygonise(body);
    double worst = 0;
    for (size_t t = 0; t < corners.size(); t += 3) {
      const glm::dvec3 middle =
          (glm::dvec3(corners[t]) + glm::dvec3(corners[t + 1]) + glm::dvec3(corners[t + 2])) / 3.0;
      worst = std::max(worst, std::abs(glm::length(middle + body.lattice.origin_m() - body.balls[0].centre) - radius));
    }
    EXPECT_LT(worst, 2 * cell * cell) << cell;
    if (before > 0) EXPECT_NEAR(std::log2(before / worst), 2, 0.4) << cell;
    before = worst;
  }
}

TEST(Metaballs, TheLatticeStandsStill) {
  // Balls that move by whole blocks have the same polygons; the cell's multiples are the node's.
  std::vector<PosedBall> balls = {{{0.1, 0.2, 0.3}, 1, 1}, {{0.7, 0.2, 0.3}, 1, 1}};
  const PosedMetaballs here = body_of(balls, 0.3, 0.125);
  for (PosedBall& ball : balls) ball.centre.y += 1024;
  const PosedMetaballs there = body_of(balls, 0.3, 0.125);
  EXPECT_EQ(there.lattice.origin_cell - here.lattice.origin_cell, glm::i64vec3(0, 8192, 0));
  EXPECT_EQ(polygonise(here), polygonise(there));
}

TEST(Metaballs, ThePlacesBeforeAreOnTheSurfaceBefore) {
  // All balls move alike and grow alike: every point does.
  PosedMetaballs now = body_of({{{0, 0, 0}, 1, 1}, {{0.8, 0.1, 0}, 1, 1}}, 0.3, 0.1), before = now;
  for (PosedBall& ball : before.balls) ball.centre += glm::dvec3(0.3, -0.1, 0.2);
  const glm::dvec3 p(0.1, 0.6, 0.2);
  const glm::dvec3 q = MetaballSurface(now).place_at(MetaballSurface(before), p);
  EXPECT_LT(glm::length(q - (p + glm::dvec3(0.3, -0.1, 0.2))), 1e-12);
  EXPECT_EQ(MetaballSurface(now).place_at(MetaballSurface(now), p), p);
}

TEST(Metaballs, RaysMeetTheSurfaceItself) {
  Rng rng(5);
  for (int round = 0; round < 40; ++round) {
    const PosedMetaballs body = body_of(random_balls(rng, 6), 0.05 + 0.3 * rng.uniform(), 0.1);
    const MetaballSurface surface(body);
    const glm::dvec3 origin(3 * rng.uniform() - 1.5, 3 * rng.uniform() - 1.5, 4),
        direction(0.1 * rng.uniform(), 0.1 * rng.uniform(), -1);
    const auto field = [&](double t) {
      double sum = -body.threshold;
      for (const PosedBall& b : body.balls) {
        const glm::dvec3 d = (origin + t * direction - b.centre) / b.radius_m;
        const double u = std::max(1 - glm::dot(d, d), 0.0);
        sum += b.strength * u * u * u;
      }
      return sum;
    };
    // Every change of sign between small steps is met, once, near where it is.
    std::vector<double> met;
    surface.each_crossing(origin, direction, [&](double t, bool goes_in) {
      EXPECT_EQ(goes_in, met.size() % 2 == 0);
      met.push_back(t);
      return false;
    });
    std::vector<double> changes;
    constexpr double step = 1e-3;
    for (double t = 0; t < 8; t += step)
      if ((field(t) > 0) != (field(t + step) > 0)) changes.push_back(t);
    ASSERT_GE(met.size(), changes.size());
    if (met.size() == changes.size())
      for (size_t i = 0; i < met.size(); ++i) EXPECT_NEAR(met[i], changes[i] + 0.5 * step, step);
    for (const double t : met) EXPECT_NEAR(field(t), 0, 1e-9);
  }
}

}  // namespace
}  // namespace candela
