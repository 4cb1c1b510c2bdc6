// Bloom in whole frames: what it is made of.
#include <fstream>

#include "frame_fixture.h"
#include "look/look.h"
#include "reference/bloom.h"
#include "render/outputs.h"

namespace candela::test {

class FrameBloom : public FrameTest {
 protected:
  static constexpr int width = 64, height = 48;
  // A white wall under a strong lamp, and before it a dim square that emits.
  static Job wall(const std::string& bloom, double emitted = 1) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json white = {{"pbrMetallicRoughness", base_color(1, 1, 1)}};
    Json glowing = {{"pbrMetallicRoughness", base_color(0, 0, 0)}};
    if (emitted > 0) glowing["emissiveFactor"] = {emitted, 0.5 * emitted, 0};
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, white))}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.3f, add_material(b, glowing))}, {"translation", {0.4, 0.1, 0.5}}});
    add_light(b, {{"type", "point"}, {"intensity", 900.0}}, {{"translation", {-0.5, 0.2, 2}}});
    Job job = job_for(write(b), width, height, 4);
    job.look = look_file("{\"bloom\": " + bloom + "}");
    look(job, {0, 0, 3}, {0, 0, 0}, 50);
    return job;
  }
  static std::vector<glm::dvec3> in_double(const std::vector<glm::vec4>& texels) {
    std::vector<glm::dvec3> out;
    for (const glm::vec4& t : texels) out.emplace_back(t);
    return out;
  }
};

// With `emission` the glow is that of the emission layer, and beauty is what it was with that added; the lamp's light
// on the wall, a hundred times as bright, adds nothing.
TEST_F(FrameBloom, OfEmissionIsTheGlowOfThatLayer) {
  const std::string weights = R"("strength": 0.5, "weights": [1, 1, 1], "beauty": true, )";
  for (const bool keeps : {false, true}) {
    Job job = wall("{" + weights + R"("emission": true, "keeps": )" + (keeps ? "true}" : "false}"));
    job.settings = {{"bloom", "levels", "0"}};
    job.layers = {"bloom", "emission"};
    const Images images = images_of(job);
    Job bare = job;
    bare.look.clear();
    bare.layers.clear();
    bare.settings.clear();
    const auto beauty = in_double(images["beauty"].values<glm::vec4>()),
               before = in_double(images_of(bare)["beauty"].values<glm::vec4>()),
               emission = in_double(images["emission"].values<glm::vec4>()),
               glow = in_double(images["bloom"].values<glm::vec4>());
    const Bloom model{.strength = 0.5, .weights = {1, 1, 1}, .keeps = keeps};
    const auto exact = reference::bloom_glow(emission, width, height, model, 1);
    double brightest = 0;
    for (size_t i = 0; i < beauty.size(); ++i) {
      EXPECT_LT(glm::distance(glow[i], exact[i]), 5e-5) << i;
      const glm::dvec3 expected = before[i] + 0.5 * (exact[i] - (keeps ? emission[i] : glm::dvec3(0)));
      EXPECT_LT(glm::distance(beauty[i], expected), 5e-5 * (1 + glm::length(before[i]))) << i;
      brightest = std::max(brightest, glow[i].x);
    }
    EXPECT_GT(brightest, 0.1);
    EXPECT_LT(brightest, 1);
  }
}

// Files hold scattered light as the scene has it, however bright the picture is made.
TEST_F(FrameBloom, TheLayerDoesNotCarryTheExposure) {
  Job job = wall(R"({"strength": 0.5, "beauty": true})");
  job.layers = {"bloom"};
  job.exr_float = true;
  std::vector<std::vector<float>> glows;
  for (const float ev : {0.0f, 3.0f}) {
    job.exposure_ev = ev;
    const auto session = open(job);
    NonFinite nonfinite;
    const FloatImage image = linear_image(render(*session), job, *session, std::nullopt, FrameRate{}, nonfinite);
    const auto red = std::ranges::find(image.channels, std::string("bloom.R"), &Channel::name);
    ASSERT_NE(red, image.channels.end());
    glows.push_back(red->f);
  }
  for (size_t i = 0; i < glows[0].size(); ++i) EXPECT_NEAR(glows[1][i], glows[0][i], 1e-3f * glows[0][i] + 1e-6f) << i;
  EXPECT_GT(*std::ranges::max_element(glows[0]), 0.1f);
}

// Where nothing emits, nothing glows.
TEST_F(FrameBloom, OfEmissionIsNothingWithoutAny) {
  Job job = wall(R"({"strength": 0.5, "beauty": true, "emission": true})", 0);
  Job bare = job;
  bare.look.clear();
  EXPECT_TRUE(images_of(job)["beauty"] == images_of(bare)["beauty"]);
}

}  // namespace candela::test
