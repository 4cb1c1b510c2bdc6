#include "reference_fixture.h"
#include "testscenes/procedural_textures.h"

// Where texels lie, how coordinates wrap and turn, and what the channels of a material's textures mean.
namespace candela::reference::test {
namespace {

// 4x2 texels; red counts columns, green rows.
Texture small_texture() {
  DecodedImage image{4, 2, DecodedImage::Format::rgba32f, 4, {}};
  image.pixels.resize(4 * 2 * 16);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      const float texel[4] = {float(x), float(y), 0, 1};
      std::memcpy(image.pixels.data() + size_t(y * 4 + x) * 16, texel, 16);
    }
  return Texture(std::move(image), false);
}

int add_texel(GltfBuilder& b, glm::dvec3 codes) {
  const auto png = png_from(1, 1, 3, [&](double, double) { return glm::dvec4(codes / 255.0, 1); });
  std::vector<uint8_t> bytes(png.size());
  std::memcpy(bytes.data(), png.data(), png.size());
  b.json["images"].push_back({{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}});
  b.json["textures"].push_back({{"source", b.json["images"].size() - 1}});
  return int(b.json["textures"].size()) - 1;
}

// The surface of a square's middle as the camera in front of it sees it.
Surface seen_surface(const GltfBuilder& b, glm::dvec3 eye = {0, 0, 4}) {
  TestCamera camera;
  camera.eye = eye;
  const auto t = make_world(b, camera);
  const CameraRay ray = t->world->camera_ray({8, 8}, 16, 16);
  const auto hit = t->world->accel().closest(rounded(ray));
  EXPECT_TRUE(hit);
  return hit ? t->world->surface(*hit, ray.origin, ray.direction) : Surface{};
}

}  // namespace

TEST(Textures, TexelsLieWhereTheirCoordinatesSay) {
  const Texture texture = small_texture();
  Sampler linear, nearest;
  nearest.mag = Filter::nearest;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      const glm::dvec2 centre((x + 0.5) / 4, (y + 0.5) / 2);
      for (const Sampler& sampler : {linear, nearest}) {
        const glm::dvec4 c = texture.sample(centre, sampler);
        EXPECT_EQ(c, glm::dvec4(x, y, 0, 1));
      }
      // Anywhere in its cell, nearest shows the texel alone.
      EXPECT_EQ(texture.sample(centre + glm::dvec2(0.12, -0.24), nearest), glm::dvec4(x, y, 0, 1));
    }
  // A quarter of the way to the next texel is a quarter of it.
  EXPECT_NEAR(texture.sample({(1.5 + 0.25) / 4, 0.5 / 2}, linear).x, 1.25, 1e-12);
  EXPECT_NEAR(texture.sample({1.5 / 4, (0.5 + 0.75) / 2}, linear).y, 0.75, 1e-12);
}

TEST(Textures, CoordinatesWrap) {
  const Texture texture = small_texture();
  Sampler sampler;
  sampler.mag = Filter::nearest;
  const auto columns = [&](Wrap wrap) {
    sampler.wrap_u = wrap;
    std::string text;
    for (int x = -5; x < 9; ++x) text += std::to_string(int(texture.sample({(x + 0.5) / 4, 0.25}, sampler).x));
    return text;
  };
  EXPECT_EQ(columns(Wrap::repeat), "30123012301230");
  EXPECT_EQ(columns(Wrap::mirror), "33210012332100");
  EXPECT_EQ(columns(Wrap::clamp), "00000012333333");
}

// KHR_texture_transform: scale, then a turn counter-clockwise where v points down, then the offset.
TEST(Textures, TransformsTurnAsTheSpecificationSays) {
  TextureSlot slot;
  slot.scale = {2, 3}, slot.offset = {0.125f, 0.25f}, slot.rotation_rad = float(std::numbers::pi / 2);
  const glm::dvec2 uv = transformed_uv(slot, {0.5, 0.25});
  EXPECT_NEAR(uv.x, 0.75 + 0.125, 1e-6);
  EXPECT_NEAR(uv.y, -1 + 0.25, 1e-6);
}

TEST(Textures, ChannelsOfAMaterial) {
  const glm::dvec3 codes(51, 90, 200);
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json pbr = base_color(0.8, 0.4, 0.2);
  pbr["metallicFactor"] = 0.5, pbr["roughnessFactor"] = 0.75;
  const int texture = add_texel(b, codes);
  pbr["metallicRoughnessTexture"] = {{"index", texture}};
  const Json material = {{"pbrMetallicRoughness", pbr},
                         {"occlusionTexture", {{"index", texture}, {"strength", 0.25}}},
                         {"emissiveTexture", {{"index", add_texel(b, {255, 0, 255})}}},
                         {"emissiveFactor", {0.25, 0.5, 1}}};
  const int square = add_square_mesh(b, 1, add_material(b, material));
  b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      b.accessor<float>("VEC2", {0, 1, 1, 1, 1, 0, 0, 0});
  add_node(b, {{"mesh", square}});
  const Surface s = seen_surface(b);
  EXPECT_NEAR(s.roughness, 0.75 * 90 / 255, 1e-6);
  EXPECT_NEAR(s.metallic, 0.5 * 200 / 255, 1e-6);
  EXPECT_NEAR(s.occlusion, 0.8, 1e-6);
  EXPECT_EQ(s.emission, glm::dvec3(0.25, 0, 1));
  EXPECT_EQ(s.dielectric_f90, 1);
  EXPECT_NEAR(s.dielectric_f0.x, 0.04, 1e-7);
}

// The sky's light on a hollow is weaker by what the occlusion texture says.
TEST(Textures, OcclusionWeakensTheSky) {
  double mean[2] = {};
  for (const bool occluded : {false, true}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = diffuse_material(1, 1, 1);
    if (occluded) material["occlusionTexture"] = {{"index", add_texel(b, {51, 0, 0})}, {"strength", 0.25}};
    const int square = add_square_mesh(b, 4, add_material(b, material));
    b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
        b.accessor<float>("VEC2", {0, 1, 1, 1, 1, 0, 0, 0});
    add_node(b, {{"mesh", square}});
    const TestCamera camera{.yfov_deg = 20, .width = 4, .height = 4};
    const auto t = make_world(b, camera, Sky::constant(glm::dvec3(1)));
    mean[occluded] = mean_of(traced(*t, centred(), camera, 1024)).mean;
  }
  EXPECT_NEAR(mean[0], 1, 0.008) << "traced, under a sky of radiance 1";
  EXPECT_NEAR(mean[1] / mean[0], 0.8, 1e-3);
}

// glTF 2.0, 3.9.6: the normal turns over on the back of a double-sided surface.
TEST(Textures, NormalsFaceTheViewer) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = diffuse_material(0.5, 0.5, 0.5);
  material["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
  EXPECT_EQ(seen_surface(b).normal, glm::dvec3(0, 0, 1));
  EXPECT_EQ(seen_surface(b, {0, 0, -4}).normal, glm::dvec3(0, 0, -1));
}

// glTF 2.0, 3.9.4: what is at least the cutoff is solid.
TEST(Textures, AMaskKeepsWhatEqualsItsCutoff) {
  for (const double alpha : {0.375, 0.374}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = diffuse_material(0.5, 0.5, 0.5);
    material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
    material["alphaMode"] = "MASK", material["alphaCutoff"] = 0.375;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
    EXPECT_EQ(seen_surface(b).coverage, alpha < 0.375 ? 0 : 1);
  }
}

}  // namespace candela::reference::test
