#include <array>

#include "math/transforms.h"
#include "testscenes/table.h"

namespace candela {

namespace {

// The same objects, lights and camera around `origin`. Every position is a multiple of 1/64 m, so that adding a million
// metres is exact in double.
void add_world(GlbWriter& out, glm::dvec3 origin) {
  const int texture = out.texture("checker", checker_png(32, 8, {0.2, 0.25, 0.3}, {0.8, 0.78, 0.7}));
  const int tiles = out.material("tiles", pbr_textured(texture, 0, 0.7));
  const int floor = out.mesh("floor", out.primitive(ground(8, 1, 1)), tiles);
  out.node("floor", {{"mesh", floor}, {"translation", vector_json(origin)}});
  const json ball = out.primitive(sphere(0.5, 24, 16)), cube = out.primitive(box({0.75, 0.75, 0.75}));
  const int copper = out.material("copper", pbr({0.95, 0.5, 0.3, 1}, 1, 0.35)),
            paint = out.material("paint", pbr({0.15, 0.35, 0.8, 1}, 0, 0.3));
  const int copper_ball = out.mesh("copper ball", ball, copper), paint_cube = out.mesh("painted cube", cube, paint);
  out.node("ball", {{"mesh", copper_ball}, {"translation", vector_json(origin + glm::dvec3(-1, 0.5, 0))}});
  out.node("cube", {{"mesh", paint_cube}, {"translation", vector_json(origin + glm::dvec3(1, 0.375, -0.5))}});
  // The same cube through a parent: the large numbers meet in the composed transform.
  const int parent = out.node("parent", {{"translation", vector_json(origin + glm::dvec3(0, 0.375, 1))}});
  out.child(parent, "child cube",
            {{"mesh", paint_cube}, {"rotation", quaternion_json(rotation_about({0, 1, 0}, 0.6))}});
  add_sun(out, {1, 2, 1}, {1, 0.95, 0.9}, 2);
  add_point_light(out, origin + glm::dvec3(-0.5, 1.5, 1.5), {1, 0.8, 0.5}, 4);
  const glm::dvec3 eye{0.5, 1.75, 4.5}, target{0, 0.5, 0};
  const int camera = out.camera({{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
  const glm::dquat rotation = glm::quat_cast(glm::dmat3(look_at_pose(eye, target)));
  out.node("camera",
           {{"camera", camera}, {"translation", vector_json(origin + eye)}, {"rotation", quaternion_json(rotation)}});
}

}  // namespace

void make_near_world(GlbWriter& out, SceneOptions&) { add_world(out, {0, 0, 0}); }
void make_far_world(GlbWriter& out, SceneOptions&) { add_world(out, {1e6, 0, -1e6}); }

void make_orthographic(GlbWriter& out, SceneOptions& options) {
  const json cube = out.primitive(box({1, 1, 1}));
  for (int z = 0; z < 4; ++z)
    for (int x = 0; x < 4; ++x) {
      const double height = 0.25 + 0.25 * double(options.rng.next() % 6);
      const int material = out.material("block", pbr({0.25 + 0.2 * x, 0.4, 0.85 - 0.2 * z, 1}, 0, 0.6));
      out.node("block", {{"mesh", out.mesh("block", cube, material)},
                         {"translation", vector_json({x * 1.25 - 1.875, height / 2, z * 1.25 - 1.875})},
                         {"scale", vector_json({1, height, 1})}});
    }
  const int floor =
      out.mesh("floor", out.primitive(ground(7, 1, 1)), out.material("floor", pbr({0.6, 0.6, 0.58, 1}, 0, 0.9)));
  out.node("floor", {{"mesh", floor}});
  add_sun(out, {2, 3, 1}, {1, 1, 1}, 3);
  const int camera = out.camera(
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 6}, {"ymag", 3.375}, {"znear", 0.1}, {"zfar", 30}}}});
  const glm::dvec3 eye{6, 6, 6};
  const glm::dquat rotation = glm::quat_cast(glm::dmat3(look_at_pose(eye, {0, 0, 0})));
  out.node("camera", {{"camera", camera}, {"translation", vector_json(eye)}, {"rotation", quaternion_json(rotation)}});
}

void make_animation_pointer(GlbWriter& out, SceneOptions&) {
  const int ball =
      out.mesh("ball", out.primitive(sphere(0.8, 24, 16)), out.material("changing", pbr({1, 0.1, 0.1, 1}, 0, 0.4)));
  out.node("ball", {{"mesh", ball}, {"translation", vector_json({0, 0.8, 0})}});
  const int floor =
      out.mesh("floor", out.primitive(ground(8, 1, 1)), out.material("floor", pbr({0.5, 0.5, 0.5, 1}, 0, 0.8)));
  out.node("floor", {{"mesh", floor}});
  add_point_light(out, {1.5, 3, 2}, {1, 1, 0.9}, 20);
  out.camera_node({0, 1.5, 5}, {0, 0.7, 0}, 0.6);

  const std::array times{0.0, 1.0, 2.0};
  out.animate_pointer("/extensions/KHR_lights_punctual/lights/0/intensity", "LINEAR", times,
                      std::array{20.0, 80.0, 5.0}, 1);
  out.animate_pointer("/materials/0/pbrMetallicRoughness/baseColorFactor", "STEP", times,
                      std::array{1.0, 0.1, 0.1, 1.0, 0.1, 1.0, 0.1, 1.0, 0.1, 0.1, 1.0, 1.0}, 4);
  // In-tangent, value and out-tangent a key.
  out.animate_pointer("/cameras/0/perspective/yfov", "CUBICSPLINE", times,
                      std::array{0.0, 0.6, 0.0, 0.0, 0.9, 0.0, 0.0, 0.6, 0.0}, 1);
}

}  // namespace candela
