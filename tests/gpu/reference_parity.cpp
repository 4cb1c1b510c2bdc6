// The reference and the GPU, where neither approximates: shadowless light, no ambient term, the same sample positions.
#include "reference_parity.h"

namespace candela::test {

// Every pixel of a plane under a lamp and a spot with a range, over roughness, metal and angle: the shader's arithmetic
// in 32 bits against the specification in 64.
TEST_F(ReferenceParity, BrdfAndLightsOverAGrid) {
  double worst = 0;
  for (const double roughness : {0.0, 0.1, 0.3, 0.6, 1.0})
    for (const double metallic : {0.0, 0.5, 1.0})
      for (const glm::dvec3 eye : {glm::dvec3(0.3, -0.5, 3), glm::dvec3(2.5, -0.5, 0.4)}) {
        GltfBuilder b = empty_scene();
        Json pbr = base_color(0.8, 0.4, 0.2);
        pbr["metallicFactor"] = metallic, pbr["roughnessFactor"] = roughness;
        Json material = {{"pbrMetallicRoughness", pbr}};
        material["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0.7},
                                                            {"specularColorFactor", {1, 0.5, 2}}};
        add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, material))}});
        add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {-2, 0.25, 0.75}}});
        add_light(b,
                  {{"type", "spot"},
                   {"intensity", 9.0},
                   {"range", 5.0},
                   {"color", {0.2, 1, 0.4}},
                   {"spot", {{"innerConeAngle", 0.4}, {"outerConeAngle", 0.9}}}},
                  {{"translation", {0.5, 0.5, 1.5}}});
        Job job = job_for(write(b), width, height);
        look(job, eye, glm::dvec3(0, 0, 0), 50);
        const Pair pair = rendered(job, 1);
        size_t lit = 0;
        for (size_t i = 0; i < pair.gpu.size(); ++i)
          for (int c = 0; c < 3; ++c) {
            const double expected = pair.reference[i][c];
            if (expected < 1e-3) continue;
            ++lit;
            // A mirror's highlight moves by many times its value a pixel: its place is 32-bit arithmetic's too.
            const double bound = roughness < 0.05 ? 5e-3 : roughness < 0.2 ? 5e-4 : 2e-5;
            const double error = std::abs(pair.gpu[i][c] / expected - 1);
            worst = std::max(worst, error / bound);
            EXPECT_LE(error, bound) << "roughness " << roughness << " metallic " << metallic << " pixel " << i << " is "
                                    << pair.gpu[i][c] << " and should be " << expected;
            if (HasFailure()) return;
          }
        EXPECT_GT(lit, 200u);
      }
  RecordProperty("worst_share_of_bound", fmt::format("{}", worst));
}

// Curved, textured and hidden surfaces: generated scenes with their own lights left out and one lamp put in.
TEST_F(ReferenceParity, WholeScenesUnderOneLamp) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  std::vector<std::pair<double, double>> materials = {{0, 0.4}, {1, 0.3}, {0.5, 0.7}};
  for (size_t i = 0; i < materials.size(); ++i) {
    Json pbr = base_color(0.9, 0.3 + 0.2 * double(i), 0.2);
    pbr["metallicFactor"] = materials[i].first, pbr["roughnessFactor"] = materials[i].second;
    const int material = add_material(b, {{"pbrMetallicRoughness", pbr}});
    add_node(b, {{"mesh", add_square_mesh(b, 1, material)},
                 {"translation", {-1.2 + 1.2 * double(i), 0, -0.3 * double(i)}},
                 {"rotation", {0.2 * double(i), 0.17, 0.05, 0.96}},
                 {"scale", {1, i == 1 ? -1.0 : 1.0, 1}}});
    b.json["materials"].back()["doubleSided"] = true;
  }
  Json blend = diffuse_material(0.2, 0.9, 0.2);
  blend["alphaMode"] = "BLEND", blend["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
  add_node(b, {{"mesh", add_square_mesh(b, 0.5, add_material(b, blend))}, {"translation", {0, 0.4, 1}}});
  add_light(b, {{"type", "point"}, {"intensity", 30.0}}, {{"translation", {1, 2, 2.5}}});
  Job job = job_for(write(b), width, height);
  look(job, {0.4, 0.5, 4}, {0, 0, 0}, 45);
  EXPECT_LT(rendered(job, 4).relmse(), 1e-6);
}

// Every generated scene in motion, with its own lights or the neutral ones: skins, morphs, instances, masks, blending,
// texture coordinates, tangents, mirrored and far transforms. Lines and points, which rays do not meet, are the scene
// left out.
TEST_F(ReferenceParity, GeneratedScenes) {
  for (const std::string& name : scene_names()) {
    if (name == "primitive-modes") continue;
    if (name == "metaballs") continue;  // polygons stand for the surface (reference_metaballs.cpp)
    const Job job = job_for(one_lamp(scene(name), Light::kept), width * 2, height * 2);
    const Pair pair = rendered(job, 4, 17.0 / 24);
    const size_t worst = pair.worst();
    fmt::print("{}: relMSE {:.2e}, worst pixel {},{}: {:.4f} {:.4f} {:.4f} for {:.4f} {:.4f} {:.4f}\n", name,
               pair.relmse(), worst % (2 * width), worst / (2 * width), pair.gpu[worst].x, pair.gpu[worst].y,
               pair.gpu[worst].z, pair.reference[worst].x, pair.reference[worst].y, pair.reference[worst].z);
    // The stars of `animated` are points: what the two pictures differ in there is these.
    EXPECT_LT(pair.relmse(), name == "animated" ? 1e-4 : 1e-5) << name;
  }
}

}  // namespace candela::test
