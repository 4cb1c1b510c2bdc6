#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/dusk.h"

// What stands on the pavement. Each at the origin of its own space; the street is towards +X.
namespace candela::dusk {
namespace {

using std::numbers::pi;

// An outline of (radius, height) with flat faces: every band has its own normals.
std::vector<OutlinePoint> faceted(std::initializer_list<glm::dvec2> points) {
  std::vector<OutlinePoint> outline;
  const std::vector<glm::dvec2> p(points);
  for (size_t i = 0; i + 1 < p.size(); ++i) {
    const glm::dvec2 along = p[i + 1] - p[i];
    const glm::dvec2 normal = glm::normalize(glm::dvec2(along.y, -along.x));
    outline.push_back({p[i].x, p[i].y, normal.x, normal.y});
    outline.push_back({p[i + 1].x, p[i + 1].y, normal.x, normal.y});
  }
  return outline;
}

const glm::dvec3 iron_color(0.09, 0.1, 0.1);

}  // namespace

Lantern make_street_lamp(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint iron = m.metal.tinted(iron_color);
  kit.turned(iron, {0, 0, 0},
             faceted({{0.26, 0}, {0.26, 0.12}, {0.18, 0.2}, {0.15, 0.75}, {0.19, 0.8}, {0.19, 0.88}, {0.1, 0.98}}), 10);
  kit.tube(iron, {0, 0.95, 0}, 0.085, {0, 5.8, 0}, 0.06, 10);
  for (double y : {3.2, 5.2}) kit.tube(iron, {0, y, 0}, 0.1, {0, y + 0.1, 0}, 0.1, 10, true);
  // The arm: a quarter of an ellipse out over the road, with a scroll under it.
  glm::dvec3 last(0, 5.8, 0);
  constexpr double reach = 1.7, rise = 0.9;
  for (int i = 1; i <= 8; ++i) {
    const double a = pi / 2 * i / 8;
    const glm::dvec3 next(reach * (1 - std::cos(a)), 5.8 + rise * std::sin(a), 0);
    kit.tube(iron, last, 0.05, next, 0.045, 7);
    last = next;
  }
  kit.tube(iron, {0, 5.3, 0}, 0.03, {0.75, 6.4, 0}, 0.025, 6);
  kit.tube(iron, {0, 5.8, 0}, 0.05, {0, 6.9, 0}, 0.01, 7);
  // The lantern: a bell over a bowl that glows.
  const glm::dvec3 head = last + glm::dvec3(0.05, 0, 0);
  kit.turned(iron, head + glm::dvec3(0, -0.42, 0),
             faceted({{0.36, 0}, {0.3, 0.12}, {0.17, 0.26}, {0.08, 0.34}, {0.05, 0.52}}), 14);
  const glm::dvec3 bowl = head + glm::dvec3(0, -0.42, 0);
  glow_band(kit, m, bowl, {0, -0.2}, {0.2, -0.14}, 10, lamp_glow);
  glow_band(kit, m, bowl, {0.2, -0.14}, {0.3, 0.01}, 10, lamp_glow);
  return {kit.write(out, "street lamp"), head + glm::dvec3(0, -0.72, 0)};
}

int make_bollard(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  kit.turned(m.metal.tinted(iron_color), {0, 0, 0},
             faceted({{0.13, 0},
                      {0.13, 0.08},
                      {0.085, 0.14},
                      {0.075, 0.72},
                      {0.1, 0.75},
                      {0.1, 0.8},
                      {0.07, 0.83},
                      {0.09, 0.9},
                      {0.07, 0.97},
                      {0, 1.0}}),
             10);
  kit.turned(m.matte.tinted(glm::dvec3(0.5)), {0, 0, 0}, faceted({{0.081, 0.62}, {0.081, 0.69}}), 10);
  return kit.write(out, "bollard");
}

int make_bench(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint wood = m.line_paint.tinted({0.16, 0.08, 0.035}), iron = m.metal.tinted(iron_color);
  for (int i = 0; i < 4; ++i)
    kit.box(wood, {-0.25 + 0.13 * i, 0.44, -0.85}, {-0.15 + 0.13 * i, 0.48, 0.85}, MeshKit::all);
  for (int i = 0; i < 3; ++i)
    kit.box(wood, {-0.3 - 0.03 * i, 0.56 + 0.13 * i, -0.85}, {-0.26 - 0.03 * i, 0.66 + 0.13 * i, 0.85}, MeshKit::all);
  for (double z : {-0.7, 0.7}) {
    kit.box(iron, {-0.27, 0, z - 0.03}, {-0.2, 0.44, z + 0.03}, MeshKit::all);
    kit.box(iron, {0.16, 0, z - 0.03}, {0.23, 0.44, z + 0.03}, MeshKit::all);
    kit.box(iron, {-0.27, 0.38, z - 0.03}, {0.23, 0.44, z + 0.03}, MeshKit::all);
    kit.tube(iron, {-0.24, 0.44, z}, 0.03, {-0.37, 0.98, z}, 0.025, 5);
    kit.tube(iron, {-0.28, 0.66, z}, 0.022, {0.18, 0.64, z}, 0.022, 5);
    kit.tube(iron, {0.18, 0.44, z}, 0.022, {0.18, 0.65, z}, 0.022, 5);
  }
  return kit.write(out, "bench");
}

int make_bin(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint green = m.metal.tinted({0.05, 0.1, 0.08});
  kit.tube(green, {0, 0.06, 0}, 0.22, {0, 0.78, 0}, 0.25, 14);
  kit.tube(m.matte.tinted(glm::dvec3(0.01)), {0, 0.7, 0}, 0.24, {0, 0.75, 0}, 0.24, 14, true);
  kit.turned(green, {0, 0.9, 0}, faceted({{0.28, 0}, {0.28, 0.05}, {0.15, 0.14}, {0, 0.17}}), 14);
  for (int i = 0; i < 4; ++i) {
    const double a = pi / 2 * i + 0.4;
    kit.tube(green, {0.23 * std::cos(a), 0.76, 0.23 * std::sin(a)}, 0.02,
             {0.23 * std::cos(a), 0.92, 0.23 * std::sin(a)}, 0.02, 4);
  }
  return kit.write(out, "bin");
}

int make_tree_grate(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  kit.box(m.metal.tinted(glm::dvec3(0.05)), {-0.75, 0, -0.75}, {0.75, 0.012, 0.75});
  kit.box(m.matte.tinted({0.03, 0.022, 0.016}), {-0.45, 0, -0.45}, {0.45, 0.03, 0.45});
  return kit.write(out, "tree grate");
}

int make_hydrant(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint red = m.car_paint.tinted({0.32, 0.025, 0.015});
  kit.turned(red, {0, 0, 0},
             faceted({{0.19, 0},
                      {0.19, 0.06},
                      {0.12, 0.1},
                      {0.12, 0.52},
                      {0.16, 0.54},
                      {0.16, 0.6},
                      {0.12, 0.68},
                      {0.05, 0.75},
                      {0, 0.77}}),
             12);
  kit.tube(red, {0, 0.42, -0.2}, 0.06, {0, 0.42, 0.2}, 0.06, 8, true);
  kit.tube(red, {0, 0.38, 0}, 0.08, {0.22, 0.38, 0}, 0.08, 8, true);
  return kit.write(out, "hydrant");
}

int make_kiosk(GlbWriter& out, const Materials& m) {
  // A column for posters, lit from within.
  MeshKit kit;
  const Paint green = m.metal.tinted({0.04, 0.09, 0.07});
  kit.turned(green, {0, 0, 0}, faceted({{0.72, 0}, {0.72, 0.35}, {0.66, 0.45}}), 16);
  for (int i = 0; i < 8; ++i) {
    const double a = 2 * pi * i / 8, b = 2 * pi * (i + 1) / 8;
    const glm::dvec3 p(0.66 * std::cos(a), 0.45, 0.66 * std::sin(a)), q(0.66 * std::cos(b), 0.45, 0.66 * std::sin(b));
    const Cell cell = cell_of(shop_columns, shop_rows, i);
    kit.quad({m.shops}, q, p - q, {0, 2.1, 0}, cell.corner, cell.far);
    kit.tube(green, p, 0.04, p + glm::dvec3(0, 2.1, 0), 0.04, 5);
  }
  kit.turned(green, {0, 2.55, 0},
             faceted({{0.66, 0}, {0.82, 0.06}, {0.82, 0.16}, {0.6, 0.3}, {0.35, 0.6}, {0.1, 0.75}, {0.03, 1.1}}), 16);
  return kit.write(out, "poster column");
}

TrafficLight make_traffic_light(GlbWriter& out, const Materials& m, bool red) {
  MeshKit kit;
  const Paint iron = m.metal.tinted(iron_color), black = m.matte.tinted(glm::dvec3(0.012));
  kit.tube(iron, {0, 0, 0}, 0.12, {0, 0.9, 0}, 0.1, 10);
  kit.tube(iron, {0, 0.9, 0}, 0.07, {0, 5.4, 0}, 0.06, 8);
  kit.tube(iron, {0, 5.2, 0}, 0.05, {3.2, 5.6, 0}, 0.04, 7);
  TrafficLight light{};
  const auto head = [&](glm::dvec3 at) {
    kit.box(black, at + glm::dvec3(-0.17, -0.5, -0.12), at + glm::dvec3(0.17, 0.5, 0.12), MeshKit::all);
    const std::array<Glow, 3> glows{red ? red_glow : no_glow, no_glow, red ? no_glow : green_glow};
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 centre = at + glm::dvec3(0, 0.31 - 0.31 * i, 0.125);
      std::vector<glm::dvec3> disc;
      for (int k = 0; k < 12; ++k) {
        const double a = 2 * pi * k / 12;
        disc.push_back(centre + glm::dvec3(0.11 * std::cos(a), 0.11 * std::sin(a), 0));
      }
      kit.polygon({m.glows}, disc, glow_uv(glows[size_t(i)]));
      kit.tube(black, centre, 0.13, centre + glm::dvec3(0, 0.02, 0.16), 0.12, 10);
    }
  };
  head({3.1, 5.35, 0.1});
  head({0.2, 3.1, 0.1});
  light.lamps = {glm::dvec3(3.1, red ? 5.66 : 5.04, 0.4), glm::dvec3(0.2, red ? 3.41 : 2.79, 0.4)};
  light.mesh = kit.write(out, "traffic light");
  return light;
}

int make_cable(GlbWriter& out, const Materials& m, double span_m, double sag_m, int bulbs) {
  MeshKit kit;
  const Paint black = m.matte.tinted(glm::dvec3(0.01));
  const auto at = [&](double t) { return glm::dvec3(span_m * (t - 0.5), -4 * sag_m * t * (1 - t), 0); };
  constexpr int pieces = 12;
  for (int i = 0; i < pieces; ++i) kit.tube(black, at(double(i) / pieces), 0.012, at((i + 1.0) / pieces), 0.012, 3);
  for (int i = 0; i < bulbs; ++i) {
    const glm::dvec3 p = at((i + 0.5) / bulbs) - glm::dvec3(0, 0.1, 0);
    constexpr double r = 0.045;
    for (int side = 0; side < 4; ++side) {
      const double a = pi / 2 * side;
      const glm::dvec3 way(std::cos(a), 0, std::sin(a)), across(-way.z, 0, way.x);
      glow_quad(kit, m, p + r * way + r * across - glm::dvec3(0, r, 0), -2 * r * across, {0, 2 * r, 0}, fairy_glow);
    }
  }
  return kit.write(out, "string of lights");
}

}  // namespace candela::dusk
