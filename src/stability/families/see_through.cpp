// What is seen through and what mirrors, where passes leave something out: light among blended surfaces (deep_shadows),
// bodies of glass that absorb by their faces (refraction.backs), and mirrors of a sky over what a pixel shows of it
// (ibl.mirror_taps).
#include <cmath>

#include "stability/stage.h"

namespace candela::stability {
namespace {

json blended(double alpha) {
  json material = lit({0.9, 0.3, 0.6}, 0, 0.6);
  material["alphaMode"] = "BLEND";
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
  return material;
}
const json clay = lit({0.7, 0.6, 0.5}, 0, 0.9);

// A floor and over it a blended sheet, which takes light, under whatever `over` lays between them and the lights.
void receivers(GlbWriter& out, const Fill& over) {
  place(out, ground(4, 1, 1), clay, {0, 0, 0});
  place(out, ground(0.8, 1, 1), blended(0.5), {0, 0.5, 0});
  place(out, box({0.1, 0.1, 0.1}), clay,
        {1.8, 2.2, -1.8});  // maps are of what is drawn: as high with sheets as without
  over(out);
  point(out, {0.3, 3, 0.2}, 20);
  sun(out, {0.2, 1, 0.1}, 2);
  camera(out, {0, 1.2, 4}, {0, 0, 0}, 0.5, 0.1);  // the sheets over it are out of view
}
// `count` sheets between two heights.
Fill layers(int count, double alpha, double low_m, double high_m) {
  return [=](GlbWriter& out) {
    const json sheet = out.primitive(ground(1.2, 1, 1));
    const int mesh = out.mesh("sheet", sheet, out.material("sheet", blended(alpha)));
    for (int i = 0; i < count; ++i)
      out.node("sheet", {{"mesh", mesh}, {"translation", exact({0, low_m + (high_m - low_m) * i / count, 0})}});
  };
}
void nothing(GlbWriter&) {}

// By maps, beside what must look the same within `bound` but for edges.
void add_layers(Recipes& all, std::string name, std::string what, const Fill& over, const Fill& plain, double bound) {
  all.push_back({"deep-shadows", std::move(name), std::move(what), [=](StabilityInput&) {
                   GlbWriter out, alike;
                   receivers(out, over), receivers(alike, plain);
                   StabilityScene scene = scene_of(out);
                   scene.effects = "shadows";
                   scene.job.settings.push_back({"colored_shadows", "scale", "full"});  // in floats
                   scene.plain = alike.bytes(), scene.plain_bound = bound;
                   scene.reference = false;
                   scene.stray_fraction = 5e-3;
                   return scene;
                 }});
}

}  // namespace

void add_deep_shadows(Recipes& all) {
  add_layers(all, "alpha 0", "a hundred sheets that are not there", layers(100, 0, 1.5, 2), nothing, 1e-4);
  const double together = -std::expm1(300 * std::log1p(-0.01));
  add_layers(all, "300 layers of alpha 0.01", "as one sheet that hides as much", layers(300, 0.01, 1.5, 1.51),
             layers(1, together, 1.5, 1.5), 0.02);
  add_layers(all, "300 layers of alpha 0.999", "no light is left", layers(300, 0.999, 1.5, 1.51),
             layers(1, 0.99999, 1.5, 1.5), 0.02);
  add_layers(all, "two sheets that touch", "as one of both", layers(2, 0.5, 1.5, 1.5), layers(1, 0.75, 1.5, 1.5), 0.02);
  add_layers(all, "two sheets 1e-7 m apart", "as one of both", layers(2, 0.5, 1.5, 1.5 + 2e-7),
             layers(1, 0.75, 1.5, 1.5), 0.02);
  all.push_back({"deep-shadows", "a lamp inside a smoke", "sixty sheets about it", [](StabilityInput& in) {
                   GlbWriter out;
                   place(out, ground(4, 1, 1), clay, {0, 0, 0});
                   for (int i = 0; i < 60; ++i)
                     place(out, quad(0.6, 0.6), blended(0.1),
                           {in.rng.uniform(-0.4, 0.4), in.rng.uniform(0.6, 1.4), in.rng.uniform(-0.4, 0.4)});
                   point(out, {0, 1, 0}, 5);
                   camera(out, {0, 1.2, 4}, {0, 0.6, 0}, 0.7, 0.1);
                   StabilityScene scene = scene_of(out);
                   scene.effects = "shadows";
                   scene.blocked_samples = 1;
                   scene.bound = 1, scene.stray_fraction = 0.02;  // of sheets as near to each other as places are
                   scene.energy_bound = 0.05;
                   return scene;
                 }});
}

namespace {

json absorbing_glass(double distance_m, double ior) {
  json material = lit({1, 1, 1}, 0, 0);
  material["doubleSided"] = false;
  material["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                            {"KHR_materials_volume", {{"thicknessFactor", 0.5}}},
                            {"KHR_materials_ior", {{"ior", ior}}},
                            {"KHR_materials_specular", {{"specularFactor", ior == 1 ? 0 : 1}}}};
  if (distance_m > 0)
    material["extensions"]["KHR_materials_volume"].update(
        json{{"attenuationDistance", distance_m}, {"attenuationColor", {0.2, 0.4, 0.8}}});
  return material;
}
// The first triangles of a shape: a body with a hole.
Shape part_of(Shape shape, double share) {
  shape.index.resize(size_t(share * double(shape.index.size() / 3)) * 3);
  return shape;
}
Fill bodies(const std::vector<Shape>& shapes, double distance_m, double ior = 1.5) {
  return [=](GlbWriter& out) {
    for (const char* extension :
         {"KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_ior", "KHR_materials_specular"})
      out.use_extension(extension);
    for (const Shape& shape : shapes) place(out, shape, absorbing_glass(distance_m, ior), {0, 0.75, 1.5});
  };
}
void add_body(Recipes& all, std::string name, std::string what, const Fill& fill, const Fill& plain = {},
              double bound = 1e-3) {
  all.push_back({"bodies", std::move(name), std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = plain ? filled_alike(in, fill, plain, bound) : filled(in, fill);
                   scene.effects = "refraction";
                   scene.paths = true;
                   scene.reference = false;
                   return scene;
                 }});
}

}  // namespace

void add_bodies_by_faces(Recipes& all) {
  const Shape ball = sphere(0.6, 48, 32), open = part_of(ball, 0.6);
  Shape flat = box({0.8, 0.8, 0.8});
  for (glm::dvec3& p : flat.position) p.z = 0;
  const std::vector<Shape> nested = {ball, sphere(0.5, 48, 32), sphere(0.4, 48, 32)};
  // Of the index of air and with nothing to absorb no body is there, whatever its faces.
  for (const auto& [name, shapes] :
       std::initializer_list<std::pair<const char*, std::vector<Shape>>>{{"open body", {open}},
                                                                         {"one face", {quad(1, 1)}},
                                                                         {"nested bodies", nested},
                                                                         {"body without thickness", {flat}}}) {
    add_body(all, std::string(name) + " of air", "not there", bodies(shapes, 0, 1), nothing);
    for (const double distance_m : {1e-6, 0.5, 1e30})
      add_body(all, fmt::format("{}, attenuation distance {:g}", name, distance_m), "", bodies(shapes, distance_m));
  }
  add_body(all, "attenuation distance of 1e30 m", "absorbs nothing", bodies({ball}, 1e30), bodies({ball}, 0));
}

namespace {

// White metal without roughness under a sky, seen by mirrors' lookups. spot: radiance of its brightest texels; 1: a
// furnace, in which such metal cannot be told from the sky.
void add_mirror(Recipes& all, std::string name, std::string what, const Fill& fill, double spot, double bound = 0.01) {
  all.push_back({"mirrors", std::move(name) + (spot == 1 ? " in a furnace" : " under a small light"), std::move(what),
                 [=](StabilityInput&) {
                   GlbWriter out;
                   fill(out);
                   StabilityScene scene = scene_of(out);
                   scene.job.width_px = 32, scene.job.height_px = 24;
                   scene.sky = sky_image(128, 64, [=](int x, int y) {
                     return glm::vec3(x / 2 == 20 && y / 2 == 8 ? float(spot) : 1.0f);
                   });
                   scene.sky_look = json{{"sky", {{"extract_sun", false}}}}.dump();
                   scene.effects = "ibl";
                   scene.reference = false;
                   scene.most = spot * 1.02;
                   if (spot == 1) {
                     GlbWriter empty;
                     place(empty, sphere(1e-3, 4, 3), lit({1, 1, 1}, 0, 1), {0, 0, 100});
                     camera(empty, {0, 1, 4}, {0, 0, 0}, 0.7, 0.01);
                     scene.plain = empty.bytes(), scene.plain_bound = scene.energy_bound = bound;
                   }
                   return scene;
                 }});
}

}  // namespace

void add_mirrors(Recipes& all) {
  const json mirror = lit({1, 1, 1}, 1, 0);
  const auto seen = [](GlbWriter& out) { camera(out, {0, 1, 4}, {0, 0, 0}, 0.7, 0.01); };
  Shape bent = quad(3, 3);  // normals half a turn apart across one quad
  for (size_t i = 0; i < bent.normal.size(); ++i)
    bent.normal[i] = glm::normalize(glm::dvec3(bent.position[i].x < 0 ? -1 : 1, 0, 1e-3));
  Shape no_uv = quad(3, 3);
  no_uv.uv.assign(no_uv.position.size(), glm::dvec2(0.5));
  for (const double spot : {1.0, 1e4}) {
    add_mirror(
        all, "flat mirror along the view", "a floor, the eye a millimetre above it",
        [=](GlbWriter& out) {
          place(out, ground(1000, 1, 1), mirror, {0, 0, 0});
          camera(out, {0, 1e-3, 0}, {0, 0, -1}, 0.7, 1e-4);
        },
        spot);
    add_mirror(
        all, "ball smaller than a pixel", "all of the sky in a pixel",
        [=](GlbWriter& out) {
          place(out, sphere(0.02, 16, 12), mirror, {0, 0, 0}), seen(out);
        },
        spot);
    add_mirror(
        all, "normals that turn within a pixel", "",
        [=](GlbWriter& out) {
          place(out, bent, mirror, {0, 0, 0}), seen(out);
        },
        spot, 0.03);  // the table of what such metal reflects is 2 % off along the surface
    add_mirror(
        all, "one texture coordinate at all corners", "",
        [=](GlbWriter& out) {
          place(out, no_uv, mirror, {0, 0, 0}), seen(out);
        },
        spot);
  }
}

}  // namespace candela::stability
