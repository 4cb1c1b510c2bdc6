#include "scene/view_hulls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "math/transforms.h"
#include "scene/fit_view.h"
#include "scene/frame_data.h"
#include "scene/view.h"

namespace candela {
namespace {

MeshSection section_of(std::vector<glm::vec3> points) {
  MeshSection section;
  section.topology = Topology::points;
  section.position = std::move(points);
  for (size_t i = 0; i < section.position.size(); ++i) {
    section.index.push_back(uint32_t(i));
    if (std::isfinite(section.position[i].x)) section.bounds.add(section.position[i]);
  }
  return section;
}

// A node a section.
Scene scene_of(std::vector<MeshSection> sections) {
  Scene scene;
  for (MeshSection& section : sections) {
    Mesh mesh;
    mesh.sections.push_back(std::move(section));
    scene.meshes.push_back(std::move(mesh));
    Node node;
    node.mesh = int(scene.meshes.size()) - 1;
    scene.nodes.push_back(std::move(node));
    scene.order.push_back(int(scene.nodes.size()) - 1);
    scene.roots.push_back(int(scene.nodes.size()) - 1);
  }
  return scene;
}

View framed(const Scene& scene, double time_s, CameraRequest request, int width, int height,
            const std::string& animation = "auto") {
  const AnimationChoice choice = *choose_animations(scene, animation);
  const Pose pose = evaluate_pose(scene, choice, time_s);
  const auto outlines = [&](const glm::dmat3& axes, bool turned) {
    return view_hulls(scene, {choice, request.framing == Framing::film ? nullptr : &pose}, axes, turned);
  };
  const DrawnBounds bounds([&] { return world_bounds(scene, pose); }, outlines);
  auto view = make_view(scene, pose, request, width, height, bounds);
  EXPECT_TRUE(view) << view.error().message;
  return *view;
}

// Of projected points, in pixels.
struct Seen {
  glm::dvec2 least{1e300}, most{-1e300};
};
void see(Seen& seen, const View& view, glm::dvec3 world, int width, int height) {
  const glm::dvec4 clip = view.clip_from_relative * glm::dvec4(world - view.position, 1.0);
  ASSERT_GT(clip.w, 0);
  const glm::dvec2 px((clip.x / clip.w + 1) / 2 * width, (1 - clip.y / clip.w) / 2 * height);
  seen.least = glm::min(seen.least, px), seen.most = glm::max(seen.most, px);
}

// Centred to half a pixel on both axes, and touching the margin of a twentieth on two opposite sides.
void expect_framed(const Seen& seen, int width, int height, const std::string& what) {
  const glm::dvec2 size(width, height), off = (seen.least + seen.most - size) / 2.0,
                                        used = (seen.most - seen.least) / size;
  EXPECT_LE(std::max(std::abs(off.x), std::abs(off.y)), 0.5) << what;
  EXPECT_NEAR(std::max(used.x, used.y), 0.95, 1e-6) << what;
}

TEST(ViewHulls, RandomPointsFillThePictureAndStandInItsMiddle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int run = 0; run < 24; ++run) {
    std::vector<glm::vec3> points;
    const glm::vec3 scale(std::exp(3 * u(random)), std::exp(3 * u(random)), std::exp(3 * u(random)));
    for (int i = 0; i < 40; ++i) points.push_back(scale * glm::vec3(u(random), u(random), u(random)));
    Scene scene = scene_of({section_of(points)});
    scene.nodes[0].translation = run % 3 == 0 ? glm::dvec3(1e6, -3e5, 2) : glm::dvec3(0);
    scene.nodes[0].rotation = glm::normalize(glm::dquat(u(random), u(random), u(random), u(random)));
    const int width = run % 2 ? 480 : 200, height = run % 2 ? 320 : 400;
    CameraRequest request{.azimuth_deg = 180.0 * double(u(random)), .elevation_deg = 80.0 * double(u(random))};
    request.framing = Framing::film;
    const View view = framed(scene, 0, request, width, height);
    const glm::dmat4 world = evaluate_pose(scene, {}, 0).world_from_node[0];
    Seen seen;
    for (const glm::vec3& p : points) see(seen, view, glm::dvec3(world * glm::dvec4(p, 1)), width, height);
    expect_framed(seen, width, height, std::to_string(run));
  }
}

// Flat things seen edge-on, single points and tiny pictures have cameras, too.
TEST(ViewHulls, WhatHasNoSizeIsFramed) {
  const std::vector<std::vector<glm::vec3>> all = {
      {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}, {{3, 4, 5}}, {{0, 0, -1}, {0, 0, 1}}};
  for (const auto& points : all)
    for (const auto [width, height] : {std::pair(1, 1), {2, 1}, {1, 7}, {320, 200}}) {
      CameraRequest request{.azimuth_deg = 0, .elevation_deg = 0};
      request.framing = Framing::film;
      const View view = framed(scene_of({section_of(points)}), 0, request, width, height);
      Seen seen;
      for (const glm::vec3& p : points) see(seen, view, glm::dvec3(p), width, height);
      EXPECT_GT(view.near_m, 0);
      EXPECT_GE(std::min(seen.least.x / width, seen.least.y / height), 0.02);
      EXPECT_LE(std::max(seen.most.x / width, seen.most.y / height), 0.98);
    }
}

// What nobody would frame does not count: vertices that are not finite, what a mask cuts away, floors and domes.
TEST(ViewHulls, SurroundingsDoNotCount) {
  const std::vector<glm::vec3> cube = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                       {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
  const auto scaled = [&](float by) {
    std::vector<glm::vec3> points = cube;
    for (glm::vec3& p : points) p *= by;
    return points;
  };
  CameraRequest request;
  request.framing = Framing::film;
  const View plain = framed(scene_of({section_of(cube)}), 0, request, 320, 200);
  const auto same = [&](const Scene& scene) {
    const View view = framed(scene, 0, request, 320, 200);
    return glm::length(view.position - plain.position) < 1e-9;
  };
  EXPECT_TRUE(same(scene_of({section_of(cube), section_of({{-300, -1, -300}, {300, -1, -300}, {0, -1, 300}})})));
  EXPECT_TRUE(same(scene_of({section_of(cube), section_of(scaled(500))})));
  EXPECT_FALSE(same(scene_of({section_of(cube), section_of(scaled(50))})));
  // A body with a small thing on it is no dome.
  std::vector<glm::vec3> bolt = scaled(0.001f);
  for (glm::vec3& p : bolt) p += glm::vec3(0, 0, 1.001f);
  EXPECT_LT(glm::length(framed(scene_of({section_of(cube), section_of(bolt)}), 0, request, 320, 200).position -
                        plain.position),
            0.01);
  std::vector<glm::vec3> broken = cube;
  broken.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  EXPECT_TRUE(same(scene_of({section_of(broken)})));
  Scene masked = scene_of({section_of(cube), section_of(scaled(3))});
  masked.materials.resize(1);
  masked.materials[0].alpha_mode = AlphaMode::mask, masked.materials[0].base_color.w = 0.2f;
  masked.meshes[1].sections[0].material = 0;
  EXPECT_TRUE(same(masked));
  masked.materials[0].base_color.w = 0.7f;
  EXPECT_FALSE(same(masked));
  // By vertex colours: triangles of which no vertex reaches the cutoff.
  MeshSection& section = masked.meshes[1].sections[0];
  section.color.assign(section.position.size(), glm::vec4(1, 1, 1, 0.7f));
  EXPECT_TRUE(same(masked));
  section.color.assign(section.position.size(), glm::vec4(1, 1, 1, 0.8f));
  EXPECT_FALSE(same(masked));
}

// One camera for a film: the same at all times, with all times in view; what follows moves.
TEST(ViewHulls, AFilmHasOneCamera) {
  Scene scene = scene_of({section_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})});
  AnimationChannel flight;
  flight.path = TargetPath::node_translation, flight.object = 0;
  flight.times_s = {0, 1}, flight.values = {0, 0, 0, 10, 2, 0};
  scene.animations = {{"fly", {flight}, 1}};
  CameraRequest request;
  request.framing = Framing::film;
  const View start = framed(scene, 0, request, 320, 200);
  Seen seen;
  for (const double t : {0.0, 0.3, 1.0}) {
    const View view = framed(scene, t, request, 320, 200);
    EXPECT_EQ(view.position, start.position) << t;
    for (const glm::vec3& p : scene.meshes[0].sections[0].position)
      see(seen, view, glm::dvec3(p) + t * glm::dvec3(10, 2, 0), 320, 200);
  }
  expect_framed(seen, 320, 200, "film");
  EXPECT_EQ(framed(scene, 0.5, request, 320, 200, "none").position,
            framed(scene, 1, request, 320, 200, "none").position);
  request.framing = Framing::follow;
  EXPECT_NE(framed(scene, 0, request, 320, 200).position, framed(scene, 1, request, 320, 200).position);
  request.framing = Framing::film, request.turn_s = 4;  // no vertex leaves the picture, whatever the angle
  for (const double turn : {0.0, 1.0, 2.6}) {
    CameraRequest turned = request;
    turned.azimuth_deg = 90 * turn;
    const View view = framed(scene, turn, turned, 320, 200);
    Seen around;
    for (const double t : {0.0, 1.0})
      for (const glm::vec3& p : scene.meshes[0].sections[0].position)
        see(around, view, glm::dvec3(p) + t * glm::dvec3(10, 2, 0), 320, 200);
    EXPECT_GE(std::min(around.least.x, around.least.y), 0);
    EXPECT_LE(std::max(around.most.x / 320, around.most.y / 200), 1);
  }
}

AnimationChannel keyed(TargetPath path, int components, std::vector<float> times, std::vector<float> values) {
  AnimationChannel channel;
  channel.path = path, channel.object = 0, channel.components = components;
  channel.interpolation = components == 1 ? Interpolation::step : Interpolation::linear;
  channel.times_s = std::move(times), channel.values = std::move(values);
  return channel;
}

// Surroundings are judged over the whole film: what is tiny or hidden at its beginning counts with its floor.
TEST(ViewHulls, WhatGrowsOrAppearsLaterIsFramedWithItsFloor) {
  const std::vector<glm::vec3> cube = {{-.5, 0, -.5}, {.5, 0, -.5}, {-.5, 1, -.5}, {.5, 1, -.5},
                                       {-.5, 0, .5},  {.5, 0, .5},  {-.5, 1, .5},  {.5, 1, .5}};
  const std::vector<glm::vec3> floor = {{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}};
  CameraRequest request;
  request.framing = Framing::film;
  Scene scene = scene_of({section_of(cube), section_of(floor)});
  const View whole = framed(scene, 0, request, 320, 200);
  scene.animations = {{"grow", {keyed(TargetPath::node_scale, 3, {0, 1}, {0.001f, 0.001f, 0.001f, 1, 1, 1})}, 1}};
  EXPECT_LT(glm::length(framed(scene, 1, request, 320, 200).position - whole.position), 1e-6);

  Scene late = scene_of({section_of(cube)});
  const View seen = framed(late, 0, request, 320, 200);
  late.nodes[0].visible = false;
  late.animations = {{"appear", {keyed(TargetPath::node_visible, 1, {0, 0.5f}, {0, 1})}, 0.5}};
  const View appears = framed(late, 1, request, 320, 200);
  EXPECT_LT(glm::length(appears.position - seen.position), 1e-6);
  EXPECT_EQ(framed(late, 0, request, 320, 200).position, appears.position);
  EXPECT_TRUE(std::ranges::any_of(appears.notes, [](const std::string& note) {
    return note.find("one camera for the whole film of 0.5 s shows all that is drawn") != std::string::npos;
  }));
}

// With a target the camera looks at it from outside of all that the film shows.
TEST(ViewHulls, ATargetKeepsOneCameraToo) {
  Scene scene = scene_of({section_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})});
  scene.animations = {{"fly", {keyed(TargetPath::node_translation, 3, {0, 1}, {0, 0, 0, 10, 2, 0})}, 1}};
  CameraRequest request{.target = glm::dvec3(0, 1, 0)};
  request.framing = Framing::film;
  EXPECT_EQ(framed(scene, 0, request, 320, 200).position, framed(scene, 1, request, 320, 200).position);
}

// A joint that swings takes its vertices along: they count where they are, not where their boxes reach.
TEST(ViewHulls, SkinsCountAsTheyArePosed) {
  MeshSection section = section_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  section.joints0.assign(4, {0, 0, 0, 0});
  section.weights0.assign(4, {1, 0, 0, 0});
  Scene scene = scene_of({section});
  scene.nodes.push_back({});
  scene.order.push_back(1), scene.roots.push_back(1);
  scene.nodes[1].rotation = glm::dquat(std::cos(0.4), 0, 0, std::sin(0.4));
  scene.nodes[1].translation = {5, 0, 0};
  scene.skins.push_back({"", {1}, {glm::dmat4(1)}});
  scene.nodes[0].skin = 0;
  CameraRequest request;
  request.framing = Framing::film;
  const View view = framed(scene, 0, request, 480, 320);
  const glm::dmat4 joint = evaluate_pose(scene, {}, 0).world_from_node[1];
  Seen seen;
  for (const glm::vec3& p : section.position) see(seen, view, glm::dvec3(joint * glm::dvec4(p, 1)), 480, 320);
  expect_framed(seen, 480, 320, "skin");
}

// A hull that is built point by point is that of all points.
TEST(ViewHulls, HullsHoldAllPoints) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  PlanarHull hull, halves[2], merged;
  std::vector<glm::dvec2> points;
  for (int i = 0; i < 5000; ++i) {
    points.push_back({normal(random), 3 * normal(random)});
    hull.add(points.back()), halves[i % 2].add(points.back());
  }
  merged.add(halves[0]), merged.add(halves[1]);
  EXPECT_EQ(hull.points(), merged.points());
  EXPECT_LT(hull.points().size(), 60u);
  for (int i = 0; i < 64; ++i) {
    const double angle = i * 0.0981748;
    const glm::dvec2 d(std::cos(angle), std::sin(angle));
    const auto farthest = [&](const std::vector<glm::dvec2>& of) {
      double most = -1e300;
      for (const glm::dvec2& p : of) most = std::max(most, glm::dot(p, d));
      return most;
    };
    EXPECT_EQ(farthest(points), farthest(hull.points()));
  }
}

}  // namespace
}  // namespace candela
