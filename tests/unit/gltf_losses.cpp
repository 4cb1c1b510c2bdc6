#include "gltf/losses.h"

#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace candela::test {
namespace {

// What is drawn whole is no loss, whatever is wrong with the file.
TEST(GltfLosses, AreTextureSurfacesAndLights) {
  const auto loss = [](const GltfBuilder& b) {
    const Expected<Scene> scene = b.load();
    EXPECT_TRUE(scene && !scene->warnings.empty());
    return scene && std::ranges::any_of(scene->warnings, tells_of_loss);
  };
  GltfBuilder whole;
  whole.triangle();
  whole.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
  EXPECT_FALSE(loss(whole));
  whole.json["scenes"][0]["nodes"] = {0, 0};
  EXPECT_FALSE(loss(whole));
  GltfBuilder texture;
  texture.triangle();
  texture.json["meshes"][0]["primitives"][0]["material"] = 0;
  texture.json["materials"] = {{{"emissiveTexture", {{"index", 3}}}}};
  EXPECT_TRUE(loss(texture));
  GltfBuilder surface;
  surface.triangle();
  surface.json["meshes"][0]["primitives"].push_back({{"attributes", Json::object()}});
  EXPECT_TRUE(loss(surface));
}

}  // namespace
}  // namespace candela::test
