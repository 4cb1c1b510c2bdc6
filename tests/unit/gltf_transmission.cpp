// KHR_materials_transmission, _volume and _dispersion: what is read, for whom, and what is refused.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/texture_slots.h"

namespace candela::test::gltf_transmission {
namespace {

GltfBuilder glass(const Json& transmission, const Json& volume = Json::object(),
                  const Json& dispersion = Json::object()) {
  GltfBuilder b;
  b.triangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  for (const char* name : {"KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_dispersion"})
    b.use(name);
  b.json["images"] = {{{"uri", png_uri()}}, {{"uri", png_uri()}}};
  b.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  b.json["materials"] = {{{"extensions",
                           {{"KHR_materials_transmission", transmission},
                            {"KHR_materials_volume", volume},
                            {"KHR_materials_dispersion", dispersion}}}}};
  return b;
}
const Json textured = {{"transmissionFactor", 0.75}, {"transmissionTexture", {{"index", 1}, {"texCoord", 1}}}};

int traced_slots(const Material& m) {
  int count = 0;
  for_each_slot(m, [&](const TextureSlot& slot, bool srgb) { count += bool(slot) && !srgb; });
  return count;
}

TEST(GltfTransmission, IsReadForPaths) {
  const Json volume = {{"thicknessFactor", 0.5},
                       {"thicknessTexture", {{"index", 0}}},
                       {"attenuationDistance", 0.25},
                       {"attenuationColor", {1, 0.5, 0}}};
  const auto scene = glass(textured, volume, {{"dispersion", 0.4}}).load(LoadFor::path_tracing);
  ASSERT_TRUE(scene) << scene.error().text();
  const Material& m = scene->materials[0];
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_EQ(m.transmission_texture.image, 1);
  EXPECT_EQ(m.transmission_texture.uv_set, 1);
  EXPECT_EQ(m.thickness_m, 0.5f);
  EXPECT_EQ(m.attenuation_distance_m, 0.25f);
  EXPECT_EQ(m.attenuation_color, glm::vec3(1, 0.5, 0));
  EXPECT_EQ(m.dispersion, 0.4f);
  EXPECT_EQ(traced_slots(m), 1);
  EXPECT_FALSE(scene->images[1].encoded.empty());
  EXPECT_TRUE(scene->images[0].encoded.empty()) << "how thick a body is tells its geometry";
  for (const ExtensionUse& use : scene->extensions) EXPECT_EQ(use.support, Support::supported) << use.name;
  const auto defaults = glass(Json::object()).load(LoadFor::path_tracing);
  ASSERT_TRUE(defaults) << defaults.error().text();
  EXPECT_EQ(defaults->materials[0].transmission, 0);
  EXPECT_EQ(defaults->materials[0].attenuation_distance_m, std::numeric_limits<float>::infinity());
  EXPECT_FALSE(has_transmission(*defaults));
}

// Raster techniques look up the picture behind: they take the file's thickness, and say that they are approximate.
TEST(GltfTransmission, RasterTechniquesReadThicknessToo) {
  const Json volume = {{"thicknessFactor", 0.5}, {"thicknessTexture", {{"index", 0}}}};
  GltfBuilder b = glass(textured, volume);
  b.json["extensionsRequired"] = {"KHR_materials_transmission"};
  const auto scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->materials[0].transmission_texture.image, 1);
  EXPECT_EQ(scene->materials[0].thickness_texture.image, 0);
  EXPECT_FALSE(scene->images[0].encoded.empty());
  EXPECT_FALSE(scene->images[1].encoded.empty());
  EXPECT_TRUE(has_transmission(*scene));
  for (const ExtensionUse& use : scene->extensions) {
    EXPECT_EQ(use.support, Support::approximated) << use.name;
    EXPECT_NE(use.consequence, "");
  }
}

TEST(GltfTransmission, BadValuesAreNamed) {
  const Json clear = {{"transmissionFactor", 1}};
  struct Case {
    Json transmission, volume, dispersion;
    const char* place;
  };
  for (const Case& c :
       {Case{{{"transmissionFactor", 1.5}},
             Json::object(),
             Json::object(),
             "KHR_materials_transmission/transmissionFactor"},
        Case{{{"transmissionFactor", -0.1}},
             Json::object(),
             Json::object(),
             "KHR_materials_transmission/transmissionFactor"},
        Case{{{"transmissionFactor", "all"}},
             Json::object(),
             Json::object(),
             "KHR_materials_transmission/transmissionFactor"},
        Case{clear, {{"thicknessFactor", -1}}, Json::object(), "KHR_materials_volume/thicknessFactor"},
        Case{clear, {{"attenuationDistance", 0}}, Json::object(), "KHR_materials_volume/attenuationDistance"},
        Case{clear, {{"attenuationDistance", -2}}, Json::object(), "KHR_materials_volume/attenuationDistance"},
        Case{clear, {{"attenuationColor", {1, 2, 0}}}, Json::object(), "KHR_materials_volume/attenuationColor"},
        Case{clear, {{"attenuationColor", {1, 1}}}, Json::object(), "KHR_materials_volume/attenuationColor"},
        Case{clear, Json::object(), {{"dispersion", -1}}, "KHR_materials_dispersion/dispersion"}})
    for (const LoadFor use : {LoadFor::raster, LoadFor::path_tracing}) {
      const auto scene = glass(c.transmission, c.volume, c.dispersion).load(use);
      ASSERT_FALSE(scene) << c.place;
      EXPECT_EQ(scene.error().kind, ErrorKind::input);
      EXPECT_NE(scene.error().text().find("test.glb: /materials/0/extensions/" + std::string(c.place)),
                std::string::npos)
          << scene.error().text();
    }
}

}  // namespace
}  // namespace candela::test::gltf_transmission
