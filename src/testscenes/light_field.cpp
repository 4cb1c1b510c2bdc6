#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "math/transforms.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

// light-field: for tests that no light is lost. The seed chooses camera, surfaces and lights; each kind of light below
// is one on which some light culling is known to have failed. A light is a node of its own.
namespace candela {
namespace {

using std::numbers::pi;
constexpr int default_lights = 64;
// Tile edges depend on the picture's size; lights on edges lie on those of a picture this many tiles of 16 px wide and
// high.
constexpr glm::dvec2 tiles{40, 22.5};

struct Lens {
  glm::dmat3 world_from_view;
  glm::dvec3 eye;
  bool perspective;
  glm::dvec2 half;  // tangents of the half angles, or half sizes in metres, for 16:9

  // `at`: -1 to 1 over the picture; depth along the view axis.
  glm::dvec3 point(glm::dvec2 at, double depth) const {
    const double wide = perspective ? depth : 1;
    return eye + world_from_view * glm::dvec3(at.x * half.x * wide, at.y * half.y * wide, -depth);
  }
  // Metres across half the picture's height.
  double half_height(double depth) const { return half.y * (perspective ? depth : 1); }
};

struct Surface {
  glm::dvec3 centre;
  double size, depth;
};

double log_uniform(Rng& rng, double low, double high) { return low * std::pow(high / low, rng.uniform()); }

glm::dvec3 direction(Rng& rng) {
  for (;;) {
    const glm::dvec3 d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (const double square = glm::dot(d, d); square > 0.01 && square <= 1) return d / std::sqrt(square);
  }
}

json aimed(glm::dvec3 along) {
  return quaternion_json(glm::quat_cast(glm::dmat3(look_at_pose(-along, glm::dvec3(0)))));
}

Lens make_camera(GlbWriter& out, Rng& rng) {
  Lens lens;
  const double kind = rng.uniform();
  lens.perspective = kind < 0.8;
  const double yfov = kind < 0.5 ? rng.uniform(0.6, 1.2) : kind < 0.65 ? 150 * pi / 180 : 1 * pi / 180;
  lens.half.y = lens.perspective ? std::tan(yfov / 2) : log_uniform(rng, 0.5, 200);
  lens.half.x = lens.half.y * 16 / 9;
  // Multiples of 1/64 m, so that a light at the eye is at the eye to the last bit.
  for (int c = 0; c < 3; ++c) lens.eye[c] = std::round(rng.uniform(-500, 500) * 64) / 64;
  const double yaw = rng.uniform(0, 2 * pi), pitch = rng.uniform(-0.9, 0.9);
  const glm::dvec3 along(std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch));
  lens.world_from_view = glm::dmat3(look_at_pose(-along, glm::dvec3(0)));
  const json shape =
      lens.perspective
          ? json{{"yfov", number(yfov)}, {"znear", number(0.05)}}
          : json{
                {"xmag", number(lens.half.x)}, {"ymag", number(lens.half.y)}, {"znear", number(0.05)}, {"zfar", 20000}};
  const char* type = lens.perspective ? "perspective" : "orthographic";
  const int camera = out.camera({{"type", type}, {type, shape}});
  out.node("camera", {{"camera", camera}, {"translation", vector_json(lens.eye)}, {"rotation", aimed(along)}});
  return lens;
}

std::vector<Surface> make_surfaces(GlbWriter& out, Rng& rng, const Lens& lens) {
  const std::array shapes{out.primitive(box({1, 1, 1})), out.primitive(sphere(0.5, 20, 12)), out.primitive(quad(1, 1))};
  const std::array materials{out.material("clay", pbr({0.7, 0.6, 0.5, 1}, 0, 0.8)),
                             out.material("paint", pbr({0.5, 0.6, 0.7, 1}, 0, 0.3)),
                             out.material("metal", pbr({0.8, 0.75, 0.6, 1}, 1, 0.45))};
  json masked = pbr_textured(out.texture("grid", png_from(16, 16, 4,
                                                          [](double u, double v) {
                                                            const bool hole = int(u * 8) % 2 && int(v * 8) % 2;
                                                            return glm::dvec4(0.7, 0.7, 0.6, hole ? 0 : 1);
                                                          })),
                             0, 0.7);
  masked["alphaMode"] = "MASK";
  masked["doubleSided"] = true;
  json blended = pbr({0.5, 0.8, 0.9, 0.45}, 0, 0.4);
  blended["alphaMode"] = "BLEND";
  blended["doubleSided"] = true;
  const std::array<json, 3>& s = shapes;
  std::array<std::array<int, 3>, 3> opaque;
  for (size_t i = 0; i < 3; ++i)
    for (size_t m = 0; m < 3; ++m) opaque[i][m] = out.mesh("surface", s[i], materials[m]);
  const int net = out.mesh("net", s[2], out.material("net", masked)),
            pane = out.mesh("pane", s[2], out.material("pane", blended));

  std::vector<Surface> surfaces;
  const auto place = [&](const char* name, int mesh, glm::dvec2 at, double depth, double size, bool is_flat) {
    const glm::dvec3 centre = lens.point(at, depth);
    // Panes lean towards the camera, so that they are seen; the rest as it comes.
    const glm::dvec3 back = lens.world_from_view * glm::dvec3(0, 0, 1);
    const glm::dvec3 facing = glm::normalize(is_flat ? back + 0.8 * direction(rng) : direction(rng));
    out.node(name, {{"mesh", mesh},
                    {"translation", vector_json(centre)},
                    {"rotation", aimed(-facing)},
                    {"scale", vector_json(glm::dvec3(size))}});
    surfaces.push_back({centre, size, depth});
  };
  const auto somewhere = [&] { return glm::dvec2(rng.uniform(-0.9, 0.9), rng.uniform(-0.9, 0.9)); };
  for (const double nearest : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 64.0, 300.0, 1500.0, 5000.0}) {
    const double depth = nearest * rng.uniform(1, 1.8);
    const size_t shape = size_t(rng.next() % 3), material = size_t(rng.next() % 3);
    place("surface", opaque[shape][material], somewhere(), depth,
          lens.half_height(depth) * rng.uniform(0.25, depth > 10 ? 1.2 : 0.5), shape == 2);
  }
  // Behind them a wall, for most seeds: with it, no tile holds sky.
  const double far = log_uniform(rng, 12, 2500);
  if (rng.uniform() < 0.7) place("wall", opaque[2][0], {0, 0}, far, 6 * lens.half_height(far), true);
  for (int i = 0; i < 2; ++i) {
    const double depth = log_uniform(rng, 0.8, 40);
    place("pane", pane, somewhere(), depth, lens.half_height(depth) * rng.uniform(0.5, 1), true);
  }
  const double depth = log_uniform(rng, 0.8, 20);
  place("net", net, somewhere(), depth, lens.half_height(depth) * rng.uniform(0.5, 1), true);
  return surfaces;
}

struct FieldLight {
  const char* name = "point";
  const char* type = "point";
  glm::dvec3 at{0}, along{0, -1, 0};
  double candela = 1, range = 0;  // range 0: none
  double inner = 0, outer = 0.8;
};

// Which of the kinds a light of this number is: most are ordinary, and those that reach everything are few.
enum Kind {
  point_kind,
  spot_kind,
  needle,
  half_space,
  sharp_edge,
  tiny_range,
  on_surface,
  power_of_two,
  behind,
  bright,
  around_camera,
  tile_edge,
  at_camera,
  dark_kind,
  huge_range,
  touching,
  kinds
};

// What reaches everything is weak, for a sum of large numbers would hide a small one that was lost.
constexpr double most_unbounded_candela = 2;
// One or two of each light that nothing bounds.
constexpr int rangeless_at = 9, rangeless_spot_at = 41, sun_at = 25, second_sun_at = 57;

FieldLight make_light(Rng& rng, const Lens& lens, const std::vector<Surface>& surfaces, int index) {
  const Surface& s = surfaces[size_t(rng.next() % surfaces.size())];
  const glm::dvec3 aside = direction(rng), back = lens.world_from_view * glm::dvec3(0, 0, 1);
  FieldLight l;
  l.at = s.centre + s.size * (rng.uniform(0.5, 0.9) * aside + 0.3 * back);
  l.along = glm::normalize(s.centre - l.at + 0.2 * s.size * direction(rng));
  const double strength = s.size * s.size * rng.uniform(0.4, 3);  // 0.4 to 3 lux a surface's size away
  l.candela = strength;
  l.range = s.size * rng.uniform(0.6, 2.5);
  const auto spot = [&](const char* name, double inner, double outer) {
    l.name = name, l.type = "spot", l.inner = inner, l.outer = outer;
  };
  if (index == rangeless_at || index == rangeless_spot_at) {
    l.name = "no range", l.range = 0, l.candela = std::min(0.3 * strength, most_unbounded_candela);
    if (index == rangeless_spot_at) spot("spot without range", 0.3, 0.6);
    return l;
  }
  if (index == sun_at || index == second_sun_at) {
    l.name = "sun", l.type = "directional", l.range = 0, l.candela = rng.uniform(0.05, 0.3);
    l.along = glm::normalize(direction(rng) - 1.5 * back);
    return l;
  }
  switch (Kind(rng.next() % kinds)) {
    case spot_kind:
      spot("spot", 0.2, rng.uniform(0.4, 1.2));
      break;
    case needle:
      spot("needle", 0, log_uniform(rng, 1e-4, 0.03));
      l.candela *= 20, l.range *= 2;
      break;
    case half_space:
      spot("half space", rng.uniform(0, 1.5),
           rng.uniform() < 0.5 ? pi / 2 - 1e-6 : pi / 2 - log_uniform(rng, 1e-5, 0.02));
      break;
    case sharp_edge:
      l.outer = rng.uniform(0.05, 1.5);
      spot("sharp edge", l.outer - 2e-6, l.outer);
      break;
    case tiny_range:
      l.name = "tiny range", l.range = log_uniform(rng, 1e-3, 0.05), l.candela = l.range * l.range * 4;
      l.at = s.centre + 0.5 * s.size * back + l.range * 0.5 * aside;
      break;
    case on_surface:
      l.name = "on a surface", l.at = s.centre;
      if (rng.uniform() < 0.5) spot("spot on a surface", 0.1, rng.uniform(0.3, 1.57));
      break;
    case power_of_two: {
      const double depth = std::exp2(std::floor(rng.uniform(-2, 12)));
      l.name = "power of two", l.range = std::exp2(std::floor(std::log2(depth)) - 2);
      l.at = lens.point({rng.uniform(-0.9, 0.9), rng.uniform(-0.9, 0.9)}, depth), l.candela = l.range * l.range;
      break;
    }
    case behind: {
      const double depth = log_uniform(rng, 0.05, 50);
      l.at = lens.eye + depth * back + 0.3 * depth * aside, l.range = depth * rng.uniform(1.2, 6);
      l.candela = l.range * l.range * 0.2;
      l.name = "behind the camera";
      if (rng.uniform() < 0.5) {
        spot("spot behind the camera", 0.1, rng.uniform(0.3, 1.4));
        l.along = glm::normalize(-back + 0.3 * direction(rng));
      }
      break;
    }
    case bright:
      l.name = "bright", l.candela = 1e4 * strength, l.range = s.size * rng.uniform(0.05, 0.2);
      l.at = s.centre + 0.5 * s.size * back + 0.5 * l.range * aside;
      break;
    case around_camera:
      l.range = log_uniform(rng, 0.3, 300), l.at = lens.eye + 0.6 * l.range * aside;
      l.name = "around the camera", l.candela = 0.03 * l.range * l.range;
      if (rng.uniform() < 0.3) {
        spot("spot around the camera", 0, 1.5);
        l.along = -aside;
      }
      break;
    case tile_edge: {
      const glm::dvec2 at = 2.0 * glm::dvec2(rng.next() % 40, rng.next() % 22) / tiles - 1.0;
      l.name = "tile edge", l.at = lens.point({at.x, -at.y}, s.depth * rng.uniform(0.8, 1));
      if (rng.uniform() < 0.4) spot("spot on a tile edge", 0, rng.uniform(0.1, 1));
      break;
    }
    case at_camera:
      l.at = lens.eye, l.range = log_uniform(rng, 0.5, 5000), l.candela = rng.uniform(0.05, 0.5),
      l.name = "at the camera";
      if (rng.uniform() < 0.5) {
        spot("spot at the camera", 0, rng.uniform(0.01, 0.4));
        l.along = -back;
      }
      break;
    case dark_kind:
      l.name = "dark", l.candela = 0;
      break;
    case huge_range:
      l.name = "huge range", l.range = 1e6, l.candela = std::min(0.2 * strength, most_unbounded_candela);
      break;
    case touching: {
      // The range or the cone just reaches the surface's centre.
      const double distance = glm::length(s.centre - l.at);
      l.name = "touching", l.range = distance * (1 + 1e-6);
      if (rng.uniform() < 0.5) {
        spot("touching spot", 0, rng.uniform(0.1, 1));
        const glm::dvec3 towards = (s.centre - l.at) / distance;
        const glm::dvec3 across = glm::normalize(glm::cross(towards, aside + glm::dvec3(0.1, 0.2, 0.3)));
        l.along = std::cos(l.outer) * towards + std::sin(l.outer) * across, l.range = 2 * distance;
      }
      break;
    }
    default:
      break;
  }
  return l;
}

void write_light(GlbWriter& out, Rng& rng, const FieldLight& l, int index) {
  const std::string name = std::string(l.name) + " " + std::to_string(index);
  json light = {{"name", name},
                {"type", l.type},
                {"intensity", number(l.candela)},
                {"color", vector_json({rng.uniform(0.3, 1), rng.uniform(0.3, 1), rng.uniform(0.3, 1)})}};
  if (l.range > 0) light["range"] = number(l.range);
  if (std::string_view(l.type) == "spot")
    light["spot"] = {{"innerConeAngle", number(l.inner)}, {"outerConeAngle", number(l.outer)}};
  out.node(name, {{"translation", vector_json(l.at)},
                  {"rotation", aimed(l.along)},
                  {"extensions", {{"KHR_lights_punctual", {{"light", out.light(light)}}}}}});
}

}  // namespace

void make_light_field(GlbWriter& out, SceneOptions& options) {
  Rng& rng = options.rng;
  const Lens lens = make_camera(out, rng);
  const std::vector<Surface> surfaces = make_surfaces(out, rng, lens);
  const int lights = options.lights > 0 ? options.lights : default_lights;
  for (int i = 0; i < lights; ++i) write_light(out, rng, make_light(rng, lens, surfaces, i), i);
}

}  // namespace candela
