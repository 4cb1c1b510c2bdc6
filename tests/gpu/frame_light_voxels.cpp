#include <algorithm>
#include <cmath>

#include "frame_fixture.h"

// Shadows by cells of the view (passes/shadows/light_voxels.h) in whole frames, against those that every point traces.
namespace candela::test {
namespace {

class FrameLightVoxels : public FrameTest {
 protected:
  static constexpr int width = 96, height = 54;

  static Job seen(const std::filesystem::path& path, const std::string& technique, const std::string& method,
                  std::vector<KnobSetting> settings = {}) {
    Job job = job_for(path, width, height);
    job.technique = technique;
    job.effects = "shadows";
    job.settings = std::move(settings);
    job.settings.push_back({"local", "method", method});
    job.settings.push_back({"sun", "mode", method == "maps" ? "cascades" : method});
    return job;
  }
  static Image picture(const Job& job) { return images_of(job)["beauty"]; }
  static KnobSetting voxels(const std::string& knob, const std::string& value) { return {"voxels", knob, value}; }

  static size_t differing(const Image& a, const Image& b) {
    size_t count = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) count += a.at<glm::vec4>(x, y) != b.at<glm::vec4>(x, y);
    return count;
  }
  // Mean relative squared error.
  static double error(const Image& a, const Image& truth) {
    double sum = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const double p = a.at<glm::vec4>(x, y)[c], q = truth.at<glm::vec4>(x, y)[c];
          sum += (p - q) * (p - q) / (q * q + 0.01) / 3;
        }
    return sum / double(a.pixels());
  }

  // A floor of half size 20 at y = 0, with whatever stands on it; the camera looks down on it from z = 6.
  static GltfBuilder floor() {
    GltfBuilder b = empty_scene();
    const int mesh = add_square_mesh(b, 20, add_material(b, diffuse_material(0.8, 0.8, 0.8)));
    add_node(b, {{"mesh", mesh}, {"rotation", rotation_between({0, 0, 1}, {0, 1, 0})}});
    return b;
  }
  static void add_lamp(GltfBuilder& b, glm::dvec3 at, double range_m = 0) {
    Json light = {{"type", "point"}, {"intensity", 100.0}};
    if (range_m > 0) light["range"] = range_m;
    add_light(b, light, {{"translation", {at.x, at.y, at.z}}});
  }
  static void add_sun(GltfBuilder& b) {
    add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
              {{"rotation", rotation_between({0, 0, -1}, glm::normalize(glm::dvec3(0.3, -1, -0.2)))}});
  }
  static Job from_above(const std::string& path, const std::string& method, std::vector<KnobSetting> settings = {}) {
    Job job = seen(path, "visibility", method, std::move(settings));
    look(job, {0, 5, 6}, {0, 0, 0}, 60);
    return job;
  }
};

// A cell of one pixel is a point, which sends its rays: the exact end.
TEST_F(FrameLightVoxels, CellsOfOnePixelAreTraced) {
  for (const char* technique : {"clustered", "hybrid"}) {
    const Image traced = picture(seen(scene("street"), technique, "traced"));
    EXPECT_EQ(picture(seen(scene("street"), technique, "voxels", {voxels("size_px", "1")})), traced) << technique;
    EXPECT_LT(error(picture(seen(scene("street"), technique, "voxels", {voxels("size_px", "4")})), traced), 1e-2)
        << technique;
  }
}

TEST_F(FrameLightVoxels, ErrorFallsAsCellsShrinkAndWithRaysAtEdges) {
  const auto by = [](const std::string& method, std::vector<KnobSetting> settings) {
    Job job = seen(scene("street"), "visibility", method, std::move(settings));
    job.width_px = 240, job.height_px = 135;
    return picture(job);
  };
  const Image traced = by("traced", {}), fine = by("voxels", {voxels("size_px", "4")});
  EXPECT_EQ(by("voxels", {voxels("size_px", "4")}), fine);
  const double large = error(by("voxels", {voxels("size_px", "16")}), traced), small = error(fine, traced);
  const double few = error(by("voxels", {voxels("size_px", "16"), voxels("points", "1")}), traced);
  const double halved = error(by("voxels", {voxels("size_px", "4"), voxels("edges", "half")}), traced);
  fmt::print("relMSE: {:.3g} with cells of 16 px, {:.3g} of 4; {:.3g} with a point each, {:.3g} halved\n", large, small,
             few, halved);
  EXPECT_LT(small, 0.5 * large);
  EXPECT_LT(large, few);
  EXPECT_LT(small, halved);
}

// Nothing stands between lights and the floor: all of them arrive, to the bit, also with cells that let half through
// where they are in doubt.
TEST_F(FrameLightVoxels, NoLightIsLostWhereNothingBlocksIt) {
  GltfBuilder b = floor();
  for (const glm::dvec3 at : {glm::dvec3(-2, 1, 0), {0, 0.05, 1}, {3, 4, -5}}) add_lamp(b, at);
  add_sun(b);
  const std::string path = write(b);
  const Image traced = picture(from_above(path, "traced"));
  Job unshadowed = from_above(path, "maps");
  unshadowed.effects = "none";
  EXPECT_EQ(traced, picture(unshadowed));
  for (const char* size : {"4", "32"})
    EXPECT_EQ(picture(from_above(path, "voxels", {voxels("size_px", size), voxels("edges", "half")})), traced) << size;
}

// A wall as thin as paper on the floor, with a lamp on either side: cells hold points of both sides of it, and of the
// floor before and behind it, and none may answer for the other.
TEST_F(FrameLightVoxels, WallsKeepLightOnTheirSide) {
  GltfBuilder b = floor();
  const int wall = add_square_mesh(b, 1, add_material(b, diffuse_material(0.5, 0.5, 0.5)));
  for (const double x : {-2.0, 0.0, 2.0})
    add_node(b, {{"mesh", wall}, {"translation", {x, 1, 0}}, {"rotation", rotation_between({0, 0, 1}, {1, 0, 0.3})}});
  add_lamp(b, {1, 0.8, 0.5});
  add_lamp(b, {-1, 1.5, -0.5});
  const std::string path = write(b);
  const Image traced = picture(from_above(path, "traced"));
  for (const auto& [size, most] : {std::pair("4", 0.002), std::pair("8", 0.005)}) {
    const size_t wrong = differing(picture(from_above(path, "voxels", {voxels("size_px", size)})), traced);
    fmt::print("cells of {} px: {} pixels of {} differ\n", size, wrong, traced.pixels());
    EXPECT_LE(double(wrong), most * double(traced.pixels())) << size;
  }
}

// Penumbrae are rays'; what sees all of a lamp or nothing of it sends none and is as lit.
TEST_F(FrameLightVoxels, LampsWithASizeKeepTheirPenumbrae) {
  GltfBuilder b = floor();
  const int square = add_square_mesh(b, 0.5f, add_material(b, diffuse_material(0.5, 0.2, 0.1)));
  add_node(b, {{"mesh", square}, {"rotation", rotation_between({0, 0, 1}, {0, 1, 0})}, {"translation", {0, 1, 0}}});
  add_lamp(b, {0, 3, 0});
  const std::string path = write(b);
  const std::string sized = look_file(R"({"lights": {"radius_m": 0.3}})");
  const auto soft = [&](const std::string& method) {
    Job job = from_above(path, method, {{"local", "samples", "4"}});
    job.look = sized;
    return picture(job);
  };
  const Image traced = soft("traced"), by_cells = soft("voxels");
  EXPECT_GT(differing(traced, picture(from_above(path, "traced"))), 100u);
  EXPECT_LE(differing(by_cells, traced), traced.pixels() / 500);
}

// Of a multisampled and of a supersampled frame the cells are made once.
TEST_F(FrameLightVoxels, ServeAllSamples) {
  for (const bool multisampled : {true, false}) {
    const auto by = [&](const std::string& method, const char* edges) {
      Job job = seen(scene("street"), "visibility", method, {voxels("size_px", "4"), voxels("edges", edges)});
      if (multisampled)
        job.samples = 4;
      else
        job.settings.push_back({"supersample", "n", "4"});
      return picture(job);
    };
    const Image traced = by("traced", "rays");
    EXPECT_LT(error(by("voxels", "rays"), traced), 1e-2) << multisampled;
    EXPECT_GT(differing(by("voxels", "half"), traced), 100u) << multisampled;
  }
}

// Cells without room are named, and their points send rays.
TEST_F(FrameLightVoxels, SayWhereMemoryEnds) {
  GltfBuilder b = floor();
  for (int i = 0; i < 30000; ++i) add_lamp(b, {0.01 * (i % 100), -1, 0.01 * (i / 100)}, 0.5);  // below the floor
  add_lamp(b, {0, 1, 0});
  const std::string path = write(b);
  const auto session = open(from_above(path, "voxels", {voxels("budget_mb", "1"), voxels("size_px", "4")}));
  ASSERT_TRUE(session);
  const FrameResult result = render(*session);
  EXPECT_TRUE(std::ranges::any_of(result.notes, [](const std::string& note) {
    return note.find("have no room (voxels.budget_mb = 1)") != std::string::npos;
  }));
  EXPECT_EQ(images(result)["beauty"], picture(from_above(path, "traced")));
}

// No pass, and no memory, where no light casts a shadow by cells.
TEST_F(FrameLightVoxels, AreLeftOutWhereNothingCasts) {
  GltfBuilder lit = floor();
  add_lamp(lit, {0, 1, 0});
  const std::string path = write(lit);
  Job bare = from_above(path, "voxels"), traced = from_above(path, "traced"), points = traced;
  bare.effects = "none";
  points.settings = {{"local", "method", "voxels"}, {"voxels", "size_px", "1"}};
  for (const auto& [job, reason] :
       {std::pair(bare, "no light's shadows are by cells of the view (local.method, sun.mode)"),
        std::pair(traced, "no light's shadows are by cells of the view (local.method, sun.mode)"),
        std::pair(points, "cells of one pixel: each point sends its own rays (voxels.size_px)")}) {
    const auto session = open(job);
    ASSERT_TRUE(session);
    const FrameResult result = render(*session);
    EXPECT_TRUE(std::ranges::any_of(result.plan->left_out, [&](const LeftOut& l) {
      return l.pass == "light_voxels" && l.reason == reason;
    })) << reason;
  }
}

}  // namespace
}  // namespace candela::test
