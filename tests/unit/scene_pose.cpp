#include "scene/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gltf_builder.h"
#include "math/transforms.h"
#include "scene/moving_nodes.h"
#include "scene/posed_parts.h"

namespace candela {
namespace {

AnimationChannel channel(TargetPath path, Interpolation interpolation, int components, std::vector<float> times,
                         std::vector<float> values, int object = 0, int element = -1) {
  AnimationChannel c;
  c.path = path;
  c.object = object;
  c.element = element;
  c.interpolation = interpolation;
  c.components = components;
  c.times_s = std::move(times);
  c.values = std::move(values);
  return c;
}

double sample1(const AnimationChannel& c, double time) {
  double out = -1;
  sample_channel(c, time, std::span(&out, 1));
  return out;
}

glm::dquat sample_rotation(const AnimationChannel& c, double time) {
  double out[4];
  sample_channel(c, time, out);
  return {out[3], out[0], out[1], out[2]};
}

// Rotation by an angle about z, as glTF stores it.
std::vector<float> about_z(std::initializer_list<double> angles) {
  std::vector<float> values;
  for (double a : angles) values.insert(values.end(), {0, 0, float(std::sin(a / 2)), float(std::cos(a / 2))});
  return values;
}
double angle_about_z(glm::dquat q) { return 2 * std::atan2(q.z, q.w); }

constexpr auto light_value = TargetPath::light_intensity;

TEST(Sampling, LinearBeforeBetweenAndPastTheKeys) {
  const auto c = channel(light_value, Interpolation::linear, 1, {1, 2, 4}, {10, 20, 0});
  EXPECT_EQ(sample1(c, -5), 10);
  EXPECT_EQ(sample1(c, 1), 10);
  EXPECT_DOUBLE_EQ(sample1(c, 1.25), 12.5);
  EXPECT_EQ(sample1(c, 2), 20);
  EXPECT_DOUBLE_EQ(sample1(c, 3.5), 5);
  EXPECT_EQ(sample1(c, 4), 0);
  EXPECT_EQ(sample1(c, 1e9), 0);
}

TEST(Sampling, StepHoldsUntilTheNextKey) {
  const auto c = channel(light_value, Interpolation::step, 1, {1, 2}, {10, 20});
  EXPECT_EQ(sample1(c, 0), 10);
  EXPECT_EQ(sample1(c, std::nextafter(2.0, 0.0)), 10);
  EXPECT_EQ(sample1(c, 2), 20);
  EXPECT_EQ(sample1(c, 3), 20);
}

TEST(Sampling, CubicSplineIsHermiteWithTangentsPerSecond) {
  // Keys at 1 s and 3 s: in-tangent, value, out-tangent.
  const auto c = channel(light_value, Interpolation::cubic_spline, 1, {1, 3}, {99, 10, 4, -2, 20, 99});
  EXPECT_EQ(sample1(c, 0), 10);
  EXPECT_EQ(sample1(c, 9), 20);
  // s = 1/4, dt = 2: h00 = 27/32, h10 = 9/64, h01 = 5/32, h11 = -3/64.
  EXPECT_DOUBLE_EQ(sample1(c, 1.5), 10 * 27.0 / 32 + 2 * 4 * 9.0 / 64 + 20 * 5.0 / 32 + 2 * -2 * -3.0 / 64);
  EXPECT_DOUBLE_EQ(sample1(c, 2), 15 + 2 * (4.0 / 8 + 2.0 / 8));
}

TEST(Sampling, OfEqualKeysTheLastStands) {
  const auto c = channel(light_value, Interpolation::linear, 1, {0, 1, 1, 1, 2}, {0, 10, 20, 30, 40});
  EXPECT_NEAR(sample1(c, std::nextafter(1.0, 0.0)), 10, 1e-9);
  EXPECT_EQ(sample1(c, 1), 30);
  EXPECT_DOUBLE_EQ(sample1(c, 1.5), 35);
  EXPECT_EQ(sample1(channel(light_value, Interpolation::cubic_spline, 1, {1, 1}, {0, 5, 0, 0, 7, 0}), 1), 7);
}

TEST(Sampling, ASingleKeyHoldsForAllTime) {
  for (Interpolation i : {Interpolation::linear, Interpolation::step, Interpolation::cubic_spline}) {
    const auto c = channel(light_value, i, 1, {2}, {7, 7, 7});
    for (double time : {-1.0, 2.0, 3.0}) EXPECT_EQ(sample1(c, time), 7);
  }
}

TEST(Sampling, RotationsTurnAtConstantSpeedOnTheShorterArc) {
  const double pi = std::numbers::pi;
  const auto c = channel(TargetPath::node_rotation, Interpolation::linear, 4, {0, 1}, about_z({0, pi * 2 / 3}));
  EXPECT_NEAR(angle_about_z(sample_rotation(c, 0.25)), pi / 6, 1e-7);
  EXPECT_NEAR(glm::length(sample_rotation(c, 0.25)), 1, 1e-15);

  auto negated = c;  // the same rotation as its antipode
  for (size_t i = 4; i < 8; ++i) negated.values[i] = -negated.values[i];
  EXPECT_NEAR(angle_about_z(sample_rotation(negated, 0.25)), pi / 6, 1e-7);

  // Nearly equal keys: the straight line is taken, and differs from the arc by less than 1e-6 rad.
  const auto near = channel(TargetPath::node_rotation, Interpolation::linear, 4, {0, 1}, about_z({0, 0.06}));
  EXPECT_NEAR(angle_about_z(sample_rotation(near, 0.25)), 0.015, 1e-6);
}

TEST(Sampling, AntipodalKeysAreTheSameRotation) {
  auto c = channel(TargetPath::node_rotation, Interpolation::linear, 4, {0, 1}, {0, 0, 0, 1, 0, 0, 0, -1});
  EXPECT_NEAR(std::abs(sample_rotation(c, 0.5).w), 1, 1e-15);
}

TEST(Sampling, CubicRotationsAreUnitAndAVanishingOneFallsBackToItsKey) {
  auto c = channel(TargetPath::node_rotation, Interpolation::cubic_spline, 4, {0, 1},
                   {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0});
  EXPECT_NEAR(glm::length(sample_rotation(c, 0.3)), 1, 1e-15);
  // Values w = 1 and w = -1 with no tangents cancel halfway.
  auto zero = channel(TargetPath::node_rotation, Interpolation::cubic_spline, 4, {0, 1},
                      {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0});
  EXPECT_EQ(sample_rotation(zero, 0.5), glm::dquat(1, 0, 0, 0));
  // A key that is no rotation turns nothing.
  auto nothing = channel(TargetPath::node_rotation, Interpolation::step, 4, {0}, {0, 0, 0, 0});
  EXPECT_EQ(sample_rotation(nothing, 0), glm::dquat(1, 0, 0, 0));
}

// Node 1 hangs on node 0; both are animated or animatable.
Scene two_nodes() {
  Scene scene;
  scene.nodes.resize(3);
  scene.nodes[1].parent = 0;
  scene.nodes[0].children = {1};
  scene.nodes[2].translation = {5, 5, 5};  // not in the scene
  scene.roots = {0};
  scene.order = {0, 1};
  return scene;
}

Pose pose_at(Scene& scene, std::vector<AnimationChannel> channels, double time) {
  scene.animations = {{"a", std::move(channels), 1}};
  return evaluate_pose(scene, {{0}}, time);
}

TEST(Pose, ComposesParentsInDouble) {
  Scene scene = two_nodes();
  scene.nodes[0].translation = {1e6, 0, 0};
  scene.nodes[0].scale = {2, 2, 2};
  const double angle = std::numbers::pi / 2;
  scene.nodes[0].rotation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
  scene.nodes[1].translation = {1e-4, 0, 0};
  const Pose pose = evaluate_pose(scene, {}, 0);
  const glm::dvec4 p = pose.world_from_node[1][3];
  EXPECT_NEAR(p.x, 1e6, 1e-9);
  EXPECT_NEAR(p.y, 2e-4, 1e-15);
  EXPECT_EQ(pose.world_from_node[2], glm::dmat4(1.0));
  EXPECT_TRUE(pose.node_visible[1]);
  EXPECT_FALSE(pose.node_visible[2]);
}

TEST(Pose, LongChainsNeedNoRecursion) {
  Scene scene;
  const int count = 200000;
  scene.nodes.resize(count);
  for (int n = 0; n < count; ++n) {
    scene.nodes[size_t(n)].parent = n - 1;
    scene.nodes[size_t(n)].translation = {1, 0, 0};
    scene.order.push_back(n);
  }
  EXPECT_EQ(evaluate_pose(scene, {}, 0).world_from_node.back()[3].x, count);
}

TEST(Pose, ScaleToZeroAndMatricesStand) {
  Scene scene = two_nodes();
  scene.nodes[0].has_matrix = true;
  scene.nodes[0].matrix = glm::dmat4(-1.0);
  scene.nodes[0].matrix[3] = {1, 2, 3, 1};
  scene.nodes[1].scale = {0, 0, 0};
  const Pose pose = pose_at(scene, {channel(TargetPath::node_translation, Interpolation::step, 3, {0}, {9, 9, 9})}, 0);
  EXPECT_EQ(pose.world_from_node[0], scene.nodes[0].matrix);
  EXPECT_EQ(pose.world_from_node[1][3], glm::dvec4(1, 2, 3, 1));
  ASSERT_EQ(pose.warnings.size(), 1u);
  EXPECT_NE(pose.warnings[0].find("/nodes/0"), std::string::npos);
}

TEST(Pose, LaterAnimationsInFileOrderWin) {
  Scene scene = two_nodes();
  scene.animations = {{"a", {channel(TargetPath::node_translation, Interpolation::step, 3, {0}, {1, 0, 0})}, 0},
                      {"b", {channel(TargetPath::node_translation, Interpolation::step, 3, {0}, {2, 0, 0})}, 0}};
  EXPECT_EQ(evaluate_pose(scene, {{1, 0}}, 0).world_from_node[0][3].x, 2);
  EXPECT_EQ(evaluate_pose(scene, {{0}}, 0).world_from_node[0][3].x, 1);
  EXPECT_EQ(evaluate_pose(scene, {}, 0).world_from_node[0][3].x, 0);
}

TEST(Pose, AnimationsAreChosenByNameIndexAllOrNone) {
  Scene scene;
  scene.animations = {{"walk", {}, 0}, {"run", {}, 0}};
  EXPECT_EQ(choose_animations(scene, "all")->animations, (std::vector<int>{0, 1}));
  EXPECT_TRUE(choose_animations(scene, "none")->animations.empty());
  EXPECT_EQ(choose_animations(scene, "run")->animations, std::vector<int>{1});
  EXPECT_EQ(choose_animations(scene, "0")->animations, std::vector<int>{0});
  for (const char* bad : {"fly", "2", "-1", "1x", ""}) {
    const auto chosen = choose_animations(scene, bad);
    ASSERT_FALSE(chosen) << bad;
    EXPECT_EQ(chosen.error().kind, ErrorKind::usage);
    EXPECT_NE(chosen.error().message.find("'run'"), std::string::npos);
  }
}

// In file order each animation plays unless it touches what one before it that plays touches.
TEST(Pose, AutoLeavesOutWhatMovesTheSameThings) {
  using enum TargetPath;
  const auto drives = [](TargetPath path, int object, int element = -1) {
    AnimationChannel c = channel(path, Interpolation::linear, 3, {0, 2}, {0, 0, 0, 1, 1, 1});
    c.object = object, c.element = element;
    return c;
  };
  Scene scene = two_nodes();
  scene.animations = {{"walk", {drives(node_translation, 0), drives(node_rotation, 0)}, 2},
                      {"run", {drives(node_scale, 1), drives(node_rotation, 0)}, 3},  // touches what walk does
                      {"wave", {drives(node_scale, 1)}, 4},                           // what run alone touches
                      {"one weight", {drives(node_weights, 1, 0)}, 1},
                      {"the other", {drives(node_weights, 1, 1)}, 1},
                      {"all weights", {drives(node_weights, 1)}, 1}};
  EXPECT_EQ(choose_animations(scene, "auto")->animations, (std::vector<int>{0, 2, 3, 4}));
  EXPECT_EQ(clips_end_s(scene, *choose_animations(scene, "auto")), 4);
  const std::string note = clip_note(scene, "auto");
  EXPECT_NE(note.find("2 of 6 animations do not play"), std::string::npos) << note;
  EXPECT_NE(note.find("'run' (3.00 s), 'all weights' (1.00 s)"), std::string::npos) << note;
  EXPECT_NE(clip_note(scene, "all").find("3 of 6 animations move what one before them moves"), std::string::npos)
      << clip_note(scene, "all");
  EXPECT_EQ(clip_note(scene, "walk"), "");
  const auto clips = clip_facts(scene, "auto");
  ASSERT_TRUE(clips);
  EXPECT_FALSE((*clips)[1].plays);
  EXPECT_EQ((*clips)[1].with, 0);
  EXPECT_EQ((*clips)[1].targets, 2);
  EXPECT_EQ((*clips)[2].conflicts, 0);
}

TEST(Pose, WeightsComeFromNodeMeshOrAnimation) {
  Scene scene = two_nodes();
  scene.meshes.resize(1);
  scene.meshes[0].sections.resize(1);
  scene.meshes[0].sections[0].morph.resize(3);
  scene.meshes[0].default_weights = {0.5f, 0.25f};  // one short
  scene.nodes[0].mesh = scene.nodes[1].mesh = 0;
  scene.nodes[1].weights = {1, 2, 3};
  const Pose still = evaluate_pose(scene, {}, 0);
  EXPECT_EQ(still.node_weights[0], (std::vector<float>{0.5f, 0.25f, 0}));
  EXPECT_EQ(still.node_weights[1], (std::vector<float>{1, 2, 3}));
  const Pose moved =
      pose_at(scene,
              {channel(TargetPath::node_weights, Interpolation::linear, 3, {0, 1}, {0, 0, 0, 1, 2, 4}, 0),
               channel(TargetPath::node_weights, Interpolation::step, 1, {0}, {9}, 1, 2)},
              0.25);
  EXPECT_EQ(moved.node_weights[0], (std::vector<float>{0.25f, 0.5f, 1}));
  EXPECT_EQ(moved.node_weights[1], (std::vector<float>{1, 2, 9}));
}

TEST(Pose, VisibilityComesFromAncestorsToo) {
  Scene scene = two_nodes();
  const auto blink = [&](double time) {
    return pose_at(scene, {channel(TargetPath::node_visible, Interpolation::step, 1, {0, 1}, {1, 0})}, time);
  };
  EXPECT_TRUE(blink(0.5).node_visible[1]);
  EXPECT_FALSE(blink(1).node_visible[0]);
  EXPECT_FALSE(blink(1).node_visible[1]);
}

TEST(Pointers, DriveMaterialsTexturesLightsAndCameras) {
  Scene scene = two_nodes();
  scene.materials.resize(1);
  scene.lights.resize(1);
  scene.cameras.resize(1);
  using enum TargetPath;
  const auto linear = Interpolation::linear;
  const int normal = int(TextureSlotName::normal);
  const Pose pose =
      pose_at(scene,
              {channel(material_base_color, linear, 4, {0, 1}, {0, 0, 0, 0, 1, 0.5f, 0, 1}),
               channel(material_base_color, linear, 1, {0, 1}, {1, 0.5f}, 0, 3),
               channel(material_metallic, linear, 1, {0, 1}, {1, 0}),
               channel(material_emissive, linear, 3, {0, 1}, {0, 0, 0, 1, 0, 1}),
               channel(material_emissive_strength, linear, 1, {0, 1}, {0, 100}),
               channel(material_specular_color, linear, 3, {0, 1}, {0, 0, 0, 4, 4, 4}),
               channel(texture_offset, linear, 2, {0, 1}, {0, 0, 1, 2}, 0, normal),
               channel(texture_scale, linear, 2, {0, 1}, {1, 1, -1, 3}, 0, normal),
               channel(texture_rotation, linear, 1, {0, 1}, {0, 3}, 0, normal),
               channel(light_color, linear, 3, {0, 1}, {0, 0, 0, 1, 1, 1}),
               channel(light_intensity, linear, 1, {0, 1}, {0, 1000}), channel(light_range, linear, 1, {0, 1}, {1, 3}),
               channel(camera_yfov, Interpolation::cubic_spline, 1, {0, 1}, {0, 1, 0, 0, 2, 0}),
               channel(camera_xmag, linear, 1, {0, 1}, {2, 4})},
              0.5);
  const Material& m = pose.materials[0];
  EXPECT_EQ(m.base_color, glm::vec4(0.5f, 0.25f, 0, 0.75f));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.emissive, glm::vec3(0.5f, 0, 0.5f));
  EXPECT_EQ(m.emissive_strength, 50);
  EXPECT_EQ(m.specular_color, glm::vec3(2));
  EXPECT_EQ(m.normal_texture.offset, glm::vec2(0.5f, 1));
  EXPECT_EQ(m.normal_texture.scale, glm::vec2(0, 2));
  EXPECT_EQ(m.normal_texture.rotation_rad, 1.5f);
  EXPECT_EQ(m.base_color_texture.offset, glm::vec2(0));
  EXPECT_EQ(pose.lights[0].color, glm::vec3(0.5f));
  EXPECT_EQ(pose.lights[0].intensity, 500);
  EXPECT_EQ(pose.lights[0].range_m, 2);
  EXPECT_EQ(pose.cameras[0].yfov_rad, 1.5);
  EXPECT_EQ(pose.cameras[0].xmag, 3);
  EXPECT_TRUE(pose.warnings.empty());
  EXPECT_EQ(scene.materials[0].metallic, 1);  // the scene is not touched
}

TEST(Pointers, ValuesOutsideTheirRangeAreClampedWithAWarning) {
  Scene scene = two_nodes();
  scene.materials.resize(1);
  scene.lights.resize(1);
  scene.lights[0].name = "Torch";
  scene.lights[0].type = LightType::spot;
  const float infinity = std::numeric_limits<float>::infinity();
  using enum TargetPath;
  const auto step = Interpolation::step;
  const Pose pose =
      pose_at(scene,
              {channel(light_intensity, step, 1, {0}, {-3}), channel(material_roughness, step, 1, {0}, {1.5f}),
               channel(material_ior, step, 1, {0}, {0.5f}), channel(light_inner_cone, step, 1, {0}, {1.2f}),
               channel(material_metallic, step, 1, {0}, {infinity})},
              0);
  EXPECT_EQ(pose.lights[0].intensity, 0);
  EXPECT_EQ(pose.materials[0].roughness, 1);
  EXPECT_EQ(pose.materials[0].ior, 1);
  EXPECT_EQ(pose.materials[0].metallic, 1);  // the file's own value
  EXPECT_EQ(pose.lights[0].inner_cone_rad, pose.lights[0].outer_cone_rad);
  EXPECT_EQ(pose.warnings.size(), 5u);
  EXPECT_TRUE(test::mentions(pose.warnings, "/extensions/KHR_lights_punctual/lights/0 'Torch' intensity"));
  EXPECT_TRUE(test::mentions(pose.warnings, "/extensions/KHR_lights_punctual/lights/0 'Torch' innerConeAngle"));
  for (const std::string& warning : pose.warnings)
    EXPECT_NE(warning.find("animation 'a'"), std::string::npos) << warning;
  EXPECT_EQ(pose_at(scene, {channel(light_intensity, step, 1, {0}, {infinity})}, 0).lights[0].intensity, 0);
  EXPECT_EQ(pose_at(scene, {channel(material_ior, step, 1, {0}, {0})}, 0).materials[0].ior, 0);  // has its own meaning
}

// What an earlier time left is not seen, whatever the order of times.
TEST(PosedParts, APoseThatIsEvaluatedAgainIsTheOneOfThatTime) {
  Scene scene = two_nodes();
  scene.materials.resize(2), scene.lights.resize(2), scene.cameras.resize(1);
  scene.materials[1].roughness = 0.25f;
  scene.lights[0].type = LightType::spot;
  scene.nodes[0].mesh = 0, scene.nodes[0].weights = {0.5f, 0.25f};
  scene.meshes.resize(1);
  scene.meshes[0].sections.resize(1);
  scene.meshes[0].sections[0].morph.resize(2);
  using enum TargetPath;
  const auto linear = Interpolation::linear, step = Interpolation::step;
  scene.animations = {
      {"a",
       {channel(node_translation, linear, 3, {1, 2}, {1, 0, 0, 3, 0, 0}),
        channel(node_visible, step, 1, {2, 3}, {1, 0}), channel(node_rotation, linear, 4, {0, 4}, about_z({0, 1}), 1),
        channel(node_weights, linear, 1, {2, 3}, {0, 1}, 0, 1),
        channel(material_roughness, linear, 1, {0, 1}, {0, 0.5f}),
        channel(light_intensity, step, 1, {0, 2, 3}, {5, -3, 7}),
        channel(light_outer_cone, linear, 1, {3, 4}, {0.5f, 0.1f}), channel(light_inner_cone, step, 1, {0}, {0.2f}),
        channel(camera_yfov, linear, 1, {1, 3}, {0.5f, 1})},
       4}};
  const PosedParts parts = posed_parts(scene, {{0}});
  PoseState state;
  Pose again;
  size_t warned = 0;
  for (const double t : {0.0, 0.5, 1.5, 1.6, 3.5, 3.9, 5.0, 6.0, 2.5, 2.6, 1.0, 0.0, 9.0, 9.5}) {
    evaluate_pose(scene, parts, t, state, again);
    const Pose alone = evaluate_pose(scene, {{0}}, t);
    EXPECT_EQ(again.time_s, t);
    EXPECT_EQ(again.world_from_node, alone.world_from_node) << t;
    EXPECT_EQ(again.node_visible, alone.node_visible) << t;
    EXPECT_EQ(again.node_weights, alone.node_weights) << t;
    for (size_t m = 0; m < 2; ++m) EXPECT_EQ(again.materials[m].roughness, alone.materials[m].roughness) << t;
    for (size_t l = 0; l < 2; ++l) {
      EXPECT_EQ(again.lights[l].intensity, alone.lights[l].intensity) << t;
      EXPECT_EQ(again.lights[l].inner_cone_rad, alone.lights[l].inner_cone_rad) << t;
      EXPECT_EQ(again.lights[l].outer_cone_rad, alone.lights[l].outer_cone_rad) << t;
    }
    EXPECT_EQ(again.cameras[0].yfov_rad, alone.cameras[0].yfov_rad) << t;
    EXPECT_EQ(again.warnings, alone.warnings) << t;
    warned += alone.warnings.size();
  }
  EXPECT_GT(warned, 4u) << "cones and an intensity below zero are told of at each time";
}

}  // namespace
TEST(MovingNodes, AreThoseThatPlayWithWhatHangsOnThem) {
  Scene scene;
  scene.nodes.resize(8);
  scene.order = {0, 1, 2, 3, 4, 5, 6, 7};
  scene.nodes[1].parent = 0, scene.nodes[2].parent = 1;
  scene.nodes[6].skin = 0, scene.nodes[7].skin = 1;
  scene.skins = {{.name = {}, .joints = {4, 2}, .inverse_bind = {}}, {.name = {}, .joints = {4}, .inverse_bind = {}}};
  const auto moves = [](TargetPath path, int object) {
    return channel(path, Interpolation::linear, 3, {}, {}, object);
  };
  scene.animations = {{.name = {}, .channels = {moves(TargetPath::node_rotation, 1)}},
                      {.name = {}, .channels = {moves(TargetPath::node_weights, 3), moves(TargetPath::light_color, 5)}},
                      {.name = {}, .channels = {moves(TargetPath::node_visible, 5)}}};
  const auto moving = [&](std::vector<int> animations) {
    std::vector<int> nodes;
    const std::vector<bool> all = moving_nodes(scene, {std::move(animations)});
    for (int n = 0; n < int(all.size()); ++n)
      if (all[size_t(n)]) nodes.push_back(n);
    return nodes;
  };
  EXPECT_EQ(moving({}), std::vector<int>{});
  EXPECT_EQ(moving({0}), (std::vector<int>{1, 2, 6}));
  EXPECT_EQ(moving({1}), std::vector<int>{3});
  EXPECT_EQ(moving({0, 2}), (std::vector<int>{1, 2, 5, 6}));
}

}  // namespace candela
