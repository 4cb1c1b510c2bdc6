// Fog in whole frames: what it must not change, what its parts sum to, and extremes.
#include "frame_fixture.h"
#include "passes/surfaces/terms.h"

namespace candela::test::frame_fog {
namespace {
constexpr int width = 33, height = 21;
}  // namespace

class FrameFog : public FrameTest {
 protected:
  static std::string fog_file(const std::string& fog) {
    return look_file(fog.empty() ? std::string("{}") : "{\"fog\": " + fog + "}");
  }
  // A wall, a pane before it, an unlit square, twelve lamps (more than walk without lists), a spot and a sun.
  static std::string lamps(double away = 0) {
    GltfBuilder b = empty_scene();
    const auto at = [&](double x, double y, double z) { return Json{x + away, y, z - away}; };
    add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.7, 0.6, 0.5)))},
                 {"translation", at(0, 0, -8)}});
    Json pane = diffuse_material(0.2, 0.9, 0.2);
    pane["alphaMode"] = "BLEND", pane["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, pane))}, {"translation", at(1, 0.4, -4)}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.7f, add_material(b, unlit_material(0.4, 0.5, 0.6)))},
                 {"translation", at(-1.5, -0.4, -3)}});
    for (int i = 0; i < 12; ++i)
      add_light(b, {{"type", "point"}, {"intensity", 2.0 + i}, {"range", 2.0 + 0.3 * i}},
                {{"translation", at(-3 + 0.5 * i, 1.5 - 0.25 * i, -7 + 0.7 * i)}});
    add_light(b,
              {{"type", "spot"},
               {"intensity", 40.0},
               {"range", 12.0},
               {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
              {{"translation", at(1.5, 3, -6)}, {"rotation", {-0.7071068, 0, 0, 0.7071068}}});
    add_light(b, {{"type", "directional"}, {"intensity", 2.0}}, {{"rotation", {-0.5, 0.1, 0, 0.86}}});
    return write(b);
  }
  static Job seen(const std::string& scene, const std::string& fog, int samples = 4) {
    Job job = job_for(scene, width, height, samples);
    job.look = fog_file(fog);
    look(job, {0, 0.5, 3}, {0, 0, -3}, 50);
    return job;
  }
  static void expect_finite(const Images& images) {
    for (const Image& image : images)
      for (const float v : image.values<float>()) ASSERT_TRUE(std::isfinite(v)) << image.layer;
  }
};

// A surface that faces the camera through homogeneous fog: the closed form, and 1 with no fog in the bounds.
TEST_F(FrameFog, TransmittanceIsTheClosedForm) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, unlit_material(1, 1, 1)))}});
  Job job = job_for(write(b), 17, 9);
  look(job, {0, 0, 4}, {0, 0, 0}, 5);
  job.layers = {"fog", "fog_transmittance"};
  job.look = fog_file(R"({"extinction": [0.1, 0.2, 0.4], "emission": [0, 0.3, 0]})");
  const Images images = images_of(job);
  const glm::vec4 through = images["fog_transmittance"].at<glm::vec4>(8, 4), light = images["fog"].at<glm::vec4>(8, 4),
                  beauty = images["beauty"].at<glm::vec4>(8, 4);
  for (int c = 0; c < 3; ++c) {
    const double depth = 4 * (c == 0 ? 0.1 : c == 1 ? 0.2 : 0.4);
    EXPECT_NEAR(through[c], std::exp(-depth), 1e-6);
    EXPECT_NEAR(light[c], c == 1 ? 1.5 * (1 - std::exp(-depth)) : 0, 1e-6);
    EXPECT_NEAR(beauty[c], through[c] + light[c], 1e-6);
  }
}

TEST_F(FrameFog, PartsSumToBeautyAndChangeNoBitOfIt) {
  const std::string scene = lamps();
  for (const int samples : {1, 4})
    for (const char* fog : {R"({"extinction": [0.05, 0.08, 0.12], "emission": 0.01, "falloff": 0.2})",
                            R"({"extinction": 0.2, "bounds": {"x": [-2, 2], "z": [-6, -1]}})"}) {
      Job job = seen(scene, fog, samples);
      job.background = "0.2,0.3,0.5";
      job.transparency = samples == 1 ? "layers" : "sorted";
      const Images alone = images_of(job);
      for (const LayerName& term : Terms::layers) job.layers.emplace_back(term.name);
      job.layers.emplace_back("fog"), job.layers.emplace_back("fog_transmittance");
      const Images parts = images_of(job);
      EXPECT_TRUE(alone["beauty"] == parts["beauty"]);
      double foggy = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const glm::vec4 beauty = parts["beauty"].at<glm::vec4>(x, y);
          glm::dvec3 sum(parts["fog"].at<glm::vec4>(x, y));
          foggy += sum.x;
          for (const LayerName& term : Terms::layers)
            sum += glm::dvec3(parts[std::string(term.name)].at<glm::vec4>(x, y));
          for (int c = 0; c < 3; ++c) ASSERT_NEAR(sum[c], beauty[c], 1e-5 * (1 + beauty[c])) << x << "," << y;
        }
      EXPECT_GT(foggy, 1);
    }
}

// Without fog, or with it left out, the frame is the bare one: bytes and plan.
TEST_F(FrameFog, AFrameWithoutItIsTheBareOne) {
  const std::string scene = lamps();
  Job bare = seen(scene, ""), left_out = seen(scene, R"({"extinction": 0.1})");
  left_out.look = fog_file(R"({"extinction": 0.1})");
  const Images foggy = images_of(left_out);
  bare.effects = left_out.effects = "none";
  const Images without = images_of(left_out);
  bare.look.clear();
  const Images plain = images_of(bare);
  EXPECT_TRUE(without["beauty"] == plain["beauty"]);
  EXPECT_FALSE(foggy["beauty"] == plain["beauty"]);
}

// Lists, techniques and the rest of what changes time alone change no bit of fog.
TEST_F(FrameFog, ListsChangeNoBit) {
  for (const char* method : {"froxels", "march", "pixels"}) {
    Job job = seen(lamps(), R"({"extinction": 0.1, "falloff": 0.1, "anisotropy": 0.6})", 1);
    job.settings = {
        {"fog", "method", method}, {"fog", "grid", "32x18x24"}, {"fog", "steps", "16"}, {"fog", "last", "2"}};
    job.layers = {"fog"};
    job.technique = "brute-force";
    const Images all = images_of(job);
    for (const auto& [technique, settings] : std::vector<std::pair<std::string, std::vector<KnobSetting>>>{
             {"clustered", {}},
             {"clustered", {{"lights", "list", "compact"}, {"lights", "tile_px", "8"}}},
             {"clustered", {{"lights", "list", "bitmask"}, {"lights", "slices_per_octave", "16"}}},
             {"clustered", {{"lights", "test", "aabb"}, {"lights", "list", "compact"}}},
             {"forward-plus", {{"lights", "list", "bitmask"}}},
             {"forward-plus", {{"lights", "list", "compact"}}}}) {
      Job listed = job;
      listed.technique = technique;
      listed.settings.insert(listed.settings.end(), settings.begin(), settings.end());
      const Images images = images_of(listed);
      EXPECT_TRUE(images["fog"] == all["fog"]) << method << " " << technique;
      EXPECT_TRUE(images["beauty"] == all["beauty"]) << method << " " << technique;
    }
  }
}

// Nothing that a look file may say makes a number that is none.
TEST_F(FrameFog, AnythingGoes) {
  const std::string near = lamps(), far = lamps(1e6);
  for (const char* fog :
       {R"({"extinction": 0})", R"({"extinction": 1e6})", R"({"extinction": 1e-30, "anisotropy": 0.98})",
        R"({"extinction": [0, 1e6, 0.1], "anisotropy": -0.98, "emission": [0, 5, 5]})",
        R"({"extinction": 1, "falloff": 20.7, "height": -3})", R"({"extinction": 1, "falloff": 100, "height": 1e6})",
        R"({"extinction": 1, "falloff": 100, "height": -1e6})", R"({"extinction": 0.1, "falloff": 1e-30})",
        R"({"extinction": 0.5, "bounds": {"x": [-1, 1], "y": [-1, 1], "z": [2, 4]}})",
        R"({"extinction": 0.5, "bounds": {"x": [50, 60]}})", R"({"extinction": 1e6, "bounds": {"y": [-1e-3, 1e-3]}})",
        R"({"extinction": 3e38, "albedo": 1})",
        R"({"boxes": [{"extinction": 1e6, "bounds": {"z": [-5, -4]}}, {"extinction": 0, "bounds": {"x": [0, 1]}},
                      {"extinction": [3e38, 0, 1], "emission": [1e30, 0, 1], "falloff": 100, "height": 1e6},
                      {"extinction": 1e-30, "rotation_deg": 33, "bounds": {"x": [-1, 1], "z": [-4, 4]}}]})"})
    for (const auto& [scene, away] : {std::pair(near, 0.0), {far, 1e6}})
      for (const char* method : {"froxels", "march", "pixels"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", fog, away, method));
        Job job = seen(scene, fog, away > 0 ? 1 : 4);
        look(job, {away, 0.5, 3 - away}, {away, 0, -3 - away}, 50);
        job.settings = {{"fog", "method", method}, {"fog", "grid", "32x18x24"}, {"fog", "steps", "16"}};
        job.layers = {"fog", "fog_transmittance"};
        expect_finite(images_of(job));
        if (away == 0) {
          job.width_px = job.height_px = 1;
          expect_finite(images_of(job));
        }
        if (HasFailure()) return;
      }
}

// Boxes that overlap are one with the sum of what they do; what lies behind the camera, or nowhere, is not there; a
// quarter turn exchanges x and z.
TEST_F(FrameFog, BoxesAddUp) {
  const std::string scene = lamps();
  const auto seen_with = [&](const std::string& fog) {
    Job job = seen(scene, fog, 1);
    job.settings = {{"fog", "method", "pixels"}, {"fog", "steps", "128"}};  // the grid's depths follow the media
    job.layers = {"fog", "fog_transmittance"};
    return images_of(job);
  };
  const auto expect_same = [&](const Images& a, const Images& b, const char* what) {
    for (const char* layer : {"fog", "fog_transmittance", "beauty"}) {
      double most = 0, mean = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          for (int c = 0; c < 3; ++c) {
            const double v = double(a[layer].at<glm::vec4>(x, y)[c]), w = double(b[layer].at<glm::vec4>(x, y)[c]);
            const double off = std::abs(v - w) / (0.01 + v);
            most = std::max(most, off), mean += off / (3.0 * width * height);
          }
      // Slices are not the same ones where a medium lies elsewhere.
      fmt::print("{} {}: off by {:.1e}, {:.1e} on average\n", what, layer, most, mean);
      EXPECT_LT(most, 0.05) << what << " " << layer;
      EXPECT_LT(mean, 3e-3) << what << " " << layer;
    }
  };
  const std::string bounds = R"("bounds": {"x": [-2, 2], "y": [-3, 2], "z": [-7, -1]})";
  const Images one = seen_with(
      R"({"scattering": [0.2, 0.25, 0.3], "absorption": 0.05, "emission": 0.01, "anisotropy": 0.3, )" + bounds + "}");
  expect_same(one,
              seen_with(R"({"scattering": 0.15, "absorption": 0.05, "emission": 0.01, "anisotropy": 0.3, )" + bounds +
                        R"(, "boxes": [{"scattering": [0.05, 0.1, 0.15], "anisotropy": 0.3, )" + bounds + "}]}"),
              "two boxes");
  const std::string alone = R"({"scattering": [0.2, 0.25, 0.3], "absorption": 0.05, "emission": 0.01,
                              "anisotropy": 0.3, )" +
                            bounds;
  expect_same(one, seen_with(R"({"boxes": [)" + alone + "}]}"), "one box in the list");
  expect_same(
      one, seen_with(alone + R"(, "boxes": [{"extinction": 9, "bounds": {"x": [-1, 1], "y": [-60, -50], "z": [20, 30]}},
                                              {"extinction": 0}]})"),
      "one behind the camera where no light passes, one of nothing");
  const std::string turned = R"({"scattering": [0.2, 0.25, 0.3], "absorption": 0.05, "emission": 0.01,
      "anisotropy": 0.3, "rotation_deg": 90, "bounds": {"x": [-3, 3], "y": [-3, 2], "z": [-6, -2]}})";
  expect_same(one, seen_with(turned), "a quarter turn");
}

// Opaque fog under a sun shows its source over its extinction, however thick the slices are.
TEST_F(FrameFog, TendsToTheSourceOverTheExtinction) {
  GltfBuilder b = empty_scene();
  add_node(b,
           {{"mesh", add_square_mesh(b, 40, add_material(b, diffuse_material(0, 0, 0)))}, {"translation", {0, 0, -9}}});
  add_light(b, {{"type", "point"}, {"intensity", 100.0}}, {{"translation", {0, 0, 10}}});
  const std::string scene = write(b);
  double before = 0;
  for (const double extinction : {10.0, 1e3, 1e5, 1e6}) {
    Job job = job_for(scene, 9, 9);
    // The lamp stands in clear air behind the camera; the fog begins at the eye.
    job.look = fog_file(fmt::format(R"({{"extinction": {}, "albedo": 0.5, "bounds": {{"z": [-9, 0]}}}})", extinction));
    look(job, {0, 0, 0}, {0, 0, -1}, 5);
    const double seen = double(images_of(job)["beauty"].at<glm::vec4>(4, 4).x);
    // Albedo 0.5, phase 1/4pi, 1 lux, and e^-2x from both ways: half.
    const double expected = 0.5 * 1.0 / (4 * 3.14159265358979) / 2;
    fmt::print("extinction {}: {:.6f} of {:.6f}\n", extinction, seen, expected);
    if (extinction > 100) EXPECT_NEAR(seen, expected, 0.25 * expected);
    before = seen;
  }
  EXPECT_GT(before, 0);
}

// One grid serves all samples of a supersampled frame, and the empty air between lamps glows.
TEST_F(FrameFog, SupersampledAndEmptyScenes) {
  Job job = seen(lamps(), R"({"extinction": 0.1})", 1);
  const Images once = images_of(job);
  job.settings = {{"supersample", "n", "2"}};
  job.layers = {"fog", "fog_transmittance"};
  const Images often = images_of(job);
  double a = 0, b = 0;
  for (const glm::vec4& v : once["beauty"].values<glm::vec4>()) a += double(v.x);
  for (const glm::vec4& v : often["beauty"].values<glm::vec4>()) b += double(v.x);
  EXPECT_NEAR(b, a, 0.03 * a);
  GltfBuilder empty = empty_scene();
  add_light(empty, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {0, 0, -3}}});
  Job air = seen(write(empty), R"({"extinction": 0.1})", 1);
  look(air, {0, 0, 3}, {0, 0, -3}, 50);
  const Images glow = images_of(air);
  EXPECT_GT(glow["beauty"].at<glm::vec4>(width / 2, height / 2).x, glow["beauty"].at<glm::vec4>(0, 0).x * 3);
  EXPECT_GT(glow["beauty"].at<glm::vec4>(0, 0).x, 0);
}

}  // namespace candela::test::frame_fog
