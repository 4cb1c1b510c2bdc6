#include <algorithm>
#include <cmath>

#include "testscenes/light_arrays.h"
#include "testscenes/table.h"

// lights-stacked: the longest lists that a number of lights can make. Half of them lie along the view axis, each small
// enough to stay over the same few tiles, the others in one place, where every pixel takes light from nearly all of
// them.
namespace candela {
namespace {

constexpr glm::dvec3 eye{0, 1.7, 0}, aim{0, 0.9, -40}, heap{-2.2, 0.55, -7};

glm::dvec3 point_in_ball(Rng& rng) {
  for (;;) {
    const glm::dvec3 p(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (glm::dot(p, p) <= 1) return p;
  }
}

// Candela add up: the picture is about as bright whatever the number of lights.
void add_along_axis(LightArrays& lights, Rng& rng, bool is_spot, double fraction) {
  const glm::dvec3 axis = glm::normalize(aim - eye);
  const double depth = 1.5 * std::pow(2.0, rng.uniform(0, 4.7)), range = 0.07 * depth;  // 1.5 to 39 m
  lights.add(eye + depth * axis + 0.03 * depth * point_in_ball(rng),
             glm::mix(glm::dvec3(1, 0.55, 0.25), glm::dvec3(0.3, 0.6, 1), rng.uniform()),
             250 * fraction * range * range, range, {0.5, rng.uniform(2, 5), rng.uniform()});
  if (is_spot) lights.aim(glm::normalize(point_in_ball(rng) + glm::dvec3(0, -0.5, -0.5)));
}

void add_to_heap(LightArrays& lights, Rng& rng, bool is_spot, double fraction) {
  lights.add(heap + glm::dvec3(0, 0.75, 0) + 0.25 * point_in_ball(rng),
             glm::mix(glm::dvec3(0.35, 1, 0.5), glm::dvec3(1, 0.35, 0.8), rng.uniform()),
             (is_spot ? 80 : 30) * fraction, rng.uniform(1.2, 3.5), {0.5, rng.uniform(2, 5), rng.uniform()});
  if (is_spot) lights.aim(glm::normalize(glm::dvec3(0, -1, 0) + 0.7 * point_in_ball(rng)));
}

void add_geometry(GlbWriter& out) {
  const int floor =
      out.mesh("floor", out.primitive(ground(120, 1, 1)), out.material("floor", pbr({0.5, 0.5, 0.52, 1}, 0, 0.7)));
  out.node("floor", {{"mesh", floor}});
  const json ball = out.primitive(sphere(1, 24, 16)), cube = out.primitive(box({1, 1, 1}));
  const int clay = out.mesh("ball", ball, out.material("clay", pbr({0.75, 0.6, 0.5, 1}, 0, 0.5)));
  const int stone = out.mesh("box", cube, out.material("stone", pbr({0.6, 0.62, 0.65, 1}, 0, 0.8)));
  // Edges at many depths over the same pixels: balls and posts that grow with their distance, around the axis.
  const glm::dvec3 axis = glm::normalize(aim - eye);
  for (int i = 0; i < 5; ++i) {
    const double depth = 2.0 * std::pow(2.0, i), turn = 2.4 * i;
    const glm::dvec3 aside(std::cos(turn), std::sin(turn), 0);
    out.node("ball", {{"mesh", clay},
                      {"translation", vector_json(eye + depth * (axis + 0.03 * aside))},
                      {"scale", vector_json(glm::dvec3(0.022 * depth))}});
    const double height = 0.9 + 0.15 * i;
    out.node("post", {{"mesh", stone},
                      {"translation", vector_json({0.05 * depth * (i % 2 ? 1 : -1), height / 2, -depth * 1.2})},
                      {"scale", vector_json({0.012 * depth, height, 0.012 * depth})}});
  }
  out.node("wall", {{"mesh", stone}, {"translation", vector_json({0, 2, -42})}, {"scale", vector_json({20, 4, 1})}});
  out.node(
      "pedestal",
      {{"mesh", stone}, {"translation", vector_json({heap.x, 0.15, heap.z})}, {"scale", vector_json({1.4, 0.3, 1.4})}});
  out.node("statue", {{"mesh", clay}, {"translation", vector_json(heap)}, {"scale", vector_json(glm::dvec3(0.28))}});
}

}  // namespace

void make_lights_stacked(GlbWriter& out, SceneOptions& options) {
  add_geometry(out);
  const int lights = options.lights > 0 ? options.lights : 64;
  const double fraction = 1.0 / lights;
  LightArrays axis_points, axis_spots, heap_points, heap_spots;
  for (int i = 0; i < lights; ++i) {
    const bool is_spot = i % 2 == 0;
    if (i % 4 < 2)
      add_to_heap(is_spot ? heap_spots : heap_points, options.rng, is_spot, fraction);
    else
      add_along_axis(is_spot ? axis_spots : axis_points, options.rng, is_spot, fraction);
  }
  const int point = out.light({{"name", "point"}, {"type", "point"}, {"range", 1}});
  const int spot = out.light({{"name", "spot"},
                              {"type", "spot"},
                              {"range", 1},
                              {"spot", {{"innerConeAngle", number(0.2)}, {"outerConeAngle", number(0.8)}}}});
  axis_points.write(out, "points along the axis", point);
  axis_spots.write(out, "spots along the axis", spot);
  heap_points.write(out, "points in one place", point);
  heap_spots.write(out, "spots in one place", spot);
  out.camera_node(eye, aim, 0.8);
}

}  // namespace candela
