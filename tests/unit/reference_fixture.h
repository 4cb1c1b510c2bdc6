#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <numbers>

#include "math/transforms.h"
#include "reference/film.h"
#include "reference/visibility.h"
#include "scene_pieces.h"

namespace candela::reference::test {

using namespace candela::test;

// Bright above, black below.
inline Sky upper_half() {
  DecodedImage image;
  image.width = 1, image.height = 128, image.format = DecodedImage::Format::rgba32f;
  std::vector<float> texels(4 * 128, 0.0f);
  std::fill(texels.begin(), texels.begin() + 4 * 64, 1.0f);
  image.pixels.resize(texels.size() * 4);
  std::memcpy(image.pixels.data(), texels.data(), image.pixels.size());
  return Sky(image);
}

// A posed scene of a test with everything that the world points into.
struct TestWorld {
  Scene scene;
  Pose pose;
  View view;
  FrameData frame;
  std::vector<std::string> warnings;
  std::unique_ptr<World> world;
};

struct TestCamera {
  glm::dvec3 eye{0, 0, 4}, target{0};
  double yfov_deg = 45;
  int width = 16, height = 16;
  std::string camera;  // of the scene, instead
};

inline std::unique_ptr<TestWorld> make_world(const GltfBuilder& builder, const TestCamera& camera = {}, Sky sky = {},
                                             bool sky_visible = false, glm::dvec4 background = glm::dvec4(0),
                                             bool glass = false, std::optional<Fog> fog = {}, double sun_radius_rad = 0,
                                             std::optional<Occlusion> occlusion = {}, std::vector<Fog> more_fog = {}) {
  auto t = std::make_unique<TestWorld>();
  auto scene = builder.load(glass ? LoadFor::path_tracing : LoadFor::raster);
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().text());
  if (!scene) return nullptr;
  t->scene = std::move(*scene);
  t->pose = evaluate_pose(t->scene, {}, 0);
  CameraRequest request;
  request.camera = camera.camera;
  if (camera.camera.empty())
    request.eye = camera.eye, request.target = camera.target, request.yfov_deg = camera.yfov_deg;
  auto view = make_view(t->scene, t->pose, request, camera.width, camera.height, world_bounds(t->scene, t->pose));
  EXPECT_TRUE(view) << (view ? "" : view.error().text());
  if (!view) return nullptr;
  t->view = *view;
  t->frame = make_frame_data(t->scene, t->pose, t->view);
  for (LightItem& light : t->frame.lights)
    if (light.type == LightType::directional) light.radius_rad = sun_radius_rad;
  WorldInput input{t->scene, t->pose, t->view, t->frame};
  input.sky = std::move(sky), input.sky_visible = sky_visible, input.background = background, input.glass = glass;
  input.fog = fog;
  input.more_fog = std::move(more_fog);
  input.occlusion = occlusion;
  t->world = std::make_unique<World>(input, t->warnings);
  EXPECT_TRUE(t->warnings.empty());
  return t;
}

inline Film traced(const TestWorld& t, const TraceSettings& settings, const TestCamera& camera, int spp,
                   bool with_terms = false, bool counted = false) {
  Film film(camera.width, camera.height, {.fog = !t.world->media().empty(), .terms = with_terms, .traversal = counted});
  const Integrator integrator(*t.world, settings, camera.width, camera.height);
  EXPECT_TRUE(film.add(integrator, spp, [](double) { return true; }));
  return film;
}
// Settings for pictures without noise of the pixel: one sample at its centre.
inline TraceSettings centred(Mode mode = Mode::direct) {
  TraceSettings s;
  s.mode = mode;
  s.sampler = {SamplerKind::uniform, 1, 0};
  return s;
}
inline TraceSettings path_settings(int bounces = 0) {
  TraceSettings s;
  s.mode = Mode::path;
  s.most_bounces = bounces;
  return s;
}

// The mean over all pixels, and the standard error of it from the pixels' variances.
struct MeanError {
  double mean = 0, error = 0;
};
inline MeanError mean_of(const Film& film, int channel = 0) {
  MeanError m;
  for (size_t i = 0; i < film.pixels(); ++i) m.mean += film.mean(i)[channel], m.error += film.variance(i)[channel];
  m.mean /= double(film.pixels());
  m.error = std::sqrt(m.error) / double(film.pixels());
  return m;
}

// The point of the plane z = 0 that a pixel's centre sees from `eye` along -Z.
inline glm::dvec3 seen_on_plane(const TestCamera& c, size_t pixel) {
  const double tan_y = std::tan(c.yfov_deg * std::numbers::pi / 360), tan_x = tan_y * c.width / c.height;
  const double x = double(pixel % size_t(c.width)), y = double(pixel / size_t(c.width));
  return {c.eye.x + c.eye.z * tan_x * (2 * (x + 0.5) / c.width - 1),
          c.eye.y - c.eye.z * tan_y * (2 * (y + 0.5) / c.height - 1), 0};
}

// A sphere about the origin of longitudes and latitudes; inward: seen from inside. Flat or smooth normals.
inline int add_sphere_mesh(GltfBuilder& b, float radius, int material, int rings, bool inward = false) {
  std::vector<float> position, normal;
  std::vector<uint32_t> index;
  const int segments = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s <= segments; ++s) {
      const double polar = std::numbers::pi * r / rings, longitude = 2 * std::numbers::pi * s / segments;
      const glm::dvec3 d(std::sin(polar) * std::cos(longitude), std::cos(polar), std::sin(polar) * std::sin(longitude));
      for (int i = 0; i < 3; ++i)
        position.push_back(float(radius * d[i])), normal.push_back(float(inward ? -d[i] : d[i]));
    }
  const auto at = [&](int r, int s) { return uint32_t(r * (segments + 1) + s); };
  const auto triangle = [&](uint32_t x, uint32_t y, uint32_t z) {
    for (const uint32_t k : {x, inward ? z : y, inward ? y : z}) index.push_back(k);
  };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      if (r > 0) triangle(at(r, s), at(r, s + 1), at(r + 1, s));
      if (r < rings - 1) triangle(at(r, s + 1), at(r + 1, s + 1), at(r + 1, s));
    }
  const int p = b.accessor<float>("VEC3", position), n = b.accessor<float>("VEC3", normal);
  Json& primitive = b.primitive({{"POSITION", p}, {"NORMAL", n}});
  primitive["indices"] = b.accessor<uint32_t>("SCALAR", index);
  primitive["material"] = material;
  return int(b.json["meshes"].size()) - 1;
}

// The inside of a box of half size `half`, flat normals.
inline int add_room_mesh(GltfBuilder& b, float half, int material) {
  std::vector<float> position, normal;
  std::vector<uint16_t> index;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const uint16_t first = uint16_t(position.size() / 3);
      for (const auto& [u, v] : {std::pair(-1.0f, -1.0f), {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
        float p[3], n[3] = {0, 0, 0};
        p[axis] = side * half, p[(axis + 1) % 3] = u * half, p[(axis + 2) % 3] = v * half;
        n[axis] = -side;
        position.insert(position.end(), p, p + 3);
        normal.insert(normal.end(), n, n + 3);
      }
      for (const int k : side < 0 ? std::array{0, 1, 2, 0, 2, 3} : std::array{0, 2, 1, 0, 3, 2})
        index.push_back(uint16_t(first + k));
    }
  const int p = b.accessor<float>("VEC3", position), n = b.accessor<float>("VEC3", normal);
  Json& primitive = b.primitive({{"POSITION", p}, {"NORMAL", n}});
  primitive["indices"] = b.accessor<uint16_t>("SCALAR", index);
  primitive["material"] = material;
  return int(b.json["meshes"].size()) - 1;
}

inline Json emitting(Json material, double radiance) {
  material["emissiveFactor"] = {1, 1, 1};
  material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", radiance}};
  return material;
}
// Clear glass; thickness 0: a sheet that does not bend light.
inline Json glass_material(double ior, double roughness, double thickness, glm::dvec3 color = glm::dvec3(1)) {
  Json m = {{"pbrMetallicRoughness", base_color(color.x, color.y, color.z)}};
  m["pbrMetallicRoughness"]["roughnessFactor"] = roughness;
  m["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                     {"KHR_materials_ior", {{"ior", ior}}}};
  if (thickness > 0) m["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", thickness}};
  return m;
}
inline Json absorbing(Json material, double distance_m, glm::dvec3 color) {
  Json& volume = material["extensions"]["KHR_materials_volume"];
  volume["attenuationDistance"] = distance_m, volume["attenuationColor"] = {color.x, color.y, color.z};
  return material;
}
// Two squares of half size `half` that face away from each other, the upper at z = 0: a slab whose sides are far away.
inline void add_slab(GltfBuilder& b, float half, double thickness_m, int material) {
  const int mesh = add_square_mesh(b, half, material);
  add_node(b, {{"mesh", mesh}});
  add_node(b, {{"mesh", mesh}, {"translation", {0, 0, -thickness_m}}, {"rotation", {1, 0, 0, 0}}});
}
// Extensions that materials and lights of these tests use.
inline void use_all(GltfBuilder& b) {
  b.json["extensionsUsed"] = {
      "KHR_lights_punctual",        "KHR_materials_specular", "KHR_materials_unlit", "KHR_materials_emissive_strength",
      "KHR_materials_transmission", "KHR_materials_volume",   "KHR_materials_ior",   "KHR_materials_dispersion"};
}

}  // namespace candela::reference::test
