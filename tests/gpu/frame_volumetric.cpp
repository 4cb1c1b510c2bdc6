// Light of lamps in the air in whole frames: what it must not change, and extremes.
#include "frame_fixture.h"

namespace candela::test::frame_volumetric {
namespace {
constexpr int width = 34, height = 21;
}  // namespace

class FrameVolumetric : public FrameTest {
 protected:
  // A wall, a pane, a lamp behind it, one in the wall, one of a millimetre and one of ten kilometres, and a spot.
  static std::string scene(double away = 0) {
    GltfBuilder b = empty_scene();
    const auto at = [&](double x, double y, double z) { return Json{x + away, y, z - away}; };
    add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.7, 0.6, 0.5)))},
                 {"translation", at(0, 0, -8)}});
    Json pane = diffuse_material(0.2, 0.9, 0.2);
    pane["alphaMode"] = "BLEND", pane["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, pane))}, {"translation", at(1, 0.4, -4)}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.8f, add_material(b, diffuse_material(0.4, 0.4, 0.4)))},
                 {"translation", at(-1, 0, -3)}});
    add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", at(-1.2, 0.4, -5)}});
    add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", at(2, 1, -8)}});
    add_light(b, {{"type", "point"}, {"intensity", 1.0}, {"range", 1e-3}}, {{"translation", at(0.3, 0.2, -4)}});
    add_light(b, {{"type", "point"}, {"intensity", 5.0}, {"range", 1e4}}, {{"translation", at(2, 2, -3)}});
    add_light(b,
              {{"type", "spot"},
               {"intensity", 40.0},
               {"range", 12.0},
               {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
              {{"translation", at(1.5, 3, -6)}, {"rotation", {-0.7071068, 0, 0, 0.7071068}}});
    add_light(b, {{"type", "directional"}, {"intensity", 1.0}}, {{"rotation", {-0.5, 0.1, 0, 0.86}}});
    return write(b);
  }
  static Job seen(const std::string& file, const std::string& light, int samples = 4) {
    Job job = job_for(file, width, height, samples);
    job.look = look_file(light.empty() ? "{}" : "{\"volumetric\": " + light + "}");
    look(job, {0, 0.5, 3}, {0, 0, -3}, 50);
    return job;
  }
};

// Its layer is what it adds; without it, or with it left out, the frame is the bare one.
TEST_F(FrameVolumetric, AddsItsLayerAndNothingElse) {
  const std::string file = scene();
  for (const int samples : {1, 4}) {
    const Images bare = images_of(seen(file, "", samples));
    Job job = seen(file, R"({"phi": 2, "tau": 0.05})", samples);
    const Images lit = images_of(job);
    job.layers = {"volumetric"};
    const Images with_layer = images_of(job);
    EXPECT_TRUE(lit["beauty"] == with_layer["beauty"]);
    double all = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) {
          const float light = with_layer["volumetric"].at<glm::vec4>(x, y)[c];
          all += double(light);
          ASSERT_FLOAT_EQ(lit["beauty"].at<glm::vec4>(x, y)[c], bare["beauty"].at<glm::vec4>(x, y)[c] + light);
        }
    EXPECT_GT(all, 1);
    job.layers.clear();
    job.effects = "shadows";
    Job shadows = seen(file, "", samples);
    shadows.effects = "shadows";
    job.look = look_file(R"({"volumetric": {}})");
    const Images left_out = images_of(job);
    EXPECT_TRUE(left_out["beauty"] == images_of(shadows)["beauty"]);
  }
}

// Lists of lights change no bit of it.
TEST_F(FrameVolumetric, ListsChangeNoBit) {
  Job job = seen(scene(), R"({"tau": 0.05, "anisotropy": 0.5, "formula": "attenuation"})", 1);
  job.technique = "brute-force";
  const Images all = images_of(job);
  for (const char* technique : {"clustered", "forward-plus"})
    for (const char* list : {"compact", "bitmask"}) {
      job.technique = technique;
      job.settings = {{"lights", "list", list}, {"lights", "few", "0"}};
      EXPECT_TRUE(images_of(job)["beauty"] == all["beauty"]) << technique << " " << list;
    }
}

// Whatever the look says, wherever the world lies, nothing that is no number.
TEST_F(FrameVolumetric, AnythingGoes) {
  const std::string near = scene(), far = scene(1e6);
  for (const char* light :
       {R"({"tau": 0})", R"({"tau": 1e6})", R"({"tau": 1e-30, "anisotropy": 0.98})", R"({"phi": 0})",
        R"({"phi": 1e30, "tau": 0, "formula": "attenuation", "anisotropy": -0.98})", R"({"tau": 3e38})"})
    for (const auto& [file, away] : {std::pair(near, 0.0), {far, 1e6}})
      for (const char* filter : {"none", "gauss", "bilateral"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", light, away, filter));
        Job job = seen(file, light, away > 0 ? 1 : 4);
        look(job, {away, 0.5, 3 - away}, {away, 0, -3 - away}, 50);
        job.settings = {{"volumetric", "filter", filter}, {"volumetric", "samples", "8"}};
        job.layers = {"volumetric"};
        for (const int size : {0, 1}) {
          if (size > 0) job.width_px = job.height_px = size;
          for (const Image& image : images_of(job))
            for (const float v : image.values<float>()) ASSERT_TRUE(std::isfinite(v)) << image.layer;
        }
      }
}

}  // namespace candela::test::frame_volumetric
