// Beauty by its terms: their sum, known values of single ones, and that asking for them changes no bit of beauty.
#include <numbers>

#include "frame_fixture.h"
#include "passes/surfaces/terms.h"
#include "render/reference_frame.h"

namespace candela::test::frame_terms {
namespace {

constexpr int width = 48, height = 36;

std::vector<std::string> term_names() {
  std::vector<std::string> names;
  for (const LayerName& term : Terms::layers) names.emplace_back(term.name);
  return names;
}

Json covering(Json material, const char* mode, double alpha) {
  material["alphaMode"] = mode;
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
  material["doubleSided"] = true;
  return material;
}

// Lights of each kind over opaque, masked, blended, emitting and unlit surfaces that overlap one another.
GltfBuilder everything() {
  GltfBuilder b = empty_scene();
  Json glossy = {{"pbrMetallicRoughness", base_color(0.6, 0.5, 0.4)}};
  glossy["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  glossy["pbrMetallicRoughness"]["roughnessFactor"] = 0.35;
  const auto add_square = [&](const Json& material, glm::dvec3 at, float half) {
    add_node(b, {{"mesh", add_square_mesh(b, half, add_material(b, material))}, {"translation", {at.x, at.y, at.z}}});
  };
  add_square(glossy, {0, 0, 0}, 1.5f);
  Json emitting = diffuse_material(0.2, 0.2, 0.3);
  emitting["emissiveFactor"] = {1, 0.5, 0.25};
  add_square(emitting, {-0.7, -0.6, 0.4}, 0.4f);
  add_square(covering(diffuse_material(0.2, 0.9, 0.2), "BLEND", 0.4), {0.5, 0.2, 0.9}, 0.6f);
  add_square(covering(unlit_material(0.9, 0.2, 0.2), "BLEND", 0.3), {0.2, 0.6, 1.2}, 0.5f);
  Json lamp_behind_glass = covering(diffuse_material(0.1, 0.1, 0.1), "BLEND", 0.6);
  lamp_behind_glass["emissiveFactor"] = {0.3, 0.6, 0.9};
  add_square(lamp_behind_glass, {1.4, 0.9, 0.6}, 0.5f);
  add_square(covering(diffuse_material(0.9, 0.9, 0.2), "MASK", 0.7), {-0.5, 0.7, 0.5}, 0.4f);
  add_square(covering(diffuse_material(0.9, 0.9, 0.2), "MASK", 0.3), {-0.3, 0.5, 0.7}, 0.4f);
  add_square(unlit_material(0.1, 0.3, 0.9), {0.8, -0.9, 0.3}, 0.4f);
  add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {1.2, 0.5, 2}}});
  add_light(b, {{"type", "point"}, {"intensity", 3.0}, {"range", 1.5}}, {{"translation", {-1.2, -0.5, 1}}});
  add_light(b, {{"type", "spot"}, {"intensity", 30.0}, {"spot", {{"outerConeAngle", 0.6}}}},
            {{"translation", {-1, 0.2, 2}}});
  add_light(b, {{"type", "directional"}, {"intensity", 2.0}, {"color", {1, 0.8, 0.6}}}, {{"translation", {0, 0, 3}}});
  return b;
}
Job job_of_everything(const std::string& file, int samples, Job job = {}) {
  job.scene = file;
  job.width_px = width, job.height_px = height, job.samples = samples;
  job.tonemap = "none";
  job.camera.eye = glm::dvec3(0.4, -3, 4), job.camera.target = glm::dvec3(0, 0, 0), job.camera.yfov_deg = 45;
  return job;
}

}  // namespace

class FrameTerms : public FrameTest {
 protected:
  // The sum of the terms against beauty, within rounding: each of the sums that a pixel is made of - lights, blended
  // layers, samples - may round once for each of its parts, in beauty and in the terms.
  static void expect_sum(const Images& images, int parts, int least_lit) {
    const double rounding = 2 * parts * 0x1p-24;
    const std::vector<glm::vec4> beauty = images["beauty"].values<glm::vec4>();
    std::vector<std::vector<glm::vec4>> terms;
    for (const std::string& name : term_names()) terms.push_back(images[name].values<glm::vec4>());
    int lit = 0;
    for (size_t i = 0; i < beauty.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        double sum = 0, size = 0;
        for (const auto& term : terms) {
          sum += double(term[i][c]);
          size += std::abs(double(term[i][c]));
        }
        ASSERT_NEAR(sum, beauty[i][c], rounding * size) << "pixel " << i << ", channel " << c;
      }
      lit += beauty[i].x > 0;
    }
    EXPECT_GE(lit, least_lit);
  }
};

TEST_F(FrameTerms, SumToBeautyAndChangeNoBitOfIt) {
  const std::string file = write(everything());
  for (const int samples : {1, 4})
    for (const char* background : {"transparent", "0.2,0.3,0.5"})
      for (const auto& [technique, exposure, transparency] :
           {std::tuple("clustered", 0.0f, "sorted"), {"brute-force", 3.0f, "layers"}}) {
        SCOPED_TRACE(fmt::format("{} samples, background {}, {}, {}", samples, background, technique, transparency));
        Job job = job_of_everything(file, samples);
        job.background = background, job.technique = technique, job.exposure_ev = exposure;
        job.transparency = transparency;
        const Images alone = images_of(job);
        job.layers = term_names();
        const Images divided = images_of(job);
        ASSERT_EQ(divided.size(), 1 + size_t(term_count));
        EXPECT_TRUE(alone["beauty"] == divided["beauty"]);
        // Four lights, emission and ambient; up to four blended layers of three operations each; the samples.
        expect_sum(divided, 6 + 12 + samples + 4, width * height / 3);
        for (const std::string name : {"direct_sun", "direct_point", "direct_spot", "emission"}) {
          size_t lit = 0;
          for (const glm::vec4& v : divided[name].values<glm::vec4>()) lit += v.x > 0;
          EXPECT_GT(lit, 40u) << name;
        }
      }
}

// Keys of triangles tell depths of other last bits than the hardware's, which draws the terms.
TEST_F(FrameTerms, AreOfWhatKeysOfTrianglesShow) {
  for (const char* technique : {"visibility", "ray"}) {
    SCOPED_TRACE(technique);
    Job job = job_of_everything(write(everything()), 4);
    job.technique = technique;
    const Images alone = images_of(job);
    job.layers = term_names();
    job.layers.push_back("crypto_object");
    const Images divided = images_of(job);
    EXPECT_TRUE(alone["beauty"] == divided["beauty"]);
    const std::vector<glm::vec4> beauty = divided["beauty"].values<glm::vec4>();
    std::vector<glm::dvec3> sum(beauty.size());
    for (const std::string& name : term_names()) {
      const std::vector<glm::vec4> term = divided[name].values<glm::vec4>();
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += glm::dvec3(term[i]);
    }
    double all = 0, off = 0, covered = 0;
    for (size_t i = 0; i < sum.size(); ++i)
      all += glm::length(glm::dvec3(beauty[i])), off += glm::length(glm::dvec3(beauty[i]) - sum[i]);
    EXPECT_LT(off, 0.01 * all);
    // Coverage by what is known, in green the largest.
    for (const glm::vec4& matte : divided["crypto_object"].values<glm::vec4>()) covered += double(matte.y + matte.w);
    EXPECT_GT(covered, 0.3 * double(sum.size()));
  }
}

// A supersampled frame divides each of its pictures.
TEST_F(FrameTerms, SumToASupersampledBeauty) {
  Job job = job_of_everything(write(everything()), 0);
  job.background = "0.2,0.3,0.5";
  // Every pixel is lit but those in the shadow of all lamps.
  for (const auto& [technique, lamps, least_lit] : {std::tuple("clustered", "0", width * height),
                                                    {"clustered", "256", width * height * 9 / 10},
                                                    {"forward-plus", "256", width * height * 9 / 10}}) {
    job.technique = technique;
    job.settings = {{"supersample", "n", "2"}, {"local", "lights", lamps}};
    job.layers.clear();
    const Images alone = images_of(job);
    job.layers = term_names();
    const Images divided = images_of(job);
    EXPECT_TRUE(alone["beauty"] == divided["beauty"]);
    expect_sum(divided, 6 + 12 + 4 + 4, least_lit);
  }
}

// Ambient light, of the neutral light that scenes without any get, and every generated scene with what it has.
TEST_F(FrameTerms, SumToBeautyInGeneratedScenes) {
  for (const std::string& name : scene_names()) {
    SCOPED_TRACE(name);
    for (const int samples : {1, 4}) {
      Job job = job_for(scene(name), 64, 36, samples);
      const Images alone = images_of(job, {}, 0.4);
      job.layers = term_names();
      const Images divided = images_of(job, {}, 0.4);
      EXPECT_TRUE(alone["beauty"] == divided["beauty"]);
      const auto frame = open_reference(job, 0.4, {});
      ASSERT_TRUE(frame);
      const int lights = int((*frame)->world->punctual_lights().size());
      expect_sum(divided, lights + 32, 20);
    }
  }
}

// Where blended surfaces alone are drawn there is no depth to be equal to, and where nothing is, all is background.
TEST_F(FrameTerms, NeedNoOpaqueSurface) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, covering(unlit_material(0, 1, 0.5), "BLEND", 0.25)))}});
  Job job = job_for(write(b), 16, 9, 4);
  look(job, {0, 0, 2}, {0, 0, 0});
  job.background = "2,4,8", job.layers = term_names();
  const Images blended = images_of(job);
  expect_sum(blended, 16, 16 * 9);
  EXPECT_EQ(blended["emission"].at<glm::vec4>(8, 4), glm::vec4(0, 0.25, 0.125, 0.25));
  EXPECT_EQ(blended["background"].at<glm::vec4>(8, 4), glm::vec4(1.5, 3, 6, 1));
  look(job, {0, 0, 2}, {0, 0, 4});
  const Images nothing = images_of(job);
  EXPECT_EQ(nothing["background"].at<glm::vec4>(8, 4), glm::vec4(2, 4, 8, 1));
  EXPECT_TRUE(nothing["background"].bytes == nothing["beauty"].bytes);
}

// Each kind of light over a diffuse plane that faces it, by its closed form, in the term of its kind alone.
TEST_F(FrameTerms, KindsOfLightAreKeptApart) {
  const glm::dvec3 albedo(0.8, 0.4, 0.2);
  const std::pair<Json, std::string> kinds[] = {
      {{{"type", "directional"}, {"intensity", 3.0}}, "direct_sun"},
      {{{"type", "point"}, {"intensity", 12.0}}, "direct_point"},
      {{{"type", "spot"}, {"intensity", 12.0}, {"spot", {{"outerConeAngle", 0.5}}}}, "direct_spot"}};
  for (const auto& [light, term] : kinds) {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(albedo.x, albedo.y, albedo.z)))}});
    add_light(b, light, {{"translation", {0, 0, 2}}});
    Job job = job_for(write(b), 17, 9, 1);
    look(job, {0, 0, 4}, {0, 0, 0}, 5);
    job.layers = term_names();
    job.settings = {{"lights", "floor_lux", "0"}};
    const Images images = images_of(job);
    for (const std::string& name : term_names()) {
      const glm::vec4 middle = images[name].at<glm::vec4>(8, 4);
      for (int c = 0; c < 3; ++c)
        if (name == term)
          EXPECT_NEAR(middle[c], 3 * albedo[c] / std::numbers::pi, 2e-5) << name;
        else
          EXPECT_EQ(middle[c], 0) << name;
    }
  }
}

// Layers are free of each other: one asked for alone has the bytes that it has among all.
TEST_F(FrameTerms, OneAloneIsTheOneAmongAll) {
  Job job = job_of_everything(write(everything()), 4);
  job.background = "0.2,0.3,0.5", job.layers = term_names();
  const Images all = images_of(job);
  for (const std::string& name : term_names()) {
    job.layers = {name};
    EXPECT_TRUE(images_of(job)[name] == all[name]) << name;
  }
}

}  // namespace candela::test::frame_terms
