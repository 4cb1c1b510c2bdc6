#pragma once
// Scenes of glass before a wall that gives its own light, for tests of what draws surfaces that let light through.
#include "frame_fixture.h"
#include "testscenes/procedural_shapes.h"

namespace candela::test {

inline constexpr int glass_width = 64, glass_height = 48;
inline constexpr glm::dvec3 wall_colour(0.2, 0.5, 0.9);

struct Glass {
  glm::dvec3 color{1};
  double roughness = 0, ior = 1, transmission = 1, thickness_m = 0, dispersion = 0;
  glm::dvec3 attenuation{1};
  double distance_m = 1;
};
inline Json glass_material(const Glass& g) {
  Json material = {{"pbrMetallicRoughness", base_color(g.color.x, g.color.y, g.color.z)}};
  material["pbrMetallicRoughness"]["roughnessFactor"] = g.roughness;
  material["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", g.transmission}}},
                            {"KHR_materials_ior", {{"ior", g.ior}}},
                            {"KHR_materials_dispersion", {{"dispersion", g.dispersion}}},
                            {"KHR_materials_volume",
                             {{"thicknessFactor", g.thickness_m},
                              {"attenuationDistance", g.distance_m},
                              {"attenuationColor", {g.attenuation.x, g.attenuation.y, g.attenuation.z}}}}};
  return material;
}

class GlassTest : public FrameTest {
 protected:
  // Nothing is lit, nothing reflects: a light that gives next to nothing keeps the neutral light away.
  static GltfBuilder dark() {
    GltfBuilder b = empty_scene();
    add_light(b, {{"type", "directional"}, {"intensity", 1e-12}}, {{"translation", {0, 0, 3}}});
    for (const char* name :
         {"KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_volume", "KHR_materials_dispersion"})
      b.json["extensionsUsed"].push_back(name);
    return b;
  }
  static void add_wall(GltfBuilder& b, double z = -1) {
    const int mesh =
        add_square_mesh(b, 6, add_material(b, unlit_material(wall_colour.x, wall_colour.y, wall_colour.z)));
    add_node(b, {{"mesh", mesh}, {"translation", {0, 0, z}}});
  }
  static void add_sheet(GltfBuilder& b, const Json& material, float half = 1, glm::dvec3 at = glm::dvec3(0),
                        double scale = 1) {
    add_node(b, {{"mesh", add_square_mesh(b, half, add_material(b, material))},
                 {"translation", {at.x, at.y, at.z}},
                 {"scale", {scale, scale, scale}}});
  }
  static void add_shape(GltfBuilder& b, const Shape& shape, const Json& material, glm::dvec3 at) {
    std::vector<float> position, normal;
    for (const glm::dvec3& p : shape.position)
      for (int c = 0; c < 3; ++c) position.push_back(float(p[c]));
    for (const glm::dvec3& n : shape.normal)
      for (int c = 0; c < 3; ++c) normal.push_back(float(n[c]));
    const int place = b.accessor<float>("VEC3", position), facing = b.accessor<float>("VEC3", normal);
    Json& part = b.primitive({{"POSITION", place}, {"NORMAL", facing}});
    part["indices"] = b.accessor<uint32_t>("SCALAR", shape.index);
    part["material"] = add_material(b, material);
    add_node(b, {{"mesh", int(b.json["meshes"].size()) - 1}, {"translation", {at.x, at.y, at.z}}});
  }
  static Job seen(const GltfBuilder& b, int samples = 1) {
    Job job = job_for(write(b), glass_width, glass_height, samples);
    look(job, {0, 0, 4}, {0, 0, 0}, 40);
    job.effects = "refraction";
    return job;
  }
  static void expect_color(glm::vec4 value, glm::dvec3 expected, const std::string& what, double by = 2e-6) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], by) << what << ", channel " << c;
  }
};

}  // namespace candela::test
