#include <numbers>

#include "base/rng.h"
#include "textured_square.h"

// What each texture of a material means, against the same material without it or against its own arithmetic.
namespace candela::test::frame_material_textures {
namespace {

double srgb_decode(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

}  // namespace

class FrameMaterialTextures : public FrameTest {
 protected:
  static GltfBuilder scene_of(const Json& material) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
    return b;
  }
  static Job front_view(const GltfBuilder& b, int size_px = 16) {
    Job job = job_for(write(b), size_px, size_px);
    job.layers = {"normal", "ambient_diffuse", "emission"};
    look(job, {0, 0, 3}, {0, 0, 0}, 20);
    return job;
  }
  // The square fills the picture exactly.
  static void add_camera_of_the_square(GltfBuilder& b) {
    b.json["cameras"] = {
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1.0}, {"ymag", 1.0}, {"znear", 0.5}, {"zfar", 20.0}}}}};
    add_node(b, {{"camera", 0}, {"translation", {0, 0, 2}}});
  }
};

// Green is roughness, blue is metal, red is neither: the picture is that of the same numbers as factors.
TEST_F(FrameMaterialTextures, RoughnessIsGreenAndMetalIsBlue) {
  const glm::dvec3 codes(40, 90, 200);
  std::vector<glm::vec4> pictures[2];
  for (const bool textured : {false, true}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json pbr = base_color(0.8, 0.4, 0.2);
    pbr["roughnessFactor"] = textured ? 1 : codes.y / 255;
    pbr["metallicFactor"] = textured ? 1 : codes.z / 255;
    if (textured) pbr["metallicRoughnessTexture"] = {{"index", add_texel(b, codes)}};
    add_node(b, {{"mesh", add_textured_square(b, add_material(b, {{"pbrMetallicRoughness", pbr}}))}});
    add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {-0.5, 0.3, 2}}});
    pictures[textured] = images_of(front_view(b))["beauty"].values<glm::vec4>();
  }
  for (size_t i = 0; i < pictures[0].size(); ++i)
    for (int c = 0; c < 3; ++c) {
      ASSERT_GT(pictures[0][i][c], 0.01f);
      ASSERT_NEAR(pictures[1][i][c], pictures[0][i][c], 1e-5 * pictures[0][i][c]) << i;
    }
}

TEST_F(FrameMaterialTextures, TheNormalTextureHasItsScale) {
  const glm::dvec3 codes(180, 90, 220);
  for (const double scale : {1.0, 0.25, 2.0}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = diffuse_material(0.5, 0.5, 0.5);
    material["normalTexture"] = {{"index", add_texel(b, codes)}, {"scale", scale}};
    add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
    const Images images = images_of(front_view(b));
    const glm::dvec3 wanted = glm::normalize((codes / 255.0 * 2.0 - 1.0) * glm::dvec3(scale, scale, 1));
    EXPECT_LT(glm::length(glm::dvec3(images["normal"].at<glm::vec4>(8, 8)) - wanted), 2e-6) << scale;
  }
}

// Occlusion weakens ambient light by 1 + strength (red - 1), alone or in one texture with roughness and metal. The
// neutral light's lamp is none of it.
TEST_F(FrameMaterialTextures, OcclusionHasItsStrength) {
  const glm::dvec3 codes(51, 255, 255);  // a fifth
  for (const bool shared : {false, true}) {
    std::vector<glm::vec4> pictures[2];
    for (const bool occluded : {false, true}) {
      GltfBuilder b = empty_scene();
      use_materials(b);
      Json pbr = {{"baseColorFactor", {0.8, 0.4, 0.2, 1.0}}, {"metallicFactor", 0.0}};
      const int texture = add_texel(b, codes);
      if (shared) {
        pbr["metallicRoughnessTexture"] = {{"index", texture}};
      }
      Json material = {{"pbrMetallicRoughness", pbr}};
      if (occluded)
        material["occlusionTexture"] = {{"index", shared ? texture : add_texel(b, codes)}, {"strength", 0.25}};
      add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
      pictures[occluded] = images_of(front_view(b))["ambient_diffuse"].values<glm::vec4>();
    }
    for (size_t i = 0; i < pictures[0].size(); ++i)
      for (int c = 0; c < 3; ++c) {
        ASSERT_GT(pictures[0][i][c], 0.01f);
        ASSERT_NEAR(pictures[1][i][c], 0.8 * pictures[0][i][c], 1e-5 * pictures[0][i][c]) << i << " shared " << shared;
      }
  }
}

// Emission is the factor times the decoded texture.
TEST_F(FrameMaterialTextures, EmissionIsItsFactorTimesItsTexture) {
  const glm::dvec3 codes(255, 128, 40), factor(0.5, 1, 0.25);
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = diffuse_material(0, 0, 0);
  material["emissiveTexture"] = {{"index", add_texel(b, codes)}};
  material["emissiveFactor"] = {factor.x, factor.y, factor.z};
  add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
  const Images images = images_of(front_view(b));
  for (const char* layer : {"beauty", "emission"})
    for (int c = 0; c < 3; ++c) {
      const float e = images[layer].at<glm::vec4>(8, 8)[c];  // Vulkan allows 0.6 of a code value
      EXPECT_GE(e, factor[c] * srgb_decode((codes[c] - 0.6) / 255)) << layer;
      EXPECT_LE(e, factor[c] * srgb_decode((codes[c] + 0.6) / 255)) << layer;
    }
}

// Each texture reads its own set of coordinates.
TEST_F(FrameMaterialTextures, TheSecondSetOfCoordinates) {
  const auto halves = [](double u, double) { return u < 0.5 ? glm::dvec4(1, 0, 0, 1) : glm::dvec4(0, 1, 0, 1); };
  for (const int set : {0, 1}) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = unlit_material(1, 1, 1);
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", add_texture(b, png_from(2, 1, 3, halves))},
                                                            {"texCoord", set}};
    const int square = add_textured_square(b, add_material(b, material));
    Json& attributes = b.json["meshes"][size_t(square)]["primitives"][0]["attributes"];
    attributes["TEXCOORD_0"] = b.accessor<float>("VEC2", {0.25, 0, 0.25, 0, 0.25, 0, 0.25, 0});
    attributes["TEXCOORD_1"] = b.accessor<float>("VEC2", {0.75, 0, 0.75, 0, 0.75, 0, 0.75, 0});
    add_node(b, {{"mesh", square}});
    const Images images = images_of(front_view(b));
    EXPECT_EQ(images["beauty"].at<glm::vec4>(8, 8), set == 0 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 1, 0, 1));
  }
}

// At one texel a pixel the texture itself is shown, at two the mean of four texels: the level follows the footprint,
// and no bias of half a level or more blurs or sharpens (MipLevelsChangeHalfWay: smaller ones). Texels of neighbouring
// levels differ by 0.2 on the average.
TEST_F(FrameMaterialTextures, MipLevelsFollowTheFootprint) {
  constexpr int texels = 64;
  Rng rng(7);
  std::vector<glm::dvec3> codes(texels * texels);
  for (glm::dvec3& c : codes)
    for (int k = 0; k < 3; ++k) c[k] = std::floor(rng.uniform() * 256);
  const auto code = [&](double u, double v) {
    return glm::dvec4(codes[size_t(int(v * texels) * texels + int(u * texels))] / 255.0, 1);
  };
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = unlit_material(1, 1, 1);
  material["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", add_texture(b, png_from(texels, texels, 3, code), linear_mipmap_linear)}};
  add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
  add_camera_of_the_square(b);
  for (const int step : {1, 2}) {
    const int size = texels / step;
    const Images images = images_of(job_for(write(b), size, size));
    double sum = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        glm::dvec3 wanted(0);
        for (int j = 0; j < step; ++j)
          for (int i = 0; i < step; ++i)
            for (int k = 0; k < 3; ++k)
              wanted[k] += srgb_decode(codes[size_t((y * step + j) * texels + x * step + i)][k] / 255) / (step * step);
        const glm::dvec3 p(images["beauty"].at<glm::vec4>(x, y));
        sum += (std::abs(p.x - wanted.x) + std::abs(p.y - wanted.y) + std::abs(p.z - wanted.z)) / 3;
      }
    EXPECT_LT(sum / (size * size), 0.01) << step << " texels a pixel";
  }
}

// The nearest level changes at half a level, here between 2^0.4 and 2^0.6 texels a pixel: a bias of 0.1 either way
// shows. (Between whole levels a device may mix as it likes: lavapipe takes the nearer one alone for half of the way.)
TEST_F(FrameMaterialTextures, MipLevelsChangeHalfWay) {
  constexpr int texels = 64;
  const auto checks = [](double u, double v) {  // the level above is 0.5 all over
    return (int(u * texels) + int(v * texels)) % 2 == 0 ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(1);
  };
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = unlit_material(1, 1, 1);
  material["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", add_texture(b, png_from(texels, texels, 3, checks), nearest_mipmap_nearest)}};
  add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
  add_camera_of_the_square(b);
  for (const int size : {48, 42}) {
    const bool finest = std::log2(double(texels) / size) < 0.5;
    for (const glm::vec4& p : images_of(job_for(write(b), size, size))["beauty"].values<glm::vec4>()) {
      const double from_half = std::abs(double(p.x) - 0.5);
      if (finest) {
        ASSERT_EQ(from_half, 0.5) << size;
      } else {
        ASSERT_LT(from_half, 0.01) << size;
      }
    }
  }
}

}  // namespace candela::test::frame_material_textures
