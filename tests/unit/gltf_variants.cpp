// KHR_materials_variants: the chosen variant's materials, and what is refused.
#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace candela::test {
namespace {

GltfBuilder shoe() {
  GltfBuilder b;
  b.triangle();
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  b.use("KHR_materials_variants");
  b.json["materials"] = {{{"name", "white"}}, {{"name", "red"}}, {{"name", "bumpy"}}};
  b.json["images"] = {{{"uri", png_uri()}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["materials"][2]["normalTexture"] = {{"index", 0}};
  b.json["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "beach"}}, {{"name", "street"}}, {{"name", "bare"}}};
  primitive["material"] = 0;
  primitive["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                                   {{"material", 2}, {"variants", {1}}}};
  return b;
}

int material_of(const Expected<Scene>& scene) { return scene ? scene->meshes[0].sections[0].material : -2; }

TEST(GltfVariants, ChooseMaterials) {
  const GltfBuilder b = shoe();
  EXPECT_EQ(material_of(b.load()), 0);
  EXPECT_EQ(material_of(b.load({LoadFor::raster, "beach"})), 1);
  EXPECT_EQ(material_of(b.load({LoadFor::raster, "street"})), 2);
  EXPECT_EQ(material_of(b.load({LoadFor::raster, "bare"})), 0) << "a primitive that the variant does not name";
  EXPECT_EQ(b.load()->variants, (std::vector<std::string>{"beach", "street", "bare"}));
}

TEST(GltfVariants, AreSupportedByEveryRenderer) {
  GltfBuilder b = shoe();
  b.json["extensionsRequired"] = {"KHR_materials_variants"};
  for (const LoadFor use : {LoadFor::raster, LoadFor::path_tracing}) {
    const auto scene = b.load({use, "beach"});
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(scene->extensions.at(0).support, Support::supported);
    EXPECT_EQ(scene->variant, 0);
    EXPECT_EQ(material_of(scene), 1);
  }
  EXPECT_EQ(b.load()->variant, -1);
}

TEST(GltfVariants, UnknownNamesAndBrokenMappingsAreRefused) {
  const auto unknown = shoe().load({LoadFor::raster, "Beach"});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, ErrorKind::usage);
  EXPECT_NE(unknown.error().text().find("'Beach' is none of the file's variants: beach, street, bare"),
            std::string::npos)
      << unknown.error().text();
  GltfBuilder plain;
  plain.triangle();
  EXPECT_FALSE(plain.load({LoadFor::raster, "beach"}));
  const Json broken[] = {{{{"material", 9}, {"variants", {0}}}},
                         {{{"material", 1}, {"variants", {3}}}},
                         {{{"material", 1}, {"variants", {-1}}}},
                         {{{"variants", {0}}}},
                         {{{"material", 1}}},
                         {1},
                         7};
  for (const Json& mappings : broken) {
    GltfBuilder b = shoe();
    b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = mappings;
    const auto scene = b.load();
    ASSERT_FALSE(scene) << mappings.dump();
    EXPECT_EQ(scene.error().kind, ErrorKind::input);
    EXPECT_NE(scene.error().text().find("/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings"),
              std::string::npos)
        << scene.error().text();
  }
}

}  // namespace
}  // namespace candela::test
