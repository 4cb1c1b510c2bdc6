// Shutter and lens before any picture: options, exposure, moments of the open shutter, and the window of a lens.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "job/picture_camera.h"
#include "plan/ask_frame.h"
#include "plan/subframes.h"
#include "scene_pieces.h"

namespace candela::test {

TEST(Shutter, OptionsAreAnglesTimesAndParts) {
  const double frame_s = 1.0 / 24;
  for (const auto& [text, seconds] : {std::pair("180deg", frame_s / 2),
                                      {"360deg", frame_s},
                                      {"0", 0.0},
                                      {"0.25", frame_s / 4},
                                      {"1/48s", 1.0 / 48},
                                      {"0.02s", 0.02},
                                      {"1/24s", frame_s}}) {
    const auto parsed = parse_shutter(text, frame_s);
    ASSERT_TRUE(parsed) << text;
    EXPECT_NEAR(*parsed, seconds, 1e-15) << text;
  }
  for (const char* wrong : {"", "deg", "-1", "1.5", "361deg", "1/0s", "1/12s", "nan", "inf", "180 deg", "0x1"})
    EXPECT_FALSE(parse_shutter(wrong, frame_s)) << wrong;
}

// EV 15 at ISO 100 is f/16 at 1/125 s within a twentieth of a stop; each stop of aperture, time or speed is one stop.
TEST(Shutter, ExposureIsThatOfACamera) {
  EXPECT_NEAR(camera_exposure_ev(16, 1.0 / 125, 100), -(std::log2(256 * 125.0) + std::log2(1.2)), 1e-12);
  const double ev = camera_exposure_ev(4, 1.0 / 50, 200);
  EXPECT_NEAR(camera_exposure_ev(4, 1.0 / 50, 400), ev + 1, 1e-12);
  EXPECT_NEAR(camera_exposure_ev(4, 1.0 / 25, 200), ev + 1, 1e-12);
  EXPECT_NEAR(camera_exposure_ev(4 * std::sqrt(2.0), 1.0 / 50, 200), ev - 1, 1e-12);
}

TEST(Shutter, CommandLineGoesBeforeTheLook) {
  Look look;
  look.lens = LensLook{.f_stop = 2, .focus_m = 5};
  look.shutter = ShutterLook{90};
  Job job;
  auto camera = picture_camera(job, look);
  ASSERT_TRUE(camera);
  EXPECT_NEAR(camera->shutter_s, job.motion_s / 4, 1e-15);
  EXPECT_EQ(camera->lens->f_stop, 2);
  job.f_stop = 8, job.focus = "inf", job.shutter_s = 0.01, job.sensor_mm = 36;
  camera = picture_camera(job, look);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->lens->f_stop, 8);
  EXPECT_TRUE(std::isinf(camera->lens->focus_m));
  EXPECT_EQ(camera->lens->sensor_mm, 36);
  EXPECT_EQ(camera->shutter_s, 0.01);
  job.f_stop = 0, job.shutter_s = 0;
  EXPECT_FALSE(*picture_camera(job, look));
  job = {};
  job.effects = "none";
  EXPECT_FALSE(*picture_camera(job, look));
  job.effects = "bloom,lens";
  EXPECT_TRUE(picture_camera(job, look)->lens);
  EXPECT_EQ(picture_camera(job, look)->shutter_s, 0);
  job = {};
  job.f_stop = 2;
  EXPECT_FALSE(picture_camera(job, {})) << "a lens needs a focus";
  job.focus = "-1";
  EXPECT_FALSE(picture_camera(job, {}));
  job.focus = "1", job.iso = 100;
  EXPECT_FALSE(picture_camera(job, {})) << "an ISO speed needs a shutter";
}

// The shutter is open about the picture's time, never beyond a cut on either side, never before the film.
TEST(Shutter, StaysBetweenCuts) {
  const std::vector<double> cuts = {1, 2};
  const auto open = [&](double t, double s) { return open_shutter(t, s, cuts); };
  EXPECT_EQ(open(1.5, 0.5), std::pair(1.25, 1.75));
  EXPECT_EQ(open(1.9, 0.5), std::pair(1.65, 2.0));
  EXPECT_EQ(open(2.0, 0.5), std::pair(2.0, 2.25));
  EXPECT_EQ(open(1.0, 0.5), std::pair(1.0, 1.25));
  EXPECT_EQ(open(0.9, 0.5), std::pair(0.65, 1.0));
  EXPECT_EQ(open(0.0, 0.5), std::pair(0.0, 0.25));
  EXPECT_EQ(open(0.5, 0.0), std::pair(0.5, 0.5));
}

class Subframes : public ::testing::Test {
 protected:
  static Expected<std::vector<Subframe>> frames_of(const Job& job, const Scene& scene, double time_s) {
    const GeometryLayout none;
    return subframes_of(job, PlanContext{scene, none}, time_s);
  }
};

// Keys of a camera that steps are cuts: moments of a picture lie on one side.
TEST_F(Subframes, NeverStraddleACut) {
  GltfBuilder b = empty_scene();
  b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}};
  add_node(b, {{"name", "dolly"}});
  b.json["nodes"].push_back({{"camera", 0}});
  b.json["nodes"][0]["children"] = {1};
  const int times = b.accessor<float>("SCALAR", {0, 1, 2}),
            values = b.accessor<float>("VEC3", {0, 0, 5, 3, 0, 5, -3, 0, 5});
  b.json["animations"] = {{{"samplers", {{{"input", times}, {"output", values}, {"interpolation", "STEP"}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const auto scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  Job job;
  job.shutter_s = 0.1;
  EXPECT_EQ(camera_cuts(*scene, job), (std::vector<double>{0, 1, 2}));
  for (const double t : {0.96, 0.999, 1.0, 1.02, 1.5}) {
    const auto frames = frames_of(job, *scene, t);
    ASSERT_TRUE(frames) << frames.error().text();
    ASSERT_EQ(frames->size(), 17u);
    double sum = 0;
    for (size_t i = 0; i < 16; ++i) {
      EXPECT_EQ(std::floor((*frames)[i].time_s), std::floor(t)) << t;
      sum += (*frames)[i].time_s;
    }
    if (t == 1.5) EXPECT_NEAR(sum / 16, t, 1e-12);
    EXPECT_EQ(frames->back().role, SubframePart::Role::mean);
    EXPECT_EQ(frames->back().time_s, t);
  }
  job.shutter_s.reset();
  EXPECT_TRUE(frames_of(job, *scene, 1)->empty());
}

// Places in the pixel and on the lens are spread evenly: their means are the middles, within 1/n.
TEST_F(Subframes, PointsAreSpreadEvenly) {
  GltfBuilder b;
  b.triangle();
  const auto scene = b.load();
  ASSERT_TRUE(scene);
  Job job;
  job.f_stop = 2, job.focus = "3";
  for (const int n : {16, 64, 256}) {
    job.settings = {{"subframes", "n", std::to_string(n)}};
    const auto frames = frames_of(job, *scene, 0.3);
    ASSERT_TRUE(frames) << frames.error().text();
    glm::dvec2 offset(0), lens(0);
    double radius2 = 0;
    for (int i = 0; i < n; ++i) {
      const Subframe& f = (*frames)[size_t(i)];
      EXPECT_LE(std::max(std::abs(f.offset_px.x), std::abs(f.offset_px.y)), 0.5);
      EXPECT_LE(glm::length(f.lens), 1 + 1e-12);
      offset += f.offset_px / double(n), lens += f.lens / double(n), radius2 += glm::dot(f.lens, f.lens) / n;
    }
    EXPECT_LT(glm::length(offset), 3.0 / n);
    EXPECT_LT(glm::length(lens), 8.0 / n);
    EXPECT_NEAR(radius2, 0.5, 2.0 / n);
  }
  // Another picture has other points, the same picture the same.
  const auto one = frames_of(job, *scene, 0.3), same = frames_of(job, *scene, 0.3), other = frames_of(job, *scene, 0.4);
  EXPECT_EQ((*one)[3].offset_px, (*same)[3].offset_px);
  EXPECT_NE((*one)[3].offset_px, (*other)[3].offset_px);
}

// A point on the plane of focus stays in its pixel from every point of the lens; one behind it moves by what similar
// triangles say.
TEST(Lens, ThePlaneOfFocusStays) {
  GltfBuilder b;
  b.triangle();
  const auto scene = b.load();
  ASSERT_TRUE(scene);
  const Pose pose = evaluate_pose(*scene, {}, 0);
  CameraRequest camera;
  camera.eye = glm::dvec3(1, 2, 3), camera.target = glm::dvec3(-2, 0.5, -4), camera.yfov_deg = 50;
  const int width = 160, height = 90;
  const auto pinhole = make_view(*scene, pose, camera, width, height, DAabb{glm::dvec3(0), glm::dvec3(1)});
  ASSERT_TRUE(pinhole);
  const auto pixel_of = [](const View& view, glm::dvec3 p, glm::dvec2 size) {
    const glm::dvec4 clip = view.clip_from_relative * glm::dvec4(p - view.position, 1);
    return (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * size;
  };
  const glm::dmat3 axes = glm::transpose(glm::dmat3(pinhole->view_from_relative));
  const double focus = 4, radius = 0.05;
  for (const glm::dvec2 on_disc : {glm::dvec2(0), {1, 0}, {0, 1}, {-0.6, 0.3}, {0.2, -0.9}}) {
    View view = *pinhole;
    const glm::dvec2 offset(0.3, -0.2);
    const auto window = look_through(view, {on_disc * radius, radius, focus}, offset, width, height, 16384);
    ASSERT_TRUE(window);
    const glm::dvec2 size = glm::dvec2(width, height) + 2.0 * glm::dvec2(window->margin_px);
    EXPECT_LE(std::max(std::abs(window->offset_px.x), std::abs(window->offset_px.y)), 0.5);
    EXPECT_GE(std::min(window->first_px.x, window->first_px.y), 0);
    EXPECT_LE(window->first_px.x + width, int(size.x));
    EXPECT_LE(window->first_px.y + height, int(size.y));
    for (const double depth : {4.0, 8.0, 2.0}) {
      const glm::dvec3 p = pinhole->position + axes * (depth * glm::dvec3(0.2, -0.1, -1));
      // Where the image has it, in the picture's pixels; its samples lie off by the offset.
      const glm::dvec2 seen = pixel_of(view, p, size) - glm::dvec2(window->first_px) - window->offset_px + offset;
      const glm::dvec2 moved = seen - pixel_of(*pinhole, p, {width, height});
      const glm::dvec2 expected =
          glm::dvec2(on_disc.x, -on_disc.y) * radius * (1 / focus - 1 / depth) * double(height) / 2.0 / pinhole->tan_y;
      EXPECT_NEAR(moved.x, expected.x, 1e-9) << depth;
      EXPECT_NEAR(moved.y, expected.y, 1e-9) << depth;
    }
  }
  // A plane of focus at the near plane is refused where frames would be too large, one far away is a parallel move.
  View near = *pinhole, far = *pinhole;
  EXPECT_FALSE(look_through(near, {{0, 0}, 0.05, 1e-4}, {}, width, height, 16384));
  const auto window =
      look_through(far, {{0.05, 0}, 0.05, std::numeric_limits<double>::infinity()}, {}, width, height, 16384);
  ASSERT_TRUE(window);
  EXPECT_EQ(window->first_px, window->margin_px);
}

}  // namespace candela::test
