#include "../unit/reference_fixture.h"
#include "frame_fixture.h"

// Ambient occlusion in whole frames.
namespace candela::test::frame_occlusion {
namespace {

constexpr int width = 96, height = 64;

}  // namespace

class FrameOcclusion : public FrameTest {
 protected:
  // Squares of half size 2 that make the corner of a room at `origin`, and a ball of radius 0.4 in it. No light: the
  // neutral one, which has an ambient part.
  static GltfBuilder room(glm::dvec3 origin = glm::dvec3(0), Json material = diffuse_material(0.8, 0.7, 0.6)) {
    GltfBuilder b = empty_scene();
    const int number = add_material(b, std::move(material)), square = add_square_mesh(b, 2, number);
    const double h = std::sqrt(0.5);
    const auto add = [&](int mesh, glm::dvec3 at, const Json& turn) {
      at += origin;
      add_node(b, {{"mesh", mesh}, {"translation", {at.x, at.y, at.z}}, {"rotation", turn}});
    };
    add(square, {0, 0, 0}, {-h, 0, 0, h});  // floor: normal +y
    add(square, {0, 2, -2}, {0, 0, 0, 1});  // back: normal +z
    add(square, {-2, 2, 0}, {0, h, 0, h});  // left: normal +x
    add(reference::test::add_sphere_mesh(b, 0.4, number, 24), {0.3, 0.4, -0.8}, {0, 0, 0, 1});
    return b;
  }
  static Job seen(const std::string& path, int samples = 1, glm::dvec3 origin = glm::dvec3(0)) {
    Job job = job_for(path, width, height, samples);
    look(job, origin + glm::dvec3(1.5, 1.6, 2.6), origin + glm::dvec3(-0.4, 0.6, -1), 45);
    return job;
  }
  static void expect_shares(const std::vector<float>& values, const std::string& what) {
    for (const float v : values) ASSERT_TRUE(v >= 0 && v <= 1) << what << ": " << v;
  }
  static double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float v : values) sum += double(v) / double(values.size());
    return sum;
  }
};

// Diffuse ambient light is multiplied by the layer, reflections by less, all other light by 1.
TEST_F(FrameOcclusion, OnlyAmbientLightIsHidden) {
  const std::string path = write(room());
  Job job = seen(path);
  job.layers = {"occlusion", "ambient_diffuse", "ambient_specular", "direct_sun"};
  job.settings = {{"occlusion", "method", "screen"}};  // rays know where the sky is bright
  const Images with = images_of(job);
  job.effects = "none";
  job.layers = {"ambient_diffuse", "ambient_specular", "direct_sun"};
  const Images bare = images_of(job);
  EXPECT_EQ(with["direct_sun"], bare["direct_sun"]);
  int darkened = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float open = with["occlusion"].at<float>(x, y);
      const float before = bare["ambient_diffuse"].at<glm::vec4>(x, y).x;
      EXPECT_NEAR(with["ambient_diffuse"].at<glm::vec4>(x, y).x, open * before, 1e-4f * before) << x << "," << y;
      EXPECT_LE(with["ambient_specular"].at<glm::vec4>(x, y).x,
                bare["ambient_specular"].at<glm::vec4>(x, y).x * 1.0001f);
      darkened += open < 0.8f;
    }
  EXPECT_GT(darkened, width * height / 50);
  EXPECT_LT(darkened, width * height / 2);
}

// Bytes of frames that have no ambient light, or no opaque surface, are those without the effect.
TEST_F(FrameOcclusion, ChangesNothingElse) {
  GltfBuilder lit = room();
  add_light(lit, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {1, 2, 1}}});
  Json glassy = diffuse_material(0.8, 0.7, 0.6);
  glassy["alphaMode"] = "BLEND";
  glassy["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
  for (const GltfBuilder& b : {lit, room(glm::dvec3(0), glassy), room(glm::dvec3(0), unlit_material(0.5, 0.5, 0.5))}) {
    Job job = seen(write(b), 4);
    job.effects = "occlusion";  // the lamp's shadows are another effect
    const Images with = images_of(job);
    job.effects = "none";
    EXPECT_EQ(with["beauty"], images_of(job)["beauty"]);
  }
  // Quality draft has it only by name.
  Job job = seen(write(room()));
  job.quality = "draft";
  const Images draft = images_of(job);
  job.effects = "occlusion";
  EXPECT_NE(draft["beauty"], images_of(job)["beauty"]);
}

TEST_F(FrameOcclusion, IsTheSameFarFromTheOrigin) {
  const glm::dvec3 far(1e6, -3e5, 2e6);
  Job near = seen(write(room())), away = near;
  near.layers = {"occlusion"};
  const auto at_origin = images_of(near)["occlusion"].values<float>();
  away = seen(write(room(far)), 1, far);
  away.layers = {"occlusion"};
  const auto far_off = images_of(away)["occlusion"].values<float>();
  for (size_t i = 0; i < at_origin.size(); ++i) EXPECT_NEAR(at_origin[i], far_off[i], 2e-3f) << i;
}

// Any size, sample count, radius, camera and way of sampling.
TEST_F(FrameOcclusion, IsAShareWhateverTheFrame) {
  const std::string path = write(room());
  for (const auto& [w, h] : {std::pair(1, 1), std::pair(31, 17), std::pair(2, 65)})
    for (const int samples : {1, 4})
      for (const double radius : {1e-3, 1e4}) {
        Job job = seen(path, samples);
        job.width_px = w, job.height_px = h;
        job.layers = {"occlusion"};
        job.look = look_file(fmt::format(R"({{"occlusion": {{"radius_m": {}, "falloff": 0}}}})", radius));
        job.settings = {{"occlusion", "bent", samples == 1 ? "0" : "1"}};
        const Images images = images_of(job);
        expect_shares(images["occlusion"].values<float>(), fmt::format("{}x{} {} {}", w, h, samples, radius));
        for (const float v : images["beauty"].values<float>()) ASSERT_TRUE(std::isfinite(v));
      }
  Job orthographic = job_for(scene("orthographic"), width, height, 4);
  orthographic.layers = {"occlusion"};
  expect_shares(images_of(orthographic)["occlusion"].values<float>(), "orthographic");
}

// Strength 0 hides nothing, and a frame of many samples a pixel is about as dark as one of few.
TEST_F(FrameOcclusion, FollowsTheLookAndTheSamples) {
  const std::string path = write(room());
  Job job = seen(path);
  job.layers = {"occlusion", "ambient_diffuse"};
  const Images one = images_of(job);
  const auto light = [](const Images& images) {
    double sum = 0;
    for (const glm::vec4& v : images["ambient_diffuse"].values<glm::vec4>()) sum += double(v.x);
    return sum;
  };
  Job four = job, sixteen = job;
  four.samples = 4;
  sixteen.settings = {{"supersample", "n", "4"}};
  for (const Job& many : {four, sixteen}) {
    const Images images = images_of(many);
    EXPECT_NEAR(light(images), light(one), 0.01 * light(one));
    EXPECT_NEAR(mean(images["occlusion"].values<float>()), mean(one["occlusion"].values<float>()), 0.01);
  }
  const std::string file = ::testing::TempDir() + "candela_occlusion_off.json";
  std::ofstream(file) << R"({"occlusion": {"strength": 0}})";
  job.look = file;
  for (const float v : images_of(job)["occlusion"].values<float>()) EXPECT_EQ(v, 1);
}

}  // namespace candela::test::frame_occlusion
