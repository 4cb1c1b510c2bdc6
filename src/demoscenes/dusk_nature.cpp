#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/dusk.h"
#include "testscenes/table.h"

// Trees in autumn, whose leaves are single pairs of triangles, and people with umbrellas.
namespace candela::dusk {
namespace {

using std::numbers::pi;

struct TreeMaker {
  MeshKit& kit;
  const Materials& m;
  Rng rng;
  bool with_lights;
  std::vector<glm::dvec3> twigs{};

  glm::dvec3 any_direction() {
    const double y = rng.uniform(-1, 1), angle = rng.uniform(0, 2 * pi), r = std::sqrt(1 - y * y);
    return {r * std::cos(angle), y, r * std::sin(angle)};
  }

  void branch(glm::dvec3 from, glm::dvec3 way, double length, double radius, int depth) {
    const glm::dvec3 to = from + way * length;
    const Paint bark = m.bark.tinted(glm::dvec3(0.07, 0.055, 0.045));
    kit.tube(bark, from, radius, to, radius * 0.68, depth == 0 ? 8 : depth == 1 ? 5 : 3);
    if (with_lights && depth > 0)
      for (int i = 0; i < 3; ++i) light(from + way * length * rng.uniform(0.1, 1) + 0.05 * any_direction());
    if (depth == 3) {
      for (int i = 0; i < 3; ++i) twigs.push_back(from + way * length * rng.uniform(0.3, 1.1));
      return;
    }
    const int count = depth == 0 ? 5 : 4;
    const double start = rng.uniform(0, 2 * pi);
    for (int i = 0; i < count; ++i) {
      const double angle = start + 2 * pi * (i + rng.uniform(-0.2, 0.2)) / count;
      const glm::dvec3 side = glm::normalize(glm::cross(way, glm::dvec3(std::cos(angle), 0.2, std::sin(angle))));
      const double spread = depth == 0 ? rng.uniform(0.45, 0.75) : rng.uniform(0.5, 1.0);
      const glm::dvec3 next = glm::normalize(way + spread * side + glm::dvec3(0, 0.18, 0));
      branch(from + way * length * (i == 0 ? 1.0 : rng.uniform(0.65, 1.0)), next, length * rng.uniform(0.55, 0.78),
             radius * 0.58, depth + 1);
    }
  }

  void light(glm::dvec3 at) {
    constexpr double r = 0.022;
    glow_quad(kit, m, at + glm::dvec3(-r, -r, 0), {2 * r, 0, 0}, {0, 2 * r, 0}, fairy_glow);
  }

  void leaf(glm::dvec3 at) {
    // A kite, bent along its middle; normals lean away from the crown's middle so that it takes light as a whole.
    const glm::dvec3 along = any_direction();
    glm::dvec3 across = glm::cross(along, any_direction());
    if (glm::length(across) < 0.1) across = glm::cross(along, glm::dvec3(0.3, 1, 0.2));
    across = glm::normalize(across);
    const double size = rng.uniform(0.1, 0.19);
    static constexpr std::array<glm::dvec3, 5> colors{
        {{0.42, 0.2, 0.035}, {0.5, 0.29, 0.05}, {0.33, 0.12, 0.03}, {0.22, 0.2, 0.05}, {0.45, 0.36, 0.08}}};
    const Paint paint = m.leaf.tinted(colors[size_t(rng.next() % colors.size())] * rng.uniform(0.6, 1.1));
    const glm::dvec3 tip = at + along * size * 1.7, left = at + along * size * 0.7 - across * size * 0.6,
                     right = at + along * size * 0.7 + across * size * 0.6;
    kit.triangle(paint, at, right, tip);
    kit.triangle(paint, at, tip, left);
  }
};

// A body part of circles at heights: radius across, radius in depth is three quarters of it.
void add_outline(MeshKit& kit, const Paint& paint, glm::dvec3 foot, std::initializer_list<glm::dvec2> circles) {
  constexpr size_t columns = 10;
  std::vector<glm::dvec3> points;
  for (glm::dvec2 c : circles)
    for (size_t i = 0; i < columns; ++i) {
      const double angle = -2 * pi * double(i) / columns;
      points.push_back(foot + glm::dvec3(c.y * std::cos(angle), c.x, 0.72 * c.y * std::sin(angle)));
    }
  kit.surface(paint, points, columns, true);
}

}  // namespace

int make_tree(GlbWriter& out, const Materials& m, uint64_t seed, bool with_lights) {
  MeshKit kit;
  TreeMaker maker{kit, m, Rng(seed), with_lights};
  maker.branch({0, 0, 0}, glm::normalize(glm::dvec3(maker.rng.uniform(-0.06, 0.06), 1, maker.rng.uniform(-0.06, 0.06))),
               2.9, 0.15, 0);
  const std::vector<glm::dvec3> twigs = maker.twigs;
  for (glm::dvec3 twig : twigs)
    for (int i = 0; i < 4; ++i) maker.leaf(twig + 0.34 * maker.any_direction());
  return kit.write(out, "tree");
}

int make_person(GlbWriter& out, const Materials& m, Rng& rng, glm::dvec3 coat, glm::dvec3 umbrella) {
  MeshKit kit;
  const Paint cloth = m.matte.tinted(coat), trousers = m.matte.tinted({0.02, 0.02, 0.03}),
              skin = m.matte.tinted({0.35, 0.22, 0.16}), hair = m.matte.tinted({0.03, 0.02, 0.015});
  const double stride = rng.uniform(0.18, 0.34);
  for (double side : {-1.0, 1.0}) {
    const glm::dvec3 hip(side * 0.09, 0.85, 0), knee(side * 0.1, 0.48, -side * stride * 0.35 - 0.05),
        foot(side * 0.1, 0.08, -side * stride);
    kit.tube(trousers, hip, 0.085, knee, 0.065, 7);
    kit.tube(trousers, knee, 0.065, foot, 0.05, 7);
    kit.box(m.glass.tinted(glm::dvec3(0.02)), foot + glm::dvec3(-0.04, -0.08, -0.14),
            foot + glm::dvec3(0.04, 0.0, 0.06));
  }
  add_outline(kit, cloth, {0, 0, 0},
              {{0.56, 0.0},
               {0.56, 0.27},
               {0.75, 0.24},
               {1.02, 0.195},
               {1.2, 0.215},
               {1.36, 0.235},
               {1.45, 0.19},
               {1.5, 0.08},
               {1.52, 0}});
  add_outline(kit, skin, {0, 0, 0},
              {{1.46, 0.055}, {1.53, 0.055}, {1.56, 0.08}, {1.64, 0.098}, {1.7, 0.08}, {1.74, 0}});
  add_outline(kit, hair, {0, 0, 0.02}, {{1.55, 0.06}, {1.6, 0.108}, {1.67, 0.112}, {1.73, 0.08}, {1.765, 0}});
  const glm::dvec3 hand(0.2, 1.18, -0.26);
  kit.tube(cloth, {0.23, 1.38, 0}, 0.062, {0.29, 1.1, -0.05}, 0.055, 7);
  kit.tube(cloth, {0.29, 1.1, -0.05}, 0.055, hand, 0.045, 7);
  kit.tube(cloth, {-0.23, 1.38, 0}, 0.062, {-0.3, 1.08, 0.06}, 0.055, 7);
  kit.tube(cloth, {-0.3, 1.08, 0.06}, 0.055, {-0.28, 0.84, -0.06}, 0.045, 7);
  kit.box(m.matte.tinted({0.1, 0.06, 0.03}), {-0.34, 0.52, -0.2}, {-0.24, 0.82, 0.12}, MeshKit::all);
  // The umbrella: eight ribs, cloth hollow between them.
  const glm::dvec3 top(0.1, 2.06, -0.12);
  kit.tube(m.chrome, hand - glm::dvec3(0, 0.1, 0), 0.012, top + glm::dvec3(0, 0.08, 0), 0.01, 5);
  constexpr size_t columns = 16;
  std::vector<glm::dvec3> points;
  for (int ring = 0; ring <= 3; ++ring) {
    const double t = 1 - ring / 3.0;
    for (size_t i = 0; i < columns; ++i) {
      const double angle = -2 * pi * double(i) / columns, between = i % 2 ? 1 : 0;
      const double r = 0.6 * t * (1 - 0.07 * between * t);
      points.push_back(top + glm::dvec3(r * std::cos(angle), -0.26 * t * t + 0.03 * between * t, r * std::sin(angle)));
    }
  }
  kit.surface(m.leaf.tinted(umbrella), points, columns, true);
  return kit.write(out, "person");
}

}  // namespace candela::dusk
