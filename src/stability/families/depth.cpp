// Depth: near and far apart by eleven orders of magnitude, surfaces a millimetre apart, cameras inside things. Worlds:
// the same pictures a thousand kilometres away, and a million times as large.
#include "stability/stage.h"
#include "testscenes/light_arrays.h"

namespace candela::stability {
namespace {

// Two squares that fill the view, the bright one in front by `gap_m`; a far one may not show through.
StabilityScene coplanar(double distance_m, double gap_m) {
  GlbWriter out;
  const double side = distance_m;
  const json unlit = {{"KHR_materials_unlit", json::object()}};
  out.use_extension("KHR_materials_unlit");
  json front = lit({0.9, 0.8, 0.1}, 0, 1), back = lit({0.05, 0.1, 0.9}, 0, 1);
  front["extensions"] = back["extensions"] = unlit;
  // The back one is drawn last, and both are tilted: a slope makes depth fight where it is going to.
  Shape tilted = quad(side, side);
  for (glm::dvec3& p : tilted.position) p = {p.x, p.y * 0.8, p.y * 0.6};
  place(out, tilted, front, {0, 0, -distance_m});
  place(out, tilted, back, {0, 0, -distance_m - gap_m / 0.8});
  camera(out, {0, 0, 0}, {0, 0, -1}, 0.5, 0.01);
  StabilityScene scene = scene_of(out);
  GlbWriter plain;
  plain.use_extension("KHR_materials_unlit");
  place(plain, tilted, front, {0, 0, -distance_m});
  camera(plain, {0, 0, 0}, {0, 0, -1}, 0.5, 0.01);
  scene.plain = plain.bytes();
  scene.plain_bound = 0;
  return scene;
}

// From a grain a millimetre away to a ball ten thousand kilometres away in one view.
StabilityScene near_and_far(double near_m) {
  GlbWriter out;
  place(out, sphere(1e-3, 32, 16), lit({0.9, 0.2, 0.2}, 0, 0.6), {-1e-3, 0, -4e-3});
  place(out, sphere(1, 32, 16), lit({0.2, 0.9, 0.2}, 0, 0.6), {1, 0.7, -8});
  place(out, sphere(1e3, 32, 16), lit({0.2, 0.2, 0.9}, 0, 0.6), {1.5e3, -1e3, -8e3});
  place(out, sphere(4e6, 64, 32), lit({0.8, 0.8, 0.2}, 0, 0.6), {-1e6, 1e6, -1e7});
  sun(out, {1, 1, 2}, 3);
  const int index =
      out.camera({{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", near_m}, {"zfar", 1e7}}}});
  out.node("camera", {{"camera", index}});
  return scene_of(out);
}

StabilityScene inside(bool double_sided) {
  GlbWriter out;
  json material = lit({0.7, 0.5, 0.3}, 0, 0.5);
  material["doubleSided"] = double_sided;
  place(out, sphere(2, 48, 24), material, {0, 0, 0});
  place(out, box({0.5, 0.5, 0.5}), lit({0.3, 0.5, 0.8}, 0.5, 0.4), {0.4, -0.2, -1});
  point(out, {0, 1, 0}, 5);
  camera(out, {0, 0, 0.3}, {0, 0, -1}, 1.2, 0.01);
  StabilityScene scene = scene_of(out);
  scene.stray_fraction = 1e-3;  // the box's edges
  return scene;
}

// The floor's triangles are clipped and interpolated in floats: they may be 1e6 times as large as the eye is high, not
// more.
StabilityScene floor_under_the_eye(double side_m, double height_m) {
  GlbWriter out;
  place(out, ground(side_m, 1, 1), lit({0.6, 0.6, 0.6}, 0, 0.8), {0, 0, 0});
  place(out, box({1, 4, 1}), lit({0.8, 0.3, 0.2}, 0, 0.8), {0.6, 0, 0.2});
  sun(out, {1, 2, 1}, 3);
  camera(out, {0, height_m, 0}, {0.3, height_m - 0.15, -1}, 1.0, 1e-4);
  StabilityScene scene = scene_of(out);
  return scene;
}

StabilityScene orthographic(double half_size_m, double near_m, double far_m) {
  GlbWriter out;
  place(out, sphere(half_size_m / 2, 48, 24), lit({0.9, 0.4, 0.2}, 0, 0.5), {0, 0, -far_m / 2});
  place(out, quad(4 * half_size_m, 4 * half_size_m), lit({0.3, 0.5, 0.7}, 0, 0.8), {0, 0, -0.99 * far_m});
  sun(out, {1, 2, 3}, 3);
  const int index = out.camera(
      {{"type", "orthographic"},
       {"orthographic", {{"xmag", half_size_m}, {"ymag", half_size_m}, {"znear", near_m}, {"zfar", far_m}}}});
  out.node("camera", {{"camera", index}});
  StabilityScene scene = scene_of(out);
  // Depths lie evenly over the range: the outline of a ball is as deep as 1/2^24 of it.
  scene.stray_fraction = 1e-3;
  return scene;
}

// Tiles of a very wide view reach to the side by many times their depth, those of a narrow one hardly anywhere.
StabilityScene field_of_view(double yfov_rad, int width, int height, double distance_m) {
  GlbWriter out;
  place(out, sphere(0.5, 48, 32), lit({0.8, 0.4, 0.2}, 0, 0.5), {0, 0, -distance_m});
  place(out, quad(400, 400), lit({0.3, 0.5, 0.7}, 0, 0.8), {0, 0, -distance_m - 1});
  for (int i = 0; i < 9; ++i) point(out, {i % 3 - 1.0, i / 3 - 1.0, 1 - distance_m}, 1, {{"range", 1.5 + i}});
  camera(out, {0, 0, 0}, {0, 0, -1}, yfov_rad, 1e-3);
  StabilityScene scene = scene_of(out);
  scene.job.width_px = width, scene.job.height_px = height;
  return scene;
}

// Far away by the parents' transforms alone: a chain whose steps cancel but for the room's own place.
StabilityScene moved_by_parents(StabilityInput& in) {
  GlbWriter out, plain;
  const auto fill = [](GlbWriter& to, bool far) {
    Rng colors(3);
    lit_room(to, colors);
    const json ball = to.primitive(sphere(0.25, 32, 16));
    const int mesh = to.mesh("ball", ball, to.material("ball", lit({0.2, 0.8, 0.7}, 0, 0.4)));
    const double step = far ? 1048576.0 : 0.0;
    const int outer = to.node("outer", {{"translation", exact({step, -step, step})}});
    const int middle = to.child(outer, "middle", {{"translation", exact({-step, step, -step})}});
    to.child(middle, "ball", {{"mesh", mesh}, {"translation", exact({0.25, 0.25, 1.5})}});
  };
  fill(out, true);
  fill(plain, false);
  (void)in;
  StabilityScene scene = scene_of(out);
  scene.plain = plain.bytes();
  scene.plain_bound = 0;
  return scene;
}

// Instances and light arrays hold their places as floats, relative to a node that is far away.
StabilityScene moved_arrays(glm::dvec3 to) {
  const auto fill = [](GlbWriter& out, glm::dvec3 origin) {
    const Room how{.origin = origin};
    Rng colors(5);
    room(out, colors, how);
    room_camera(out, how);
    const int mesh =
        out.mesh("grain", out.primitive(box({0.2, 0.2, 0.2})), out.material("grain", lit({0.8, 0.7, 0.2}, 0, 0.5)));
    std::vector<glm::dvec3> places;
    for (int i = 0; i < 16; ++i) places.push_back({-1.5 + 0.1875 * i, 0.125, 1.25 + 0.25 * (i % 3)});
    out.use_extension("EXT_mesh_gpu_instancing");
    out.node("grains",
             {{"mesh", mesh},
              {"translation", exact(origin)},
              {"extensions",
               {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", out.vec3_accessor(places)}}}}}}}});
    LightArrays lights;
    for (int i = 0; i < 32; ++i)
      lights.add({-2 + 0.125 * i, 0.75 + 0.0625 * (i % 5), 1.5}, {1, 0.5 + 0.015625 * i, 0.5}, 0.5, 3, {0, 1, 0});
    const int light = out.light({{"type", "point"}, {"range", 3}});
    out.node("lamps", {{"translation", exact(origin)}, {"extensions", lights.extension(out, light)}});
  };
  GlbWriter out, plain;
  fill(out, to);
  fill(plain, {0, 0, 0});
  StabilityScene scene = scene_of(out);
  scene.plain = plain.bytes();
  scene.plain_bound = 0;
  return scene;
}

}  // namespace

void add_depth(Recipes& all) {
  all.push_back({"depth", "near 1e-4, far 1e7", "a grain at 4 mm and a ball at 10,000 km in one view",
                 [](StabilityInput&) { return near_and_far(1e-4); }});
  all.push_back({"depth", "near 1e-6", "the same with a near plane of a micrometre",
                 [](StabilityInput&) { return near_and_far(1e-6); }});
  for (const auto& [name, distance, gap] :
       {std::tuple("1 mm at 10 m", 10.0, 1e-3), std::tuple("1 mm at 1 km", 1e3, 1e-3),
        std::tuple("1 cm at 10 km", 1e4, 1e-2), std::tuple("10 cm at 100 km", 1e5, 0.1),
        std::tuple("10 m at 10,000 km", 1e7, 10.0)})
    all.push_back({"depth", std::string("coplanar ") + name, "two squares; the front one alone must be seen",
                   [=](StabilityInput&) { return coplanar(distance, gap); }});
  all.push_back(
      {"depth", "inside a ball", "the camera in a double-sided ball", [](StabilityInput&) { return inside(true); }});
  all.push_back({"depth", "inside a single-sided ball", "its inner side must not be seen",
                 [](StabilityInput&) { return inside(false); }});
  all.push_back({"depth", "eye 1 mm over a floor of 100 m", "a box beside the eye, through the near plane",
                 [](StabilityInput&) { return floor_under_the_eye(100, 1e-3); }});
  all.push_back(
      {"depth", "eye 1 m over a floor of 1,000 km", "", [](StabilityInput&) { return floor_under_the_eye(1e6, 1); }});
  all.push_back(
      {"depth", "yfov of 179 degrees", "", [](StabilityInput&) { return field_of_view(179 * pi / 180, 64, 48, 2); }});
  all.push_back({"depth", "yfov of 150 degrees, 3x3", "one tile, tens of times as wide as the view is deep",
                 [](StabilityInput&) { return field_of_view(150 * pi / 180, 3, 3, 2); }});
  all.push_back({"depth", "yfov of 0.1 degrees", "a ball seen from 1 km", [](StabilityInput&) {
                   StabilityScene scene = field_of_view(0.1 * pi / 180, 64, 48, 1e3);
                   return scene;
                 }});
  all.push_back({"depth", "orthographic to 1e7", "depths from 0 to 10,000 km",
                 [](StabilityInput&) { return orthographic(2, 0, 1e7); }});
  all.push_back({"depth", "orthographic 1e6 wide", "a view of 2,000 km",
                 [](StabilityInput&) { return orthographic(1e6, 1, 1e7); }});
}

void add_worlds(Recipes& all) {
  all.push_back(
      {"worlds", "1e6 m along x and z", "the room moved; the picture must stay bit for bit", [](StabilityInput& in) {
         return beside_plain(in, {.origin = {1e6, 0, -1e6}});
       }});
  all.push_back({"worlds", "1e6 m up", "the room moved; the picture must stay bit for bit", [](StabilityInput& in) {
                   return beside_plain(in, {.origin = {0, 1e6, 0}});
                 }});
  all.push_back({"worlds", "1e9 m away", "the room moved; double still holds its 1/64 m", [](StabilityInput& in) {
                   return beside_plain(in, {.origin = {-1e9, 1e9, 1e9}});
                 }});
  all.push_back({"worlds", "cancelling parents", "a chain of transforms of 1,000 km that cancels", moved_by_parents});
  all.push_back({"worlds", "instances and light arrays", "at 1e6 m", [](StabilityInput&) {
                   return moved_arrays({1e6, -1e6, 1e6});
                 }});
  all.push_back({"worlds", "a million times as large", "and as bright: the picture must stay",
                 [](StabilityInput& in) { return beside_plain(in, {.scale = 1048576}, 1e-5); }});
  all.push_back({"worlds", "a 16th as large", "lights no nearer than the centimetre below which they are held",
                 [](StabilityInput& in) { return beside_plain(in, {.scale = 1.0 / 16}, 1e-5); }});
}

}  // namespace candela::stability
