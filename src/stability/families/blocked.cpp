// What stands in light's way: walls of one side, openings of a pixel, lamps in walls, sheets of alpha 0 and 1; and how
// much of the sky rays leave open. Held to the reference with everything that blocks light.
#include "stability/stage.h"

namespace candela::stability {
namespace {

Shape inside_out(Shape shape) {
  for (glm::dvec3& normal : shape.normal) normal = -normal;
  for (size_t i = 0; i + 2 < shape.index.size(); i += 3) std::swap(shape.index[i + 1], shape.index[i + 2]);
  return shape;
}
json one_sided(json material) {
  material["doubleSided"] = false;
  return material;
}
const json clay = lit({0.7, 0.6, 0.5}, 0, 0.9);
constexpr glm::dvec3 hall_m{4, 3, 4};  // of the closed room, whose floor is at 0

// A closed room whose walls show their inner sides, with a block in it.
void hall(GlbWriter& out, const json& walls) {
  place(out, inside_out(box(hall_m)), walls, {0, hall_m.y / 2, 0});
  place(out, box({0.8, 0.8, 0.8}), lit({0.3, 0.5, 0.8}, 0, 0.9), {0.5, 0.4, -0.5});
}
void seen_from_within(GlbWriter& out) { camera(out, {-1.5, 1.5, 1.75}, {0.25, 0.75, -0.5}, 0.9, 0.01); }
void seen_through_a_wall(GlbWriter& out) { camera(out, {1, 2.5, 9}, {0, 1.25, 0}, 0.5, 0.1); }
// A square in the XY plane, turned, with a square hole in its middle.
void pierced(GlbWriter& out, double side_m, double hole_m, const json& material, glm::dvec3 at,
             const std::function<glm::dvec3(glm::dvec3)>& turned) {
  Shape shape;
  const double s = side_m / 2, h = hole_m / 2;
  const glm::dvec2 corners[4][2] = {{{-s, -s}, {s, -h}}, {{-s, h}, {s, s}}, {{-s, -h}, {-h, h}}, {{h, -h}, {s, h}}};
  for (const auto& [low, high] : corners) {
    const uint32_t first = uint32_t(shape.position.size());
    for (const glm::dvec2 p : {low, {high.x, low.y}, high, {low.x, high.y}}) {
      shape.position.push_back(turned({p.x, p.y, 0}));
      shape.normal.push_back(turned({0, 0, 1}));
    }
    for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) shape.index.push_back(first + i);
  }
  place(out, shape, material, at);
}

// Shadows by rays from what is shaded, as the reference has them.
StabilityScene shadowed(const GlbWriter& out) {
  StabilityScene scene = scene_of(out);
  scene.effects = "shadows";
  scene.job.settings.push_back({"sun", "mode", "traced"});
  scene.job.settings.push_back({"local", "method", "traced"});
  scene.blocked_samples = 1;
  scene.stray_fraction = 2e-3;  // edges of shadows, which rays from floats meet elsewhere
  return scene;
}

void add(Recipes& all, std::string name, std::string what, const std::string& sides,
         const std::function<StabilityScene(StabilityInput&)>& make) {
  all.push_back({"sides", std::move(name) + ", " + sides, std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = make(in);
                   scene.job.sides = sides;
                   return scene;
                 }});
}

void add_rooms(Recipes& all, const std::string& sides) {
  for (const bool within : {true, false})
    add(all, within ? "closed room from within" : "closed room looked into", "walls of one side, a lamp in, a sun out",
        sides, [=](StabilityInput&) {
          GlbWriter out;
          hall(out, one_sided(clay));
          point(out, {-1, 2.5, 0.5}, 6);
          sun(out, {0.4, 1, 0.7}, 3);
          (within ? seen_from_within : seen_through_a_wall)(out);
          return shadowed(out);
        });
  // A pixel of the floor's middle is 5 cm wide.
  add(all, "a pixel's hole in the roof of a closed room", "the sun through it, on a spot of the floor", sides,
      [](StabilityInput&) {
        GlbWriter out;
        const json walls = lit({0.7, 0.6, 0.5}, 0, 0.9);
        place(out, ground(4, 1, 1), walls, {0, 0, 0});
        for (const double x : {-2.0, 2.0}) place(out, box({0.01, 3, 4}), walls, {x, 1.5, 0});
        for (const double z : {-2.0, 2.0}) place(out, box({4, 3, 0.01}), walls, {0, 1.5, z});
        pierced(out, 4, 0.06, walls, {0, 3, 0}, [](glm::dvec3 p) { return glm::dvec3(p.x, -p.z, p.y); });
        sun(out, {0.1, 1, 0.15}, 10);
        seen_from_within(out);
        StabilityScene scene = shadowed(out);
        scene.energy_bound = 0.02;  // of a few pixels, whose edges count
        return scene;
      });
  add(all, "a lit room through a pixel's hole", "a wall before the eye", sides, [](StabilityInput&) {
    GlbWriter out;
    hall(out, lit({0.7, 0.6, 0.5}, 0, 0.9));
    point(out, {-1, 2.5, 0.5}, 6);
    pierced(out, 8, 0.022, lit({0.2, 0.2, 0.2}, 0, 0.9), {0, 1.25, 1.9}, [](glm::dvec3 p) { return p; });
    camera(out, {0.005, 1.25, 1}, {0.005, 1.25, 2}, 0.9, 0.01);
    StabilityScene scene = shadowed(out);
    scene.reference = false;  // of the hole one sample sees the room or the wall
    scene.most = 10;
    return scene;
  });
}

void add_lamps_in_walls(Recipes& all, const std::string& sides) {
  for (const bool both : {true, false})
    add(all, both ? "a lamp in a wall of two sides" : "a lamp in a wall of one side", "in its plane, where no side is",
        sides, [=](StabilityInput& in) {
          GlbWriter out;
          room(out, in.rng);
          room_camera(out);
          place(out, quad(3, 3), both ? clay : one_sided(clay), {0, 1.5, -1});
          point(out, {0.5, 1.5, -1}, 10);
          point(out, {-0.5, 2.5, 2.5}, 1);
          StabilityScene scene = shadowed(out);
          // Which side of the wall the lamp is on is rounding, so half of the light is there or not.
          scene.reference = false;
          scene.most = 100;
          return scene;
        });
  add(all, "a lamp within a wall", "whose faces look outwards: nothing leaves it, or all", sides,
      [](StabilityInput& in) {
        GlbWriter out;
        room(out, in.rng);
        room_camera(out);
        place(out, box({3, 3, 0.25}), one_sided(clay), {0, 1.5, -1.5});
        point(out, {0.5, 1.5, -1.5}, 10);
        point(out, {-0.5, 2.5, 2.5}, 1);
        return shadowed(out);
      });
}

// A sheet between lamp, sun and floor, which is not there or as good as a wall.
StabilityScene under_sheet(StabilityInput& in, double alpha, bool traced) {
  const auto fill = [&](GlbWriter& out, Rng rng, bool plain) {
    room(out, rng);
    room_camera(out);
    point(out, {-0.5, 2.5, 1.5}, 10);
    sun(out, {0.3, 1, 0.2}, 2);
    if (plain && alpha == 0) return;
    json sheet = lit({0.9, 0.3, 0.6}, 0, 0.5);
    if (!plain) sheet["alphaMode"] = "BLEND", sheet["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
    place(out, ground(1, 1, 1), sheet, {0, 1.25, 0.75});
  };
  GlbWriter out, plain;
  fill(out, in.rng, false), fill(plain, in.rng, true);
  StabilityScene scene = shadowed(out);
  if (!traced) {
    scene.job.settings = scene_of(out).job.settings;
    scene.stray_fraction = 5e-3;  // blended surfaces have maps of their own: edges fall elsewhere
  }
  scene.plain = plain.bytes();
  scene.plain_bound = 1e-4;
  scene.reference = traced;
  return scene;
}

}  // namespace

void add_sides(Recipes& all) {
  for (const char* sides : {"auto", "block", "open"}) add_rooms(all, sides), add_lamps_in_walls(all, sides);
  for (const double alpha : {0.0, 1.0})
    for (const bool traced : {true, false})
      all.push_back({"sides", fmt::format("under a sheet of alpha {:g}, {}", alpha, traced ? "by rays" : "by maps"),
                     alpha == 0 ? "it is not there" : "it is a wall",
                     [=](StabilityInput& in) { return under_sheet(in, alpha, traced); }});
}

namespace {

// Under an even sky of radiance 1, by rays; `samples` of the reference and as many of the pixel.
StabilityScene under_white(const GlbWriter& out, int samples) {
  StabilityScene scene = scene_of(out);
  scene.sky = sky_image(64, 32, [](int, int) { return glm::vec3(1); });
  scene.effects = "ibl,occlusion";
  scene.job.width_px = 32, scene.job.height_px = 24;
  scene.job.settings.push_back({"occlusion", "method", "rays"});
  scene.job.settings.push_back({"occlusion", "texel_px", "1"});
  scene.job.settings.push_back({"occlusion", "filter", "0"});
  scene.job.settings.push_back({"occlusion", "rays", std::to_string(samples)});
  scene.blocked_samples = samples;
  return scene;
}
// The same under a soft box in an otherwise black sky, whose spots are lights of their own.
StabilityScene under_box(const GlbWriter& out, int samples, float radiance) {
  StabilityScene scene = under_white(out, samples);
  scene.sky = sky_image(
      256, 128, [=](int x, int y) { return glm::vec3(x >= 80 && x < 96 && y >= 32 && y < 48 ? radiance : 0.0f); });
  return scene;
}
void add_open(Recipes& all, std::string name, std::string what, const std::function<StabilityScene()>& make) {
  all.push_back({"occlusion", std::move(name), std::move(what), [=](StabilityInput&) { return make(); }});
}
// Of the sum over the picture and, loosely for their noise, of single pixels.
StabilityScene noisy(StabilityScene scene, double bound, double energy_bound) {
  scene.bound = bound, scene.energy_bound = energy_bound, scene.stray_fraction = 0.01;
  return scene;
}

// A floor and a wall, `scale` times as large, or with their corner `gap_m` open.
void corner(GlbWriter& out, double scale, double gap_m = 0) {
  place(out, ground(4, 1, 1), clay, {0, 0, 0}, glm::dvec3(scale));
  place(out, box({4, 2, 0.25}), clay, glm::dvec3(0, 1 + gap_m, -0.5) * scale, glm::dvec3(scale));
  camera(out, glm::dvec3(1, 1.5, 3) * scale, glm::dvec3(0, 0.25, -0.25) * scale, 0.7, 0.1 * scale);
}

}  // namespace

void add_occlusion(Recipes& all) {
  add_open(all, "closed room", "no ray finds the sky: black", [] {
    GlbWriter out;
    hall(out, lit({0.7, 0.6, 0.5}, 0, 0.9));
    seen_from_within(out);
    StabilityScene scene = under_white(out, 16);
    scene.reference = false, scene.black = true;
    return scene;
  });
  add_open(all, "closed room of metal under a soft box of 1e10", "its spots are hidden, diffuse and mirrored: black",
           [] {
             GlbWriter out;
             hall(out, lit({0.7, 0.6, 0.5}, 1, 0.4));
             seen_from_within(out);
             StabilityScene scene = under_box(out, 16, 1e10f);
             scene.reference = false, scene.black = true;
             return scene;
           });
  for (const float radiance : {1e-20f, 50.0f, 1e20f})
    add_open(all, fmt::format("corner under a soft box of {:g}", radiance), "no surface outshines the box", [=] {
      GlbWriter out;
      corner(out, 1);
      StabilityScene scene = under_box(out, 64, radiance);
      // Penumbras of at most 32 spots in place of a box: 4 % of this picture's light.
      scene.reference = false;
      scene.most = 1.001 * double(radiance);
      return scene;
    });
  for (const char* sides : {"block", "open"})
    add_open(all, std::string("closed room of one side, ") + sides, "black, or as open as a plain", [=] {
      GlbWriter out;
      hall(out, one_sided(clay));
      seen_from_within(out);
      StabilityScene scene = under_white(out, 64);
      scene.job.sides = sides;
      if (std::string_view(sides) == "block")
        scene.reference = false, scene.black = true;
      else
        scene = noisy(scene, 0.5, 0.02);
      return scene;
    });
  add_open(all, "closed room with a pixel's hole", "a few of a thousand rays find it", [] {
    GlbWriter out;
    place(out, ground(4, 1, 1), clay, {0, 0, 0});
    for (const double x : {-2.0, 2.0}) place(out, box({0.01, 3, 4}), clay, {x, 1.5, 0});
    for (const double z : {-2.0, 2.0}) place(out, box({4, 3, 0.01}), clay, {0, 1.5, z});
    pierced(out, 4, 0.25, clay, {0, 3, 0}, [](glm::dvec3 p) { return glm::dvec3(p.x, -p.z, p.y); });
    seen_from_within(out);
    return noisy(under_white(out, 256), 1e3, 0.1);
  });
  add_open(all, "white ball in a furnace", "hides nothing of itself", [] {
    GlbWriter out;
    place(out, sphere(1, 64, 48), lit({1, 1, 1}, 0, 1), {0, 0, 0});
    camera(out, {0, 0, 4}, {0, 0, 0}, 0.6);
    StabilityScene scene = noisy(under_white(out, 64), 0.25, 0.01);
    scene.most = 1.01;
    return scene;
  });
  for (const double scale : {0x1p-20, 1.0, 0x1p20})
    add_open(all, fmt::format("corner of scale {:g}", scale), "a floor and a wall", [=] {
      GlbWriter out, plain;
      corner(out, scale), corner(plain, 1);
      StabilityScene scene = noisy(under_white(out, 64), 0.5, 0.01);
      scene.plain = plain.bytes();
      scene.plain_bound = 1e-3;  // the rays' places follow the pixel alone
      return scene;
    });
  for (const double gap_m : {1e-6, 1e-3, 0.02})
    add_open(all, fmt::format("slit of {:g} m under a wall", gap_m), "through which the sky is seen", [=] {
      GlbWriter out;
      corner(out, 1, gap_m);
      return noisy(under_white(out, 64), 0.5, 0.01);
    });
  add_open(all, "floor along the view", "the eye a millimetre over 100 m", [] {
    GlbWriter out;
    place(out, ground(100, 1, 1), clay, {0, 0, 0});
    place(out, box({1, 4, 1}), clay, {0.6, 0, -3});
    camera(out, {0, 1e-3, 0}, {0, 0, -1}, 1.0, 1e-4);
    return noisy(under_white(out, 64), 0.5, 0.02);
  });
  for (const double radius_m : {1e-30, 1e30})
    add_open(all, fmt::format("radius of {:g} m", radius_m), "of the look: none or no end", [=] {
      GlbWriter out;
      corner(out, 1);
      StabilityScene scene = noisy(under_white(out, 64), 0.5, 0.01);
      scene.sky_look = json{{"occlusion", {{"radius_m", radius_m}}}}.dump();
      return scene;
    });
  add_open(all, "sheet of alpha 0 before the sky", "hides nothing", [] {
    GlbWriter out, plain;
    corner(out, 1), corner(plain, 1);
    json sheet = clay;
    sheet["alphaMode"] = "BLEND", sheet["pbrMetallicRoughness"]["baseColorFactor"][3] = 0;
    place(out, ground(2, 1, 1), sheet, {0, 0.5, 0.75});
    StabilityScene scene = noisy(under_white(out, 64), 0.5, 0.01);
    scene.plain = plain.bytes();
    scene.plain_bound = 1e-3;
    return scene;
  });
}

}  // namespace candela::stability
