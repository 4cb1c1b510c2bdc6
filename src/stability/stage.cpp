#include "stability/stage.h"

#include "math/transforms.h"

namespace candela::stability {
namespace {

double on_grid(double v) { return std::round(v * 64) / 64; }

}  // namespace

json exact(glm::dvec3 v) { return json::array({v.x, v.y, v.z}); }
json exact(glm::dquat q) { return json::array({q.x, q.y, q.z, q.w}); }

json lit(glm::dvec3 color, double metallic, double roughness) {
  return {{"pbrMetallicRoughness",
           {{"baseColorFactor", {color.x, color.y, color.z, 1}},
            {"metallicFactor", metallic},
            {"roughnessFactor", roughness}}},
          {"doubleSided", true}};
}

int place(GlbWriter& out, const Shape& shape, json material, glm::dvec3 at, glm::dvec3 scale) {
  const int mesh = out.mesh("thing", out.primitive(shape), out.material("material", std::move(material)));
  json node = {{"mesh", mesh}, {"translation", exact(at)}};
  if (scale != glm::dvec3(1)) node["scale"] = exact(scale);
  return out.node("thing", std::move(node));
}

glm::dquat facing(glm::dvec3 direction) {
  return glm::quat_cast(glm::dmat3(look_at_pose(-glm::normalize(direction), glm::dvec3(0))));
}

void camera(GlbWriter& out, glm::dvec3 eye, glm::dvec3 target, double yfov_rad, double near_m) {
  const int index = out.camera({{"type", "perspective"}, {"perspective", {{"yfov", yfov_rad}, {"znear", near_m}}}});
  out.node("camera", {{"camera", index}, {"translation", exact(eye)}, {"rotation", exact(facing(target - eye))}});
}

namespace {
void add_light(GlbWriter& out, json light, json node, json more) {
  light.update(more);
  node["extensions"] = {{"KHR_lights_punctual", {{"light", out.light(std::move(light))}}}};
  out.node("light", std::move(node));
}
}  // namespace

void sun(GlbWriter& out, glm::dvec3 from, double lux) {
  add_light(out, {{"type", "directional"}, {"intensity", lux}}, {{"rotation", exact(facing(-from))}}, json::object());
}

void point(GlbWriter& out, glm::dvec3 at, double candela, json more) {
  add_light(out, {{"type", "point"}, {"intensity", candela}}, {{"translation", exact(at)}}, std::move(more));
}

void spot(GlbWriter& out, glm::dvec3 at, glm::dvec3 target, double candela, double inner_rad, double outer_rad,
          json more) {
  add_light(out,
            {{"type", "spot"},
             {"intensity", candela},
             {"spot", {{"innerConeAngle", inner_rad}, {"outerConeAngle", outer_rad}}}},
            {{"translation", exact(at)}, {"rotation", exact(facing(target - at))}}, std::move(more));
}

void room(GlbWriter& out, Rng& rng, const Room& how) {
  const auto color = [&] { return glm::dvec3(rng.uniform(0.2, 0.9), rng.uniform(0.2, 0.9), rng.uniform(0.2, 0.9)); };
  const double aside = on_grid(rng.uniform(0.75, 1.25)), rough = rng.uniform(0.3, 0.6);
  const glm::dvec3 scale(how.scale);
  place(out, ground(8, 1, 1), lit(color(), 0, 0.7), how.at({0, 0, 0}), scale);
  place(out, sphere(0.5, 48, 32), lit(color(), 1, rough), how.at({-aside, 0.5, 0}), scale);
  place(out, box({0.75, 0.75, 0.75}), lit(color(), 0, 0.5), how.at({aside, 0.375, -0.5}), scale);
}

void room_camera(GlbWriter& out, const Room& how) {
  camera(out, how.at({0.5, 1.75, 4.5}), how.at({0, 0.5, 0}), 0.7, how.near_m * how.scale);
}

void lit_room(GlbWriter& out, Rng& rng, const Room& how) {
  room(out, rng, how);
  room_camera(out, how);
  point(out, how.at({-0.5, 2.5, 2.5}), 20 * how.scale * how.scale);
}

StabilityScene scene_of(const GlbWriter& out) {
  StabilityScene scene;
  scene.file = out.bytes();
  scene.job.width_px = 64, scene.job.height_px = 48, scene.job.samples = 1;
  scene.job.settings = {{"lights", "floor_lux", "0"}, {"lights", "few", "0"}};
  return scene;
}

StabilityScene filled(StabilityInput& in, const Fill& fill) {
  GlbWriter out;
  lit_room(out, in.rng);
  fill(out);
  return scene_of(out);
}

StabilityScene filled_alike(StabilityInput& in, const Fill& fill, const Fill& fill_plain, double bound) {
  StabilityInput again = in;
  StabilityScene scene = filled(in, fill);
  scene.plain = filled(again, fill_plain).file;
  scene.plain_bound = bound;
  scene.reference = false;
  return scene;
}

StabilityScene beside_plain(StabilityInput& in, const Room& how, double bound,
                            const std::function<void(GlbWriter& out, Rng& rng)>& fill) {
  GlbWriter out, plain;
  Rng again = in.rng;
  lit_room(out, in.rng, how);
  lit_room(plain, again);
  if (fill) fill(out, in.rng);
  StabilityScene scene = scene_of(out);
  scene.plain = plain.bytes();
  scene.plain_bound = bound;
  return scene;
}

FloatImage sky_image(int width, int height, const std::function<glm::vec3(int x, int y)>& radiance) {
  FloatImage image;
  image.width = width, image.height = height;
  for (const char* name : {"R", "G", "B"}) {
    Channel& channel = image.channels.emplace_back();
    channel.name = name;
    channel.f.resize(size_t(width) * size_t(height));
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::vec3 value = radiance(x, y);
      for (int c = 0; c < 3; ++c) image.channels[size_t(c)].f[size_t(y) * size_t(width) + size_t(x)] = value[c];
    }
  return image;
}

json raw_primitive(GlbWriter& out, const std::vector<glm::dvec3>& position, const std::vector<glm::dvec3>& normal,
                   const std::vector<uint32_t>& index) {
  Shape shape;
  shape.position = position, shape.normal = normal, shape.index = index;
  return out.primitive(shape);
}

void raw_node(GlbWriter& out, json primitive, json material, json properties) {
  properties["mesh"] = out.mesh("raw", std::move(primitive), out.material("raw", std::move(material)));
  out.node("raw", std::move(properties));
}

}  // namespace candela::stability
