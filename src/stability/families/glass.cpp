// Surfaces that let light through, at the ends of what KHR_materials_transmission, volume, ior and dispersion allow.
// With the effect `refraction` each is compared with a scene that must look the same.
#include <cmath>

#include "stability/stage.h"

namespace candela::stability {
namespace {

struct Glass {
  glm::dvec3 color{0.9};
  double metallic = 0, roughness = 0, ior = 1.5, specular = 1, transmission = 1;
  json volume;  // null: a sheet
  double dispersion = 0;
};
json body(double thickness_m = 1, json attenuation = {}) {
  json volume = {{"thicknessFactor", thickness_m}};
  if (!attenuation.is_null()) volume.update(attenuation);
  return volume;
}
json absorbing(double distance_m, glm::dvec3 color) {
  return {{"attenuationDistance", distance_m}, {"attenuationColor", exact(color)}};
}

json glass_material(GlbWriter& out, const Glass& g) {
  json material = lit(g.color, g.metallic, g.roughness);
  material["doubleSided"] = false;
  const auto extend = [&](const std::string& name, json values) {
    out.use_extension("KHR_materials_" + name);
    material["extensions"]["KHR_materials_" + name] = std::move(values);
  };
  extend("transmission", {{"transmissionFactor", g.transmission}});
  if (!g.volume.is_null()) extend("volume", g.volume);
  extend("ior", {{"ior", g.ior}});
  extend("specular", {{"specularFactor", g.specular}});
  extend("dispersion", {{"dispersion", g.dispersion}});
  return material;
}

// The look-up behind a surface is off the pixel's middle by what floats say of its place, between texels of any
// contrast.
constexpr double by_places = 1e-3;
constexpr glm::dvec3 place_m(0, 0.75, 1.5);
Shape ball(double radius = 0.6) { return sphere(radius, 64, 48); }
Fill of(const Glass& glass, const Shape& shape = ball()) {
  return [=](GlbWriter& out) { place(out, shape, glass_material(out, glass), place_m); };
}
void nothing(GlbWriter&) {}

// A turned box whose node is `scale` times as large as its mesh and what that says of thickness.
Fill scaled(const Glass& glass, glm::dvec3 scale) {
  return [=](GlbWriter& out) {
    const double volume = std::abs(scale.x * scale.y * scale.z);
    Glass of_mesh = glass;
    of_mesh.volume = body(0.25 / std::cbrt(volume), absorbing(0.5, {0.3, 0.6, 0.9}));
    Shape shape = box({0.75, 0.75, 0.75});
    for (glm::dvec3& p : shape.position) p /= scale;
    if (scale.x * scale.y * scale.z < 0)
      for (size_t i = 0; i < shape.index.size(); i += 3) std::swap(shape.index[i + 1], shape.index[i + 2]);
    const glm::dvec3 signs = glm::sign(scale);
    for (glm::dvec3& n : shape.normal) n *= signs;
    const int mesh = out.mesh("box", out.primitive(shape), out.material("glass", glass_material(out, of_mesh)));
    out.node("box", {{"mesh", mesh}, {"translation", exact(place_m)}, {"scale", exact(scale)}});
  };
}

// Refracted, beside what must look the same.
void add_alike(Recipes& all, std::string name, std::string what, Fill fill, Fill plain, double bound = 1e-5,
               const std::function<void(StabilityScene&)>& change = {}) {
  all.push_back({"glass", std::move(name), std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = filled_alike(in, fill, plain, bound);
                   scene.effects = "refraction";
                   scene.paths = true;
                   if (change) change(scene);
                   return scene;
                 }});
}
// Finite, refracted or in paths; opaque as the reference has it.
void add_finite(Recipes& all, std::string name, std::string what, Fill fill) {
  all.push_back({"glass", std::move(name), std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = filled(in, fill);
                   scene.paths = true;
                   return scene;
                 }});
}
void add_refused(Recipes& all, std::string name, std::string what, Fill fill) {
  all.push_back({"glass", std::move(name), "refused: " + std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = filled(in, fill);
                   scene.refused = true;
                   return scene;
                 }});
}
Fill nested(Glass glass, int count) {
  return [=](GlbWriter& out) {
    for (int i = 0; i < count; ++i) place(out, ball(0.6 - 0.05 * i), glass_material(out, glass), place_m);
  };
}

void add_indices(Recipes& all) {
  const Glass invisible{.color = glm::dvec3(1), .ior = 1, .specular = 0, .volume = body()};
  const auto with = [](Glass g, auto change) {
    change(g);
    return g;
  };
  add_alike(all, "ior 1", "white, without gloss: not there", of(invisible), nothing, by_places);
  add_alike(all, "ior 1 + 2^-23", "not there either", of(with(invisible, [](Glass& g) { g.ior = 1 + 0x1p-23; })),
            nothing, by_places);
  add_alike(all, "ior 1 and dispersion 1e6", "there is nothing to disperse",
            of(with(invisible, [](Glass& g) { g.dispersion = 1e6; })), nothing, by_places);
  add_alike(all, "ior 1 and 1e9 m thick", "light goes straight on",
            of(with(invisible, [](Glass& g) { g.volume = body(1e9); })), nothing, by_places);
  add_refused(all, "ior just below 1", "no index", of({.ior = std::nextafter(1.0f, 0.0f), .volume = body()}));
  add_alike(all, "ior 0", "reflects all: as without transmission", of({.ior = 0, .volume = body()}),
            of({.ior = 0, .transmission = 0}));
  // What goes in shows what is behind, beside a hundredth of the median where the mirror is black.
  add_alike(all, "ior 1e6", "a 250,000th goes in", of({.ior = 1e6, .volume = body()}),
            of({.color = glm::dvec3(0), .ior = 1e6, .transmission = 0}), 1e-3);
  add_alike(all, "metal", "lets nothing through", of({.metallic = 1, .volume = body()}),
            of({.metallic = 1, .transmission = 0}));
  add_alike(all, "dispersion 0", "as without it", of({.volume = body(), .dispersion = 0}), of({.volume = body()}), 0);
  add_finite(all, "clear glass", "under a lamp without size",
             of({.volume = body(1, absorbing(1, {1, 0.5, 0})), .dispersion = 1}));
  add_finite(all, "dispersion 1e6", "blue light is bent by an index of 1e4",
             of({.volume = body(1, absorbing(1, {1, 0.5, 0})), .dispersion = 1e6}));
  add_finite(all, "ior 1e9", "a mirror from without and within", of({.ior = 1e9, .volume = body()}));
  add_finite(all, "rough of ior 1e6", "", of({.roughness = 1, .ior = 1e6, .volume = body()}));
  add_finite(all, "rough of ior 1 + 2^-23", "its lobe is as narrow as the index is near",
             of({.roughness = 0.5, .ior = 1 + 0x1p-23, .volume = body()}));
}

void add_thickness(Recipes& all) {
  const json absorption = absorbing(0.25, {0.2, 0.5, 0.9});
  add_alike(all, "thickness 0", "a sheet, which absorbs nothing", of({.volume = body(0, absorption)}), of({}), 0);
  add_finite(all, "frosted sheet", "thickness 0, roughness 0.6", of({.roughness = 0.6, .volume = body(0)}));
  add_finite(all, "1e9 m thick", "more than the world", of({.roughness = 0.1, .volume = body(1e9)}));
  add_finite(all, "1e38 m thick", "no float holds what it absorbs", of({.volume = body(1e38, absorption)}));
  const Glass glass;
  // Scales without rounding, and corners that come out the same.
  for (const int power : {-40, -20, 20, 60})
    add_alike(all, "node of scale 2^" + std::to_string(power), "thickness grows with it",
              scaled(glass, glm::dvec3(std::exp2(power))), scaled(glass, glm::dvec3(1)));
  add_alike(all, "mirrored node", "as thick as the other way round", scaled(glass, glm::dvec3(-1, 1, 1)),
            scaled(glass, glm::dvec3(1)));
  add_alike(
      all, "node of scale 0", "nothing is there",
      [](GlbWriter& out) { place(out, ball(), glass_material(out, {.volume = body()}), place_m, glm::dvec3(0)); },
      nothing, 0);
  add_alike(
      all, "sheet of scale 2^60", "thickness 0 stays 0",
      [](GlbWriter& out) {
        place(out, quad(std::exp2(-60), std::exp2(-60)), glass_material(out, {.volume = body(0)}), place_m,
              glm::dvec3(std::exp2(60)));
      },
      [](GlbWriter& out) { place(out, quad(1, 1), glass_material(out, {}), place_m); });
  add_finite(all, "flat node", "scale 0 along one axis: a body without volume", [](GlbWriter& out) {
    place(out, box({0.75, 0.75, 0.75}), glass_material(out, {.volume = body(0.25)}), place_m, {1, 1, 0});
  });
}

void add_absorption(Recipes& all) {
  const auto absorbs = [](double distance_m, glm::dvec3 color, double thickness_m = 0.25) {
    return of({.volume = body(thickness_m, absorbing(distance_m, color))});
  };
  const auto tinted = [](glm::dvec3 color) { return of({.color = color, .volume = body(0.25)}); };
  add_alike(all, "absorbs in 1e-30 m", "red is left", absorbs(1e-30, {1, 0.5, 0}), tinted({0.9, 0, 0}));
  add_refused(all, "absorbs in 0 m", "no distance", absorbs(0, {1, 0.5, 0}));
  add_alike(all, "colour 0", "black, over whatever distance", absorbs(100, glm::dvec3(0)), tinted(glm::dvec3(0)));
  add_alike(all, "colour 1 in 1e-30 m", "absorbs nothing", absorbs(1e-30, glm::dvec3(1)), tinted(glm::dvec3(0.9)), 0);
  add_alike(all, "absorbs in 1e38 m", "nothing", absorbs(1e38, {0.1, 0.5, 0.9}), tinted(glm::dvec3(0.9)));
  add_alike(all, "no distance", "infinite: whatever colour, nothing is absorbed",
            of({.volume = body(0.25, {{"attenuationColor", {0.1, 0.5, 0.9}}})}), tinted(glm::dvec3(0.9)), 0);
  add_finite(all, "rough absorbs in 1e-30 m", "next to nothing comes through",
             of({.roughness = 0.5, .volume = body(1, absorbing(1e-30, {1, 0.5, 0}))}));
}

void add_bodies(Recipes& all) {
  add_finite(all, "ior 0 ten in each other", "nothing goes in",
             nested({.ior = 0, .volume = body(1, absorbing(1, {1, 0.5, 0})), .dispersion = 1}, 10));
  add_finite(all, "ten in each other", "deeper than bodies are counted",
             nested({.roughness = 0.2, .volume = body(1, absorbing(1e30, {1, 0.5, 0})), .dispersion = 1}, 10));
  all.push_back({"glass", "two in one place", "which is seen depends on rounding: finite", [](StabilityInput& in) {
                   StabilityScene scene = filled(in, [](GlbWriter& out) {
                     for (const double ior : {1.3, 1.7})
                       place(out, ball(), glass_material(out, {.ior = ior, .volume = body()}), place_m);
                   });
                   scene.reference = false;
                   scene.paths = true;
                   return scene;
                 }});
  add_finite(all, "camera inside", "only its inner side is there", [](GlbWriter& out) {
    json material = glass_material(out, {.volume = body(1, absorbing(1, {1, 0.5, 0}))});
    material["doubleSided"] = true;
    place(out, ball(0.5), material, {0.5, 1.75, 4.5});
  });
  add_finite(all, "seen edge on", "sheets in a plane through the eye", [](GlbWriter& out) {
    Shape sheet = quad(1, 1);
    for (glm::dvec3& p : sheet.position) p = {0, p.y, p.x};
    for (glm::dvec3& n : sheet.normal) n = {1, 0, 0};
    for (const double roughness : {0.0, 0.5})
      place(out, sheet, glass_material(out, {.roughness = roughness}), {0.5, 0.75, 1.5 - 3 * roughness});
  });
  const Fill lamp = [](GlbWriter& out) {
    out.use_extension("KHR_materials_emissive_strength");
    json material = lit({0, 0, 0}, 0, 1);
    material["emissiveFactor"] = {1, 0.5, 0.25};
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 1e30}};
    place(out, quad(8, 8), material, {0, 1, 0.5});
  };
  add_alike(
      all, "bright behind", "1e30, through a white sheet without gloss",
      [=](GlbWriter& out) {
        lamp(out);
        place(out, quad(1, 1), glass_material(out, {.color = glm::dvec3(1), .specular = 0}), place_m);
      },
      lamp, by_places, [](StabilityScene& scene) { scene.clamps = true; });
}

// Bodies that scatter light, which comes in diffusely; extinction from attenuation.
void add_scattering(Recipes& all) {
  const auto add = [&](std::string name, std::string what, double color, double anisotropy, json volume) {
    add_finite(all, "scatters, " + name, std::move(what), [=](GlbWriter& out) {
      json material = lit({0.9, 0.9, 0.9}, 0, 0.5);
      material["doubleSided"] = false;
      const auto extend = [&](const std::string& extension, json values) {
        out.use_extension("KHR_materials_" + extension);
        material["extensions"]["KHR_materials_" + extension] = std::move(values);
      };
      extend("diffuse_transmission", {{"diffuseTransmissionFactor", 1}});
      extend("volume", volume);
      extend("volume_scatter",
             {{"multiscatterColorFactor", exact(glm::dvec3(color))}, {"scatterAnisotropy", anisotropy}});
      place(out, ball(), material, place_m);
    });
  };
  const glm::dvec3 half(0.5);
  add("colour 1", "nothing is lost", 1, 0, body(1, absorbing(1, half)));
  add("colour 0", "nothing is scattered", 0, 0, body(1, absorbing(1, half)));
  add("anisotropy 1", "all goes on", 1, 1, body(1, absorbing(1, half)));
  add("anisotropy -1", "all comes back", 1, -1, body(1, absorbing(1, half)));
  add("in 1e-30 m", "opaque", 0.5, 0, body(1, absorbing(1e-30, half)));
  add("in 1e38 m", "hardly anywhere", 0.5, 0, body(1, absorbing(1e38, half)));
  add("attenuation colour 0", "at the surface", 0.5, 0, body(1, absorbing(1, glm::dvec3(0))));
  add("1e9 m thick", "nothing comes through", 0.5, 0, body(1e9, absorbing(1, half)));
  add("1e-30 m thick", "all comes through", 0.5, 0, body(1e-30, absorbing(1, half)));
}

}  // namespace

void add_glass(Recipes& all) {
  add_indices(all);
  add_thickness(all);
  add_absorption(all);
  add_bodies(all);
  add_scattering(all);
}

}  // namespace candela::stability
