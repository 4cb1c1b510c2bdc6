#include "scene/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/transforms.h"
#include "scene/fit_view.h"

namespace candela {
namespace {

using std::numbers::pi;

// One node with one camera, placed by `world`.
struct CameraScene {
  Scene scene;
  Pose pose;
  explicit CameraScene(const Camera& camera = {}, const glm::dmat4& world = glm::dmat4(1.0)) {
    scene.cameras = {camera};
    scene.nodes.resize(1);
    scene.nodes[0].camera = 0;
    scene.order = {0};
    pose.cameras = scene.cameras;
    pose.world_from_node = {world};
    pose.node_visible = {true};
  }
  Expected<View> view(const CameraRequest& request = {}, int width = 200, int height = 100,
                      const DAabb& bounds = {}) const {
    return make_view(scene, pose, request, width, height, bounds);
  }
};

glm::dvec3 project(const View& view, glm::dvec3 world) {
  const glm::dvec4 clip = view.clip_from_relative * glm::dvec4(world - view.position, 1.0);
  return glm::dvec3(clip) / clip.w;
}

// Smallest error of a stored float depth, as a distance: half the gap between depths, over the slope of near / z.
double depth_step_m(const View& view, double z) {
  const float d = float(project(view, {0, 0, -z}).z);
  const double other = double(std::nextafter(d, 1.0f));
  return std::abs(view.near_m / double(d) - view.near_m / other);
}

TEST(View, ReversedInfiniteDepthKeepsItsRelativePrecision) {
  Camera camera;
  camera.near_m = 0.1;
  const View view = *CameraScene(camera).view();
  EXPECT_DOUBLE_EQ(project(view, {0, 0, -0.1}).z, 1);
  EXPECT_DOUBLE_EQ(project(view, {0, 0, -1e9}).z, 1e-10);
  for (double z : {10.0, 1e3, 1e4, 1e5}) {
    const double relative = depth_step_m(view, z) / z;
    EXPECT_LT(relative, 1.01 * std::exp2(-23)) << z;
    EXPECT_GT(relative, 0.99 * std::exp2(-24)) << z;
  }
  EXPECT_NEAR(depth_step_m(view, 1e4), 0.9e-3, 0.1e-3);
}

TEST(View, ClipSpaceIsVulkans) {
  const View view = *CameraScene().view();  // 45 degrees, aspect 2
  const double t = std::tan(pi / 8);
  EXPECT_NEAR(project(view, {0, t * 5, -5}).y, -1, 1e-12);  // up is -y
  EXPECT_NEAR(project(view, {2 * t * 5, 0, -5}).x, 1, 1e-12);
  for (const glm::dvec4& p : frustum_planes(view.clip_from_relative)) EXPECT_NEAR(glm::length(glm::dvec3(p)), 1, 1e-12);
}

TEST(View, NodeScaleShearAndMirroringDoNotChangeTheCamera) {
  const glm::dquat q = glm::normalize(glm::dquat(0.9, 0.1, 0.3, -0.2));
  const View plain = *CameraScene({}, compose_trs({1, 2, 3}, q, {1, 1, 1})).view();
  for (glm::dvec3 scale :
       {glm::dvec3(3, 3, 3), glm::dvec3(0.1, 5, 2), glm::dvec3(-1, 1, 1), glm::dvec3(1, 1, 0), glm::dvec3(0, 1, 1)}) {
    const View scaled = *CameraScene({}, compose_trs({1, 2, 3}, q, scale)).view();
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r) EXPECT_NEAR(scaled.view_from_relative[c][r], plain.view_from_relative[c][r], 1e-12);
    EXPECT_EQ(scaled.position, plain.position);
  }
  glm::dmat4 sheared(1.0);
  sheared[1] = {0, 1, 0.7, 0};
  const View nothing = *CameraScene({}, compose_trs({1, 2, 3}, q, {0, 0, 0})).view();
  EXPECT_FALSE(nothing.notes.empty());
  for (const View& v :
       {*CameraScene({}, sheared).view(), nothing, *CameraScene({}, compose_trs({}, q, {1, 0, 0})).view()}) {
    const glm::dmat3 r(v.view_from_relative);
    EXPECT_NEAR(glm::determinant(r), 1, 1e-12);
    EXPECT_NEAR(glm::length(r[0]) + glm::length(r[1]) + glm::length(r[2]), 3, 1e-12);
  }
}

TEST(View, PerspectiveKeepsYfovAndIgnoresZfar) {
  Camera camera;
  camera.name = "Main";
  camera.yfov_rad = 1;
  camera.aspect = 1;
  camera.far_m = 100;
  camera.near_m = 0.5;
  const CameraScene s(camera);
  const View view = *s.view();
  EXPECT_DOUBLE_EQ(view.tan_y, std::tan(0.5));
  EXPECT_DOUBLE_EQ(view.tan_x, 2 * std::tan(0.5));
  EXPECT_EQ(view.near_m, 0.5);
  EXPECT_EQ(view.name, "camera 'Main'");
  EXPECT_EQ(view.notes.size(), 2u);  // zfar, aspect
  EXPECT_DOUBLE_EQ(s.view({.yfov_deg = 90})->tan_y, std::tan(pi / 4));
}

TEST(View, OrthographicKeepsYmagAndHasReversedFiniteDepth) {
  Camera camera;
  camera.perspective = false;
  camera.xmag = 1;
  camera.ymag = 3;
  camera.near_m = 1;
  camera.far_m = 11;
  const View view = *CameraScene(camera).view();
  EXPECT_FALSE(view.perspective);
  EXPECT_DOUBLE_EQ(view.tan_x, 6);
  EXPECT_FALSE(view.notes.empty());
  EXPECT_NEAR(project(view, {6, 3, -1}).x, 1, 1e-12);
  EXPECT_NEAR(project(view, {6, 3, -1}).y, -1, 1e-12);
  EXPECT_NEAR(project(view, {0, 0, -1}).z, 1, 1e-12);
  EXPECT_NEAR(project(view, {0, 0, -11}).z, 0, 1e-12);
  EXPECT_NEAR(project(view, {0, 0, -6}).z, 0.5, 1e-12);

  camera.far_m = std::numeric_limits<double>::infinity();
  const View open = *CameraScene(camera).view({}, 200, 100, {{-1, -1, -500}, {1, 1, 5}});
  EXPECT_GT(open.far_m, 500);
  EXPECT_LT(open.far_m, 502);
}

TEST(View, UnusableCamerasAreInputErrors) {
  const auto kind = [](Camera camera) { return CameraScene(camera).view().error().kind; };
  Camera flat;
  flat.yfov_rad = 0;
  EXPECT_EQ(kind(flat), ErrorKind::input);
  Camera near;
  near.near_m = 0;
  EXPECT_EQ(kind(near), ErrorKind::input);
  Camera thin;
  thin.perspective = false;
  thin.ymag = 0;
  EXPECT_EQ(kind(thin), ErrorKind::input);
  Camera reversed;
  reversed.perspective = false;
  reversed.far_m = reversed.near_m;
  EXPECT_EQ(kind(reversed), ErrorKind::input);
}

TEST(View, CamerasAreFoundByNameNodeOrIndex) {
  CameraScene s;
  s.scene.cameras[0].name = "a";
  s.scene.cameras.push_back({"b"});
  s.scene.cameras.push_back({"lost"});
  s.pose.cameras = s.scene.cameras;
  s.scene.nodes.resize(4);
  s.scene.nodes[1].camera = 1;
  s.scene.nodes[1].name = "tripod";
  s.scene.nodes[3].camera = 2;  // not in the scene
  s.scene.order = {2, 1, 0};
  s.pose.world_from_node.resize(4, glm::dmat4(1.0));
  EXPECT_EQ(s.view()->name, "camera 'b'");  // first in the order of the scene
  EXPECT_EQ(s.view({.camera = "a"})->name, "camera 'a'");
  EXPECT_EQ(s.view({.camera = "tripod"})->name, "camera 'b'");
  EXPECT_EQ(s.view({.camera = "0"})->name, "camera 'a'");
  for (const char* bad : {"lost", "2", "7", "nobody"}) {
    const auto view = s.view({.camera = bad});
    ASSERT_FALSE(view) << bad;
    EXPECT_EQ(view.error().kind, ErrorKind::usage);
  }
}

TEST(View, EyeAndTargetComeBeforeTheFilesCamera) {
  const CameraScene s;
  const View view = *s.view({.eye = glm::dvec3(1e6, 2, 3), .target = glm::dvec3(1e6, 2, 3.001), .yfov_deg = 90});
  EXPECT_EQ(view.position, glm::dvec3(1e6, 2, 3));
  EXPECT_LT(view.near_m, 1e-4);  // the target is 1 mm away
  const glm::dvec3 p = project(view, {1e6, 2, 3.001});
  EXPECT_NEAR(p.x, 0, 1e-12);
  EXPECT_NEAR(p.y, 0, 1e-12);
  const View down = *s.view({.eye = glm::dvec3(0, 5, 0), .target = glm::dvec3(0)});
  EXPECT_NEAR(glm::determinant(glm::dmat3(down.view_from_relative)), 1, 1e-12);
  EXPECT_EQ(s.view({.eye = glm::dvec3(1), .target = glm::dvec3(1)}).error().kind, ErrorKind::usage);
  EXPECT_EQ(s.view({.eye = glm::dvec3(1), .camera = "0"}).error().kind, ErrorKind::usage);
  EXPECT_EQ(s.view({.yfov_deg = 180}).error().kind, ErrorKind::usage);
  EXPECT_EQ(s.view({.eye = glm::dvec3(NAN)}).error().kind, ErrorKind::usage);
  EXPECT_EQ(s.view({}, 0, 10).error().kind, ErrorKind::usage);
}

TEST(View, FramedBoundsLieInsideTheImage) {
  const Scene scene;
  const Pose pose;
  for (glm::ivec2 size : {glm::ivec2(1920, 1080), glm::ivec2(100, 100), glm::ivec2(90, 300), glm::ivec2(2000, 1)}) {
    for (glm::dvec3 half : {glm::dvec3(1, 1, 1), glm::dvec3(100, 0.1, 0.1), glm::dvec3(0, 5, 0),
                            glm::dvec3(1e-4, 2e-4, 1e-4), glm::dvec3(1e5, 0, 1e5)}) {
      for (double yfov : {10.0, 45.0, 150.0}) {
        const glm::dvec3 centre(1e6, -20, 3);
        const View view =
            *make_view(scene, pose, {.yfov_deg = yfov}, size.x, size.y, DAabb{centre - half, centre + half});
        EXPECT_EQ(view.name, "framed bounds");
        double farthest = 0;
        for (int c = 0; c < 8; ++c) {
          const glm::dvec3 corner = centre + half * glm::dvec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
          const glm::dvec3 p = project(view, corner);
          EXPECT_LT(std::abs(p.x), 1);
          EXPECT_LT(std::abs(p.y), 1);
          EXPECT_GT(p.z, 0);
          EXPECT_LE(p.z, 1);  // not cut by the near plane
          farthest = std::max({farthest, std::abs(p.x), std::abs(p.y)});
        }
        if (half == glm::dvec3(1, 1, 1) && yfov == 45 && size.x > size.y && size.y > 1) {
          EXPECT_GT(farthest, 0.5);  // and fill it
        }
      }
    }
  }
}

TEST(View, NothingToFrameStillGivesAView) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const DAabb& box :
       {DAabb{}, DAabb{glm::dvec3(-infinity), glm::dvec3(infinity)}, DAabb{glm::dvec3(7), glm::dvec3(7)}}) {
    const View view = *make_view({}, {}, {}, 16, 9, box);
    EXPECT_TRUE(std::isfinite(view.position.x + view.clip_from_relative[0][0]));
    EXPECT_GT(view.near_m, 0);
  }
}

// Largest |x| and |y| of the box's corners in the picture, and how far from centred it is.
struct Extent {
  double x = 0, y = 0, off_x = 0, off_y = 0;
};
Extent extent_in(const View& view, const std::vector<glm::dvec3>& points) {
  glm::dvec3 least(1e9), most(-1e9);
  for (const glm::dvec3& p : points) {
    const glm::dvec4 clip = view.clip_from_relative * glm::dvec4(p - view.position, 1.0);
    EXPECT_GT(clip.w, 0);
    least = glm::min(least, glm::dvec3(clip) / clip.w), most = glm::max(most, glm::dvec3(clip) / clip.w);
  }
  return {std::max(-least.x, most.x), std::max(-least.y, most.y), most.x + least.x, most.y + least.y};
}

TEST(View, FitFillsThePictureWithTheBox) {
  const CameraScene s;
  for (const glm::dvec3 half : {glm::dvec3(1, 1, 1), glm::dvec3(5, 0.1, 2), glm::dvec3(0.01, 3, 0.01)})
    for (const glm::dvec3 centre : {glm::dvec3(0), glm::dvec3(1e5, -3, 7)})
      for (const double azimuth : {0.0, 30.0, 123.0, -90.0})
        for (const double elevation : {-90.0, 0.0, 20.0, 90.0})
          for (const auto& [width, height] : {std::pair(200, 100), {100, 200}}) {
            const DAabb box{centre - half, centre + half};
            const CameraRequest request{.azimuth_deg = azimuth, .elevation_deg = elevation, .fit = true};
            const auto view = s.view(request, width, height, box);
            ASSERT_TRUE(view) << view.error().text();
            const Extent e = extent_in(*view, corners_of(box));
            EXPECT_LT(std::max(e.x, e.y), 0.951) << azimuth << " " << elevation;
            EXPECT_GT(std::max(e.x, e.y), 0.949) << azimuth << " " << elevation;
            EXPECT_NEAR(e.x > e.y ? e.off_x : e.off_y, 0, 1e-6);
            EXPECT_EQ(view->name, "fitted bounds");
          }
}

TEST(View, FitKeepsACamerasDirectionAndKind) {
  const DAabb box{{-1, 0, -2}, {3, 2, 2}};
  const glm::dquat q = glm::normalize(glm::dquat(0.9, 0.1, 0.3, -0.2));
  for (const bool perspective : {true, false}) {
    Camera camera;
    camera.perspective = perspective, camera.xmag = camera.ymag = 7;
    const CameraScene s(camera, compose_trs({50, 60, 70}, q, {1, 1, 1}));
    const View plain = *s.view({}, 160, 90, box), fitted = *s.view({.fit = true}, 160, 90, box);
    EXPECT_EQ(plain.view_from_relative, fitted.view_from_relative);
    EXPECT_EQ(plain.perspective, fitted.perspective);
    const Extent e = extent_in(fitted, corners_of(box));
    EXPECT_NEAR(std::max(e.x, e.y), 0.95, 1e-6);
  }
}

TEST(View, ATurntableKeepsItsDistanceAndTheBoxInThePicture) {
  const CameraScene s;
  const DAabb box{{-1, 0, -4}, {1, 2, 4}};
  const glm::dvec3 centre = box.centre();
  double distance = 0, largest = 0;
  for (int frame = 0; frame < 48; ++frame) {
    const CameraRequest request = camera_at({.azimuth_deg = 10, .turn_s = 2}, frame / 24.0);
    const auto view = s.view(request, 160, 90, box);
    ASSERT_TRUE(view);
    if (frame > 0) EXPECT_NEAR(glm::length(view->position - centre), distance, 1e-9);
    distance = glm::length(view->position - centre);
    const glm::dvec3 from = view->position - centre;
    EXPECT_NEAR(std::remainder(std::atan2(from.x, from.z) - (10 + 7.5 * frame) * pi / 180, 2 * pi), 0, 1e-9);
    const Extent e = extent_in(*view, corners_of(box));
    largest = std::max({largest, e.x, e.y});
  }
  EXPECT_LT(largest, 0.951);
  EXPECT_GT(largest, 0.9);
}

TEST(View, DirectionsDoNotGoWithACameraOrAnEye) {
  const CameraScene s;
  EXPECT_FALSE(s.view({.camera = "0", .azimuth_deg = 1}));
  EXPECT_FALSE(s.view({.eye = glm::dvec3(1), .target = glm::dvec3(0), .elevation_deg = 1}));
  EXPECT_FALSE(s.view({.eye = glm::dvec3(1), .target = glm::dvec3(0), .fit = true}));
  EXPECT_EQ(s.view({.azimuth_deg = 30}, 200, 100, {{-1, -1, -1}, {1, 1, 1}})->name, "framed bounds");
}

}  // namespace
}  // namespace candela
