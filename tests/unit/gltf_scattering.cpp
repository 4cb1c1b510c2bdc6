// KHR_materials_volume_scatter: what is read, what is refused, and what is said.
#include <gtest/gtest.h>

#include "gltf/pointers.h"
#include "gltf_builder.h"
#include "scene/material_table.h"

namespace candela::test::gltf_scattering {
namespace {

const Json body = {{"thicknessFactor", 0.5}, {"attenuationDistance", 0.25}, {"attenuationColor", {0.5, 0.5, 0.5}}};

GltfBuilder scattering(const Json& scatter, const Json& volume = body, const char* lets_in = "diffuse_transmission",
                       const char* factor = "diffuseTransmissionFactor") {
  GltfBuilder b;
  b.triangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const std::string by = std::string("KHR_materials_") + lets_in;
  for (const std::string& name : {std::string("KHR_materials_volume_scatter"), std::string("KHR_materials_volume"), by})
    b.use(name);
  b.json["images"] = {{{"uri", png_uri()}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["materials"] = {
      {{"extensions",
        {{"KHR_materials_volume_scatter", scatter}, {"KHR_materials_volume", volume}, {by, {{factor, 0.75}}}}}}};
  return b;
}

// The draft's older name of the colour means the same; where both stand the newer one counts.
TEST(GltfScattering, IsReadByEitherName) {
  for (const Json& scatter : {Json{{"multiscatterColorFactor", {0.5, 0.25, 0.125}}, {"scatterAnisotropy", 0.3}},
                              Json{{"multiscatterColor", {0.5, 0.25, 0.125}}, {"scatterAnisotropy", 0.3}},
                              Json{{"multiscatterColorFactor", {0.5, 0.25, 0.125}},
                                   {"multiscatterColor", {1, 1, 1}},
                                   {"scatterAnisotropy", 0.3}}})
    for (const LoadFor use : {LoadFor::raster, LoadFor::direct_tracing, LoadFor::path_tracing}) {
      const auto scene = scattering(scatter).load(use);
      ASSERT_TRUE(scene) << scene.error().text();
      const Material& m = scene->materials[0];
      EXPECT_TRUE(m.scattering.stated);
      EXPECT_EQ(m.scattering.color, glm::vec3(0.5f, 0.25f, 0.125f));
      EXPECT_EQ(m.scattering.anisotropy, 0.3f);
      EXPECT_TRUE(m.has(Lobe::scattering));
      EXPECT_TRUE(scene->warnings.empty());
    }
  const auto by_refraction =
      scattering({{"scatterAnisotropy", -0.5}}, body, "transmission", "transmissionFactor").load();
  ASSERT_TRUE(by_refraction) << by_refraction.error().text();
  EXPECT_TRUE(by_refraction->materials[0].has(Lobe::scattering));
  EXPECT_EQ(by_refraction->materials[0].scattering.color, glm::vec3(0));
}

TEST(GltfScattering, IsApproximatedButInPaths) {
  for (const LoadFor use : {LoadFor::raster, LoadFor::direct_tracing, LoadFor::path_tracing}) {
    GltfBuilder b = scattering({{"multiscatterColorFactor", {1, 1, 1}}});
    b.json["extensionsRequired"] = {"KHR_materials_volume_scatter"};
    const auto scene = b.load(use);
    ASSERT_TRUE(scene) << scene.error().text();
    const ExtensionUse& said = scene->extensions.at(0);
    EXPECT_EQ(said.name, "KHR_materials_volume_scatter");
    EXPECT_EQ(said.support, use == LoadFor::path_tracing ? Support::supported : Support::approximated);
    EXPECT_EQ(said.consequence.find("slab") != std::string::npos, use != LoadFor::path_tracing) << said.consequence;
  }
}

// Slabs are as thick as the texture says; a path finds out by itself.
TEST(GltfScattering, ThicknessTexturesAreForSlabs) {
  Json volume = body;
  volume["thicknessTexture"] = {{"index", 0}};
  for (const LoadFor use : {LoadFor::raster, LoadFor::direct_tracing, LoadFor::path_tracing}) {
    const auto scene = scattering({{"multiscatterColorFactor", {1, 1, 1}}}, volume).load(use);
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(bool(scene->materials[0].thickness_texture), use != LoadFor::path_tracing);
  }
}

TEST(GltfScattering, SaysWhatScattersNothing) {
  const Json white = {{"multiscatterColorFactor", {1, 1, 1}}};
  const struct {
    GltfBuilder builder;
    const char* said;
  } cases[] = {
      {scattering(white, {{"attenuationDistance", 1}}), "bounds no body"},
      {scattering(white, body, "clearcoat", "clearcoatFactor"), "no light enters"},
      {scattering({{"multiscatterColorFactor", {1, 1, 1}}, {"multiscatterColorTexture", {{"index", 0}}}}),
       "multiscatterColorTexture"},
      {scattering({{"scatterAnisotropy", 1}}), "scatterAnisotropy"},
  };
  for (const auto& c : cases) {
    const auto scene = c.builder.load();
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_TRUE(mentions(scene->warnings, c.said)) << c.said;
    EXPECT_LE(scene->materials[0].scattering.anisotropy, most_anisotropy);
  }
  EXPECT_FALSE(cases[0].builder.load()->materials[0].has(Lobe::scattering));
  EXPECT_FALSE(cases[1].builder.load()->materials[0].has(Lobe::scattering));
}

TEST(GltfScattering, BadValuesAreNamed) {
  for (const auto& [scatter, place] :
       {std::pair(Json{{"multiscatterColorFactor", {0, 2, 0}}}, "multiscatterColorFactor"),
        {Json{{"multiscatterColorFactor", {0.5, 0.5}}}, "multiscatterColorFactor"},
        {Json{{"multiscatterColor", {-1, 0, 0}}}, "multiscatterColor"},
        {Json{{"multiscatterColorFactor", "red"}}, "multiscatterColorFactor"},
        {Json{{"scatterAnisotropy", 1.5}}, "scatterAnisotropy"},
        {Json{{"scatterAnisotropy", -2}}, "scatterAnisotropy"},
        {Json{{"scatterAnisotropy", {0.5}}}, "scatterAnisotropy"}}) {
    const auto scene = scattering(scatter).load();
    ASSERT_FALSE(scene) << scatter.dump();
    EXPECT_NE(scene.error().text().find("/materials/0/extensions/KHR_materials_volume_scatter/" + std::string(place)),
              std::string::npos)
        << scene.error().text();
  }
}

// By the name of the draft that the file follows.
TEST(GltfScattering, AnimationsReachItsFactors) {
  const auto scene = scattering({{"multiscatterColor", {1, 1, 1}}}).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const std::string at = "/materials/0/extensions/KHR_materials_volume_scatter/";
  for (const char* name : {"multiscatterColorFactor", "multiscatterColor"}) {
    const auto target = gltf::pointer_target(*scene, at + name);
    ASSERT_TRUE(target) << name;
    EXPECT_EQ(target->path, TargetPath::material_multiscatter_color);
    EXPECT_EQ(gltf::pointer_target(*scene, at + name + "/2")->element, 2);
  }
  EXPECT_EQ(gltf::pointer_target(*scene, at + "scatterAnisotropy")->path, TargetPath::material_scatter_anisotropy);
}

}  // namespace
}  // namespace candela::test::gltf_scattering
