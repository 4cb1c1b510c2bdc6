// Reliefs: along the wall, without depth and with a great one, by texture coordinates that are mirrored, stretched or
// none, of one texel, and from inside the layer.
#include "stability/stage.h"
#include "testscenes/procedural_textures.h"

namespace candela::stability {
namespace {

struct Wall {
  double depth = 0.1;
  int texels = 16;
  glm::dvec2 uv_repeat{1, 1};
  glm::dvec3 scale{1, 1, 1};
  bool silhouettes = true, uvs = true, lit = true;
  double even = -1;  // a height that all texels have; below 0: hills
};

json without_light(GlbWriter& out, json material) {
  out.use_extension("KHR_materials_unlit");
  material["extensions"]["KHR_materials_unlit"] = json::object();
  return material;
}
json relief_material(GlbWriter& out, const Wall& wall) {
  out.use_extension("CANDELA_relief");
  const int heights = out.texture("heights", png_from(wall.texels, wall.texels, 3, [&](double u, double v) {
                                    const double hills = tiling_noise(u, v, 4, 3);
                                    return glm::dvec4(glm::dvec3(wall.even >= 0 ? wall.even : hills), 1);
                                  }));
  json material = lit({0.7, 0.5, 0.4}, 0, 0.8);
  material["doubleSided"] = false;
  material["extensions"]["CANDELA_relief"] = {
      {"heightTexture", {{"index", heights}}}, {"depth", wall.depth}, {"silhouettes", wall.silhouettes}};
  return wall.lit ? material : without_light(out, material);
}
void put_wall(GlbWriter& out, const Wall& wall, glm::dvec3 at) {
  Shape shape = quad(2, 2, wall.uv_repeat);
  if (!wall.uvs) shape.uv.clear();
  place(out, shape, relief_material(out, wall), at, wall.scale);
}
StabilityScene finish(GlbWriter& out, glm::dvec3 eye, glm::dvec3 target) {
  point(out, {0.5, 0.8, 1.5}, 10);
  camera(out, eye, target, 0.8, 0.001);
  StabilityScene scene = scene_of(out);
  scene.job.settings.push_back({"relief", "steps", "0"});
  scene.stray_fraction = 0.002;  // outlines of hills, where a place is in or out by rounding
  return scene;
}
StabilityScene wall_alone(const Wall& wall, glm::dvec3 eye = {0.4, -0.3, 2.6}, glm::dvec3 target = {0, 0, 0}) {
  GlbWriter out;
  put_wall(out, wall, {0, 0, 0});
  return finish(out, eye, target);
}
// Beside a scene that looks the same.
StabilityScene wall_alike(const Wall& wall, glm::dvec3 eye, glm::dvec3 target, const Fill& plain, double bound) {
  StabilityScene scene = wall_alone(wall, eye, target);
  GlbWriter out;
  plain(out);
  scene.plain = finish(out, eye, target).file;
  scene.plain_bound = bound;
  return scene;
}
json flat_material() {
  json material = lit({0.7, 0.5, 0.4}, 0, 0.8);
  material["doubleSided"] = false;
  return material;
}
StabilityScene by_sample(StabilityScene scene) {
  scene.job.samples = 4;
  scene.job.settings.push_back({"relief", "by_sample", "1"});
  scene.reference = false;  // which is asked at pixels' centres
  return scene;
}
// A wall whose heights are all 1, beside the flat square that is seen of its floor through the wall's own: what the eye
// projects of that on the plane below, as far as the texture coordinates go. Without light: outlines alone differ.
StabilityScene even_by_sample(double depth, glm::dvec3 eye, glm::dvec3 target) {
  const auto below = [&](double end, double of_eye) { return end + (end - of_eye) * depth / eye.z; };
  const glm::dvec2 low(std::max(-1.0, below(-1, eye.x)), std::max(-1.0, below(-1, eye.y))),
      high(std::min(1.0, below(1, eye.x)), std::min(1.0, below(1, eye.y)));
  const glm::dvec2 middle = 0.5 * (low + high), size = high - low;
  return by_sample(wall_alike(
      {.depth = depth, .lit = false, .even = 1}, eye, target,
      [&](GlbWriter& out) {
        place(out, quad(size.x, size.y), without_light(out, flat_material()), {middle.x, middle.y, -depth});
      },
      1e-3));
}

}  // namespace

void add_relief(Recipes& all) {
  const auto add = [&](std::string name, std::string what, std::function<StabilityScene()> make) {
    all.push_back({"relief", std::move(name), std::move(what), [=](StabilityInput&) { return make(); }});
  };
  const glm::dvec3 eye(0.4, -0.3, 2.6), middle(0);
  add("hills", "a wall of hills, a tenth of its half side deep", [] { return wall_alone({}); });
  add("grazing", "the same, two degrees off its plane", [] { return wall_alone({}, {2, -0.2, 0.07}, {0, 0, 0}); });
  add("grazing, without an end", "the same without silhouettes", [] {
    return wall_alone({.silhouettes = false}, {2, -0.2, 0.07}, {0, 0, 0});
  });
  add("grazing, by sample", "six degrees off its plane, four samples a pixel that meet it for themselves", [] {
    return by_sample(wall_alone({}, {2, -0.3, 0.2}, {0, 0, 0}));
  });
  add("even and grazing, by sample", "a wall that is even, ten degrees off: each sample tells its outline", [] {
    return even_by_sample(0.25, {2, -0.3, 0.35}, {0, 0, -0.1});
  });
  add("depth 0", "is the flat wall", [=] {
    return wall_alike(
        {.depth = 0}, eye, middle,
        [](GlbWriter& out) {
          place(out, quad(2, 2), flat_material(), {0, 0, 0});
        },
        0);
  });
  add("depth 10", "five times as deep as it is wide", [] { return wall_alone({.depth = 10}); });
  add("mirrored", "in a mirroring node", [] { return wall_alone({.scale = {-1, 1, 1}}); });
  add("mirrored coordinates", "texture coordinates that run backwards", [] {
    return wall_alone({.uv_repeat = {-1, 1}});
  });
  add("stretched", "a hundred times as wide as high in texels", [] { return wall_alone({.uv_repeat = {0.02, 2}}); });
  add("uneven scale", "in a node that scales unevenly", [] { return wall_alone({.scale = {0.5, 1.2, 3}}); });
  add("one texel", "a texture of one texel is a plane as deep as that says",
      [] { return wall_alone({.depth = 0.5, .texels = 1, .even = 51.0 / 255}); });
  add("no coordinates", "without texture coordinates", [] { return wall_alone({.uvs = false}); });
  add("inside", "the camera in the layer, the wall's plane behind it", [=] {
    // Behind the camera: a file holds something.
    return wall_alike(
        {.depth = 1}, {0, 0, -0.05}, {0.1, 0, -1},
        [](GlbWriter& out) {
          place(out, quad(0.1, 0.1), flat_material(), {0, 0, 5});
        },
        0);
  });
}

}  // namespace candela::stability
