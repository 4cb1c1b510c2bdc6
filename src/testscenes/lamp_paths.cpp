#include <array>

#include "testscenes/mesh_kit.h"
#include "testscenes/table.h"

namespace candela {

// A corner of a cave for what moves by files (docs/using/paths.md): three coloured spheres with a lamp in each, a stone
// that a file draws many times, and a camera. All stand where they begin; scenes/lamp-paths holds the files.
void make_lamp_paths(GlbWriter& out, SceneOptions&) {
  const Paint floor{out.material("floor", pbr({0.55, 0.53, 0.5, 1}, 0, 0.6))};
  const Paint wall{out.material("wall", pbr({0.7, 0.68, 0.66, 1}, 0, 0.9))};
  MeshKit kit;
  kit.quad(floor, {-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
  kit.quad(wall, {-4, 0, -4}, {8, 0, 0}, {0, 4, 0});
  kit.quad(wall, {-4, 0, 4}, {0, 0, -8}, {0, 4, 0});
  out.node("cave", {{"mesh", kit.write(out, "cave")}});

  const json stone = out.primitive(sphere(0.25, 9, 6));
  out.node("Stone", {{"mesh", out.mesh("stone", stone, out.material("stone", pbr({0.5, 0.46, 0.42, 1}, 0, 0.8)))}});

  out.use_extension("KHR_materials_emissive_strength");
  const json ball = out.primitive(sphere(0.14, 16, 10));
  struct Lamp {
    const char* name;
    glm::dvec3 color;
  };
  constexpr std::array<Lamp, 3> lamps{{{"Red", {1, 0.25, 0.15}}, {"Green", {0.3, 1, 0.35}}, {"Blue", {0.25, 0.45, 1}}}};
  for (size_t i = 0; i < lamps.size(); ++i) {
    const auto& [name, color] = lamps[i];
    json glow = pbr({0, 0, 0, 1}, 0, 1);
    glow["emissiveFactor"] = vector_json(color);
    glow["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = number(4);
    const int mesh = out.mesh(name, ball, out.material(name, glow));
    const int light =
        out.light({{"type", "point"}, {"name", name}, {"color", vector_json(color)}, {"intensity", number(12)}});
    // The sphere does not shade its own lamp: it hangs below it.
    const int node = out.node(name, {{"translation", vector_json({2.0 * double(i) - 2, 1.5, 0})},
                                     {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
    out.child(node, "ball", {{"mesh", mesh}, {"translation", vector_json({0, -0.3, 0})}});
  }
  out.camera_node({5, 3.2, 6}, {-0.3, 0.9, -0.6}, 0.75);
}

}  // namespace candela
