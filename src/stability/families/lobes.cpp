// Lobes of Khronos materials at the ends of what their extensions allow.
#include "stability/stage.h"
#include "testscenes/procedural_textures.h"

namespace candela::stability {
namespace {

json with_lobes(json material, const json& lobes) {
  for (const auto& [name, values] : lobes.items()) material["extensions"]["KHR_materials_" + name] = values;
  return material;
}

// Over the room's floor, near the light, which also shines from behind.
void add_shape(Recipes& all, std::string name, std::string what, const Shape& shape, double metallic, double roughness,
               const std::function<json(GlbWriter&)>& lobes, double bound = 1e-3) {
  all.push_back({"lobes", std::move(name), std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = filled(in, [&](GlbWriter& out) {
                     const json made = lobes(out);
                     for (const auto& [lobe, values] : made.items()) out.use_extension("KHR_materials_" + lobe);
                     place(out, shape, with_lobes(lit({0.5, 0.4, 0.3}, metallic, roughness), made), {0, 0.75, 1.5});
                     point(out, {0, 1, 0.5}, 10);
                   });
                   scene.bound = bound;
                   scene.paths = true;
                   return scene;
                 }});
}
void add_ball(Recipes& all, std::string name, std::string what, double metallic, double roughness, json lobes,
              double bound = 1e-3) {
  add_shape(
      all, std::move(name), std::move(what), with_tangents(sphere(0.6, 64, 48)), metallic, roughness,
      [=](GlbWriter&) { return lobes; }, bound);
}

json film(double ior, double thickness_nm) {
  return {{"iridescence",
           {{"iridescenceFactor", 1}, {"iridescenceIor", ior}, {"iridescenceThicknessMaximum", thickness_nm}}}};
}
json coat(double roughness) {
  return {{"clearcoat", {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", roughness}}}};
}
json sheen(double roughness) {
  return {{"sheen", {{"sheenColorFactor", {1, 1, 1}}, {"sheenRoughnessFactor", roughness}}}};
}
json stretched(double rotation) {
  return {{"anisotropy", {{"anisotropyStrength", 1}, {"anisotropyRotation", rotation}}}};
}
json passing(double red) {
  return {
      {"diffuse_transmission", {{"diffuseTransmissionFactor", 1}, {"diffuseTransmissionColorFactor", {red, 1, 0}}}}};
}
json all_of(std::initializer_list<json> lobes) {
  json all;
  for (const json& lobe : lobes) all.update(lobe);
  return all;
}

// The coat's normals from one texel.
std::function<json(GlbWriter&)> coat_of_normal(glm::dvec3 texel, double scale = 1) {
  return [=](GlbWriter& out) {
    json made = coat(0.2);
    const int texture = out.texture("normals", png_from(2, 2, 3, [=](double, double) { return glm::dvec4(texel, 1); }));
    made["clearcoat"]["clearcoatNormalTexture"] = {{"index", texture}, {"scale", scale}};
    return made;
  };
}
// Stripes of a film from least to most.
std::function<json(GlbWriter&)> striped_film(double ior, double least_nm, double most_nm) {
  return [=](GlbWriter& out) {
    json made = film(ior, most_nm);
    made["iridescence"]["iridescenceThicknessMinimum"] = least_nm;
    const int texture =
        out.texture("thickness", png_from(1, 16, 3, [](double, double v) { return glm::dvec4(0, v, 0, 1); }),
                    {{"magFilter", 9728}, {"minFilter", 9728}});
    made["iridescence"]["iridescenceThicknessTexture"] = {{"index", texture}};
    return made;
  };
}

Shape with_tangent(Shape shape, const std::function<glm::dvec4(glm::dvec3 normal)>& tangent) {
  for (const glm::dvec3& normal : shape.normal) shape.tangent.push_back(tangent(normal));
  return shape;
}

// A floor of ten metres, seen from a height of a centimetre.
void add_floor(Recipes& all, std::string name, std::string what, double metallic, double roughness, json lobes,
               double bound = 1e-3) {
  all.push_back({"lobes", std::move(name), std::move(what), [=](StabilityInput&) {
                   GlbWriter out;
                   for (const auto& [lobe, values] : lobes.items()) out.use_extension("KHR_materials_" + lobe);
                   place(out, with_tangents(ground(40, 1, 1)),
                         with_lobes(lit({0.8, 0.8, 0.8}, metallic, roughness), lobes), {0, 0, 0});
                   point(out, {0, 0.5, -8}, 20);
                   sun(out, {0.1, 0.01, -1}, 1);
                   camera(out, {0, 0.01, 10}, {0, 0, -4}, 0.3, 0.01);
                   StabilityScene scene = scene_of(out);
                   scene.bound = bound;
                   scene.energy_bound = std::max(scene.energy_bound, bound / 4);
                   scene.paths = true;
                   return scene;
                 }});
}

// Under an even sky of radiance 1, with nothing else: no more than comes in.
void add_furnace(Recipes& all, std::string name, std::string what, double metallic, double roughness, json lobes,
                 double most) {
  all.push_back({"lobes", std::move(name) + " in a furnace", std::move(what), [=](StabilityInput&) {
                   GlbWriter out;
                   for (const auto& [lobe, values] : lobes.items()) out.use_extension("KHR_materials_" + lobe);
                   place(out, with_tangents(sphere(1, 64, 48)), with_lobes(lit({1, 1, 1}, metallic, roughness), lobes),
                         {0, 0, 0});
                   camera(out, {0, 0, 4}, {0, 0, 0}, 0.6);
                   StabilityScene scene = scene_of(out);
                   scene.sky = sky_image(64, 32, [](int, int) { return glm::vec3(1); });
                   scene.effects = "ibl";
                   scene.reference = false;
                   scene.most = most;
                   return scene;
                 }});
}

// KHR_materials_pbrSpecularGlossiness
void add_glossiness(Recipes& all, std::string name, glm::dvec3 diffuse, glm::dvec3 specular, double glossiness) {
  all.push_back({"lobes", std::move(name), "specular-glossiness", [=](StabilityInput& in) {
                   return filled(in, [=](GlbWriter& out) {
                     out.use_extension("KHR_materials_pbrSpecularGlossiness");
                     json material = lit({0, 0, 0}, 0, 1);
                     material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
                         {"diffuseFactor", {diffuse.x, diffuse.y, diffuse.z, 1}},
                         {"specularFactor", exact(specular)},
                         {"glossinessFactor", glossiness}};
                     place(out, sphere(0.6, 64, 48), material, {0, 0.75, 1.5});
                   });
                 }});
}

}  // namespace

void add_lobes(Recipes& all) {
  add_ball(all, "coat of roughness 0", "a mirror over a rough base", 0, 1, coat(0));
  add_ball(all, "coat of roughness 1", "over a mirror", 1, 0, coat(1));
  add_ball(all, "sheen of roughness 0", "straight fibres: grazing light above what comes in, held at 1", 0, 1,
           sheen(0));
  add_ball(all, "sheen of roughness 1", "white, over a metal", 1, 0.5, sheen(1));
  add_ball(all, "film of 0 nm", "as without one", 0.5, 0.3, film(1.8, 0));
  add_ball(all, "film of 1e9 nm", "washed out", 0.5, 0.3, film(1.8, 1e9));
  add_ball(all, "film of 1e38 nm", "its path is no float", 0.5, 0.3, film(1.8, 1e38));
  add_ball(all, "film of ior 1", "there is no interface to air", 1, 0.3, film(1, 400));
  add_ball(all, "film of ior 1e6", "a mirror", 0, 0.3, film(1e6, 400));
  add_ball(all, "stretched mirror", "anisotropy 1, roughness 0: 0.002 across and 1 along", 1, 0, stretched(0));
  for (const auto& [name, rotation] : {std::pair("1e6", 1e6), {"1e30", 1e30}})
    add_ball(all, std::string("stretched and turned by ") + name + " rad", "", 1, 0.5, stretched(rotation));
  const Shape ball = sphere(0.6, 64, 48);
  const auto along_x = [](GlbWriter&) { return stretched(0.5); };
  add_shape(all, "stretched by tangents of 0", "no direction: round facets",
            with_tangent(ball, [](glm::dvec3) { return glm::dvec4(0, 0, 0, 1); }), 1, 0.3, along_x);
  add_shape(all, "stretched by tangents along the normal", "no direction either",
            with_tangent(ball, [](glm::dvec3 n) { return glm::dvec4(n, 1); }), 1, 0.3, along_x);
  add_shape(all, "stretched by tangents of 1e-30", "short, but a direction",
            with_tangent(ball, [](glm::dvec3 n) { return glm::dvec4(1e-30 * glm::dvec3(n.y, -n.x, 0), -1); }), 1, 0.3,
            along_x);
  Shape one_place = ball, none = ball;
  for (glm::dvec2& uv : one_place.uv) uv = {0.5, 0.5};
  none.uv.clear();
  add_shape(all, "stretched with one texture coordinate", "tangents of triangles without area", one_place, 1, 0.3,
            along_x);
  add_shape(all, "stretched without texture coordinates", "no tangents", none, 1, 0.3, along_x);
  add_ball(all, "passing all light", "colour of 1e6 in one channel", 0, 0.5, passing(1e6));
  for (const double roughness : {0.0, 1.0}) {
    const std::string of = " of roughness " + std::to_string(int(roughness));
    // The base gets what the sheen leaves of 1: a table's error of 1e-3 is a larger part of a small rest.
    add_floor(all, "sheen" + of + " along the floor", "cosines of 1e-3", 0, 0.5, sheen(roughness), 2e-3);
    add_floor(all, "coat" + of + " along the floor", "cosines of 1e-3", 0, 0.5, coat(roughness));
  }
  add_floor(all, "film along the floor", "cosines of 1e-3", 1, 0.3, film(1.5, 300));
  add_floor(all, "stretched along the floor", "cosines of 1e-3, a mirror across", 1, 0, stretched(0.7));
  const Shape tangents = with_tangents(ball);
  add_shape(all, "coat normals reversed", "into the surface", tangents, 0, 0.5, coat_of_normal({0.5, 0.5, 0}));
  add_shape(all, "coat normals of 0", "no direction", tangents, 0, 0.5, coat_of_normal(glm::dvec3(0.5)));
  add_shape(all, "coat normals of scale 1e30", "their square is no float", tangents, 0, 0.5,
            coat_of_normal({0.7, 0.6, 0.9}, 1e30));
  add_shape(all, "film from 1000 nm to 100", "the least above the most", tangents, 0.5, 0.3,
            striped_film(1.5, 1000, 100));
  add_shape(all, "film from 0 nm to 1e9", "", tangents, 0.5, 0.3, striped_film(1.5, 0, 1e9));
  add_shape(all, "film of ior 1 from 0 nm to 0", "", tangents, 0.5, 0.3, striped_film(1, 0, 0));
  add_furnace(all, "white metal", "", 1, 0.3, json::object(), 1.01);
  add_furnace(all, "coat on white metal", "", 1, 0.5, coat(0.1), 1.01);
  add_furnace(all, "coat and sheen on white metal", "", 1, 0.5, all_of({coat(0.3), sheen(0.3)}), 1.01);
  add_furnace(all, "film on white metal", "", 1, 0.2, film(1.8, 400), 1.01);
  add_furnace(all, "stretched white metal", "", 1, 0.3, stretched(0), 1.01);
  add_glossiness(all, "white of glossiness 0", glm::dvec3(1), glm::dvec3(0), 0);
  add_glossiness(all, "mirror of glossiness 1", glm::dvec3(0), glm::dvec3(1), 1);
  add_glossiness(all, "white in both of glossiness 0", glm::dvec3(1), glm::dvec3(1), 0);
  add_glossiness(all, "black in both", glm::dvec3(0), glm::dvec3(0), 0.5);
  add_ball(all, "all lobes", "each at its end", 0.5, 0,
           all_of({coat(0), sheen(0), film(1e6, 1e9), stretched(3), passing(1)}));
}

namespace {

// Under a sky that is bright on one side, alone: the light of stretched facets by directions of each pixel
// (ibl.stretched) against the reference's samples.
void add_under_sky(Recipes& all, std::string name, std::string what, const Shape& shape, double roughness,
                   double strength, int directions, float bright, double energy_bound) {
  all.push_back({"lobes", std::move(name) + " under a sky", std::move(what), [=](StabilityInput&) {
                   GlbWriter out;
                   out.use_extension("KHR_materials_anisotropy");
                   json lobes = stretched(0.5);
                   lobes["anisotropy"]["anisotropyStrength"] = strength;
                   place(out, shape, with_lobes(lit({0.9, 0.7, 0.5}, 1, roughness), lobes), {0, 0, 0});
                   camera(out, {0, 0, 4}, {0, 0, 0}, 0.6);
                   StabilityScene scene = scene_of(out);
                   scene.job.width_px = 32, scene.job.height_px = 24;
                   scene.sky = sky_image(64, 32, [=](int x, int y) {
                     const bool lamp = y >= 8 && y < 16 && x >= 20 && x < 32;
                     return glm::vec3(1, 0.9f, 0.8f) * (lamp ? bright : 0.5f + 0.01f * float(y));
                   });
                   scene.effects = "ibl";
                   scene.job.settings.push_back({"ibl", "stretched", std::to_string(directions)});
                   scene.blocked_samples = 64;
                   // Both have noise or steps: their sum is judged, and that no pixel leaves what the sky has.
                   scene.bound = double(bright) / 0.5, scene.energy_bound = energy_bound;
                   scene.most = 1.02 * double(bright);
                   return scene;
                 }});
}

}  // namespace

void add_lobes_under_skies(Recipes& all) {
  const Shape ball = with_tangents(sphere(1, 64, 48));
  for (const int directions : {1, 48})
    for (const double roughness : {0.0, 0.1, 1.0})
      add_under_sky(all, fmt::format("stretched by 1, roughness {:g}, {} directions", roughness, directions), "", ball,
                    roughness, 1, directions, 20, directions == 1 ? 0.5 : 0.05);
  add_under_sky(all, "stretched by 1e-6, roughness 0.5", "next to round", ball, 0.5, 1e-6, 48, 20, 0.05);
  add_under_sky(all, "stretched by 1, roughness 0, a lamp of 1e6", "", ball, 0, 1, 48, 1e6f, 0.1);
  Shape along = sphere(1, 64, 48);
  for (const glm::dvec3& n : along.normal) along.tangent.push_back(glm::dvec4(n, 1));
  add_under_sky(all, "stretched by tangents along the normal", "no direction", along, 0.3, 1, 48, 20, 0.1);
}

}  // namespace candela::stability
