#include "scene/frame_data.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "math/transforms.h"
#include "scene/deformation_bounds.h"

namespace candela {
namespace {

using Random = std::mt19937;
double uniform(Random& random, double low, double high) {
  return low + (high - low) * (double(random() >> 5) / double(1 << 27));
}
glm::dvec3 uniform3(Random& random, double low, double high) {
  return {uniform(random, low, high), uniform(random, low, high), uniform(random, low, high)};
}
glm::dmat4 random_affine(Random& random, double reach) {
  const glm::dquat q =
      glm::normalize(glm::dquat(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), 0.1));
  return compose_trs(uniform3(random, -reach, reach), q, uniform3(random, -2, 2));
}

MeshSection triangle() {
  MeshSection s;
  s.position = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  s.normal.assign(3, {0, 0, 1});
  s.index = {0, 1, 2};
  for (glm::vec3 p : s.position) s.bounds.add(p);
  return s;
}

// A tree of nodes; parents are made before their children.
struct Builder {
  Scene scene;
  int add(int parent, glm::dvec3 translation, int mesh = -1) {
    Node node;
    node.parent = parent;
    node.translation = translation;
    node.mesh = mesh;
    scene.nodes.push_back(node);
    scene.order.push_back(int(scene.nodes.size()) - 1);
    return scene.order.back();
  }
  int add_mesh(std::vector<MeshSection> sections) {
    scene.meshes.push_back({"", std::move(sections), {}});
    return int(scene.meshes.size()) - 1;
  }
  FrameData frame(const View& view = {}) const { return make_frame_data(scene, evaluate_pose(scene, {}, 0), view); }
};

bool holds(const Aabb& box, glm::vec3 p) {
  return glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max));
}

TEST(FrameData, OneItemForEachSectionOfEachVisibleInstance) {
  Builder b;
  MeshSection empty = triangle();
  empty.index.clear();
  const int mesh = b.add_mesh({triangle(), empty, triangle()});
  b.scene.meshes[0].sections[2].material = 3;
  const int root = b.add(-1, {0, 0, -5}, mesh);
  const int hidden = b.add(root, {1, 0, 0}, mesh);
  b.add(hidden, {1, 0, 0}, mesh);
  b.scene.nodes[size_t(hidden)].visible = false;
  const int many = b.add(-1, {0, 10, 0}, mesh);
  Instances instances;
  instances.count = 2;
  instances.translation = {{1, 0, 0}, {2, 0, 0}};
  instances.scale = {{1, 1, 1}, {-1, 1, 1}};
  b.scene.nodes[size_t(many)].instances = std::make_shared<const Instances>(instances);

  const FrameData frame = b.frame();
  ASSERT_EQ(frame.items.size(), 6u);
  EXPECT_EQ(frame.items[0].material, -1);
  EXPECT_EQ(frame.items[1].material, 3);
  EXPECT_EQ(frame.items[0].transform, frame.items[1].transform);
  EXPECT_EQ(frame.items[1].section, 2u);
  EXPECT_NEAR(frame.items[0].view_depth_m, 5, 1e-5);
  EXPECT_EQ(frame.items[5].node, uint32_t(many));
  EXPECT_EQ(frame.items[5].instance, 1u);
  EXPECT_FALSE(frame.items[3].mirrored);
  EXPECT_TRUE(frame.items[5].mirrored);
  const glm::mat4 m = frame.relative_from_local[frame.items[5].transform];
  EXPECT_EQ(glm::vec3(m * glm::vec4(1, 0, 0, 1)), glm::vec3(1, 10, 0));
  EXPECT_EQ(frame.relative_from_local.size(), 3u);
}

// The scene at the origin and 1,000 km away: what the device sees is the same to within the rounding of one cast.
TEST(FrameData, AMovedWorldGivesTheSameRelativeNumbers) {
  const auto build = [](glm::dvec3 offset) {
    Random random(5);
    Builder b;
    const int mesh = b.add_mesh({triangle()});
    const int root = b.add(-1, offset);
    b.scene.lights.resize(1);
    for (int i = 0; i < 200; ++i) {
      const int node = b.add(root, uniform3(random, -50, 50), mesh);
      b.scene.nodes[size_t(node)].scale = uniform3(random, -2, 2);
      b.scene.nodes[size_t(node)].rotation = glm::dquat(uniform(random, -1, 1), uniform(random, -1, 1), 0.3, 0.1);
      b.scene.nodes[size_t(node)].light = 0;
    }
    View view;
    view.position = offset + glm::dvec3(0.123, 4.56, 7.89);
    return b.frame(view);
  };
  const FrameData here = build({}), there = build({1e6, -1e6, 1e6});
  ASSERT_EQ(here.items.size(), there.items.size());
  for (size_t i = 0; i < here.relative_from_local.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) {
        const float a = here.relative_from_local[i][c][r], d = there.relative_from_local[i][c][r];
        // One unit in the last place of float, and what double leaves of 1e6 m: 2^-33.
        EXPECT_LE(std::abs(double(a) - double(d)), std::abs(a) * 1.2e-7 + 5e-10);
      }
    }
  }
  for (size_t i = 0; i < here.lights.size(); ++i)
    EXPECT_LT(glm::length(here.lights[i].position - there.lights[i].position), 1e-5);
}

// A section whose vertices hang on four to eight of the joints with random weights.
MeshSection random_skinned(Random& random, uint32_t joints, size_t targets, bool second_set) {
  MeshSection s;
  s.morph.resize(targets);
  for (int v = 0; v < 60; ++v) {
    s.position.emplace_back(uniform3(random, -1, 1));
    s.bounds.add(s.position.back());
    for (MorphTarget& t : s.morph) t.position.emplace_back(uniform3(random, -1, 1));
    float weights[8] = {}, sum = 0;
    for (int i = 0; i < (second_set ? 8 : 4); ++i)
      sum += weights[i] = random() % 3 ? float(uniform(random, 0, 1)) : 0.0f;
    if (sum == 0) weights[0] = sum = 1;
    for (float& w : weights) w /= sum;
    const auto pick = [&] { return uint16_t(random() % joints); };
    s.joints0.emplace_back(pick(), pick(), pick(), pick());
    s.weights0.emplace_back(weights[0], weights[1], weights[2], weights[3]);
    if (!second_set) continue;
    s.joints1.emplace_back(pick(), pick(), pick(), pick());
    s.weights1.emplace_back(weights[4], weights[5], weights[6], weights[7]);
  }
  s.index = {0, 1, 2};
  return s;
}

// As the device does it: float sums of morphs, then the blended float matrix.
glm::vec3 deformed(const MeshSection& s, size_t v, const FrameData& frame, const Deformation& d,
                   const glm::mat4& transform) {
  glm::vec3 p = s.position[v];
  for (uint32_t t = 0; t < d.weight_count; ++t) p += frame.morph_weights[d.first_weight + t] * s.morph[t].position[v];
  if (d.joint_count == 0) return glm::vec3(transform * glm::vec4(p, 1));
  glm::mat4 m(0.0f);
  for (int i = 0; i < 4; ++i) m += s.weights0[v][i] * frame.joint_matrices[d.first_joint + s.joints0[v][i]];
  if (!s.joints1.empty())
    for (int i = 0; i < 4; ++i) m += s.weights1[v][i] * frame.joint_matrices[d.first_joint + s.joints1[v][i]];
  return glm::vec3(m * glm::vec4(p, 1));
}

Scene random_skinned_scene(Random& random, bool second_set, size_t targets) {
  Builder b;
  const uint32_t joints = 12;
  b.add_mesh({random_skinned(random, joints, targets, second_set)});
  const int node = b.add(-1, {1000, 1000, 1000}, 0);  // the node's own place must not matter
  Skin skin;
  for (uint32_t j = 0; j < joints; ++j) {
    const int joint = b.add(-1, {});
    b.scene.nodes[size_t(joint)].has_matrix = true;
    b.scene.nodes[size_t(joint)].matrix = random_affine(random, 30);
    skin.joints.push_back(joint);
    skin.inverse_bind.push_back(random_affine(random, 3));
  }
  b.scene.skins = {skin};
  b.scene.nodes[size_t(node)].skin = 0;
  for (size_t t = 0; t < targets; ++t) b.scene.nodes[size_t(node)].weights.push_back(float(uniform(random, -2, 2)));
  return b.scene;
}

TEST(FrameData, SkinnedBoundsHoldEveryVertexOfRandomSkins) {
  Random random(11);
  for (int round = 0; round < 200; ++round) {
    Scene scene = random_skinned_scene(random, round % 2, round % 3 ? size_t(round % 4) : 0);
    if (round % 5) prepare_deformation_bounds(scene);
    const Pose pose = evaluate_pose(scene, {}, 0);
    View view;
    view.position = uniform3(random, -1e4, 1e4);
    const FrameData frame = make_frame_data(scene, pose, view);
    ASSERT_EQ(frame.items.size(), 1u);
    const DrawItem& item = frame.items[0];
    ASSERT_EQ(item.deformed, 0);
    EXPECT_EQ(frame.relative_from_local[item.transform], glm::mat4(1.0f));
    const MeshSection& s = scene.meshes[0].sections[0];
    const DAabb world = world_bounds(scene, pose);
    Aabb tight;
    for (size_t v = 0; v < s.position.size(); ++v) {
      const glm::vec3 p = deformed(s, v, frame, frame.deformations[0], glm::mat4(1.0f));
      tight.add(p);
      EXPECT_TRUE(holds(item.bounds_relative, p)) << "round " << round << " vertex " << v;
      const glm::dvec3 w = glm::dvec3(p) + view.position;
      EXPECT_TRUE(glm::all(glm::lessThan(w, world.max + 0.02)) && glm::all(glm::greaterThan(w, world.min - 0.02)));
    }
    EXPECT_LT(glm::length(item.bounds_relative.max - item.bounds_relative.min), 1000);  // and say something
  }
}

TEST(FrameData, MorphedBoundsHoldAndStayInLocalSpace) {
  Random random(12);
  for (int round = 0; round < 100; ++round) {
    Builder b;
    MeshSection section = random_skinned(random, 4, 1 + size_t(round % 5), false);
    section.joints0.clear(), section.weights0.clear();
    b.add_mesh({section, section});
    const int node = b.add(-1, uniform3(random, -100, 100), 0);
    b.scene.nodes[size_t(node)].rotation = glm::dquat(0.3, 0.4, 0.5, 0.6);
    for (size_t t = 0; t < section.morph.size(); ++t)
      b.scene.nodes[size_t(node)].weights.push_back(float(uniform(random, -3, 3)));
    const FrameData frame = b.frame();
    ASSERT_EQ(frame.items.size(), 2u);
    EXPECT_EQ(frame.morph_weights.size(), section.morph.size());  // shared by the sections
    const DrawItem& item = frame.items[1];
    const Deformation& d = frame.deformations[size_t(item.deformed)];
    EXPECT_EQ(d.joint_count, 0u);
    EXPECT_EQ(d.section, 1u);
    for (size_t v = 0; v < section.position.size(); ++v)
      EXPECT_TRUE(
          holds(item.bounds_relative, deformed(section, v, frame, d, frame.relative_from_local[item.transform])));
  }
}

TEST(FrameData, RigidBoundsHoldWithFloatRounding) {
  Random random(13);
  for (int round = 0; round < 2000; ++round) {
    Builder b;
    MeshSection section = triangle();
    section.bounds = {};
    for (glm::vec3& p : section.position) section.bounds.add(p = glm::vec3(uniform3(random, 999, 1000)));
    b.add_mesh({section});
    const int node = b.add(-1, {}, 0);
    b.scene.nodes[size_t(node)].has_matrix = true;
    b.scene.nodes[size_t(node)].matrix = random_affine(random, 1e5);
    const FrameData frame = b.frame();
    for (glm::vec3 p : section.position)
      EXPECT_TRUE(holds(frame.items[0].bounds_relative, glm::vec3(frame.relative_from_local[0] * glm::vec4(p, 1))));
  }
}

TEST(FrameData, WeightsOfZeroThatNothingDrivesLeaveTheStaticVertices) {
  Builder b;
  MeshSection section = triangle();
  section.morph.resize(1);
  section.morph[0].position.assign(3, glm::vec3(1));
  b.add_mesh({section});
  b.add(-1, {}, 0);
  EXPECT_EQ(b.frame().items[0].deformed, -1);
  AnimationChannel channel;
  channel.path = TargetPath::node_weights;
  channel.object = 0;
  b.scene.animations = {{"smile", {channel}, 0}};
  EXPECT_EQ(b.frame().items[0].deformed, 0);  // it may be non-zero in another frame of the sequence
}

TEST(FrameData, WhatCannotBeBoundedIsNeverCulled) {
  Builder b;
  b.add_mesh({triangle()});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int kind = 0; kind < 3; ++kind) {
    const int node = b.add(-1, {}, 0);
    b.scene.nodes[size_t(node)].has_matrix = true;
    glm::dmat4& m = b.scene.nodes[size_t(node)].matrix;
    if (kind == 0) m[1][1] = nan;
    if (kind == 1) m[2][3] = 1;  // projective
    if (kind == 2) m[3][0] = 1e300;
  }
  const FrameData frame = b.frame();
  ASSERT_EQ(frame.items.size(), 3u);
  for (const DrawItem& item : frame.items) {
    EXPECT_EQ(item.bounds_relative.max, glm::vec3(std::numeric_limits<float>::infinity()));
    EXPECT_EQ(item.bounds_relative.min, glm::vec3(-std::numeric_limits<float>::infinity()));
    EXPECT_EQ(item.view_depth_m, 0);
  }
  EXPECT_TRUE(world_bounds(b.scene, evaluate_pose(b.scene, {}, 0)).empty());
}

TEST(FrameData, SkinsAreSharedWinOverInstancingAndNeedTheirJoints) {
  Random random(3);
  Scene scene = random_skinned_scene(random, false, 0);
  scene.meshes[0].sections.push_back(triangle());  // not skinned: stays with its node
  Node second = scene.nodes[0];
  Instances instances;
  instances.count = 3;
  instances.translation = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  second.instances = std::make_shared<const Instances>(instances);
  scene.nodes.push_back(second);
  scene.order.push_back(int(scene.nodes.size()) - 1);
  const FrameData frame = make_frame_data(scene, evaluate_pose(scene, {}, 0), {});
  ASSERT_EQ(frame.items.size(), 6u);  // skinned and rigid; skinned once and rigid three times
  EXPECT_EQ(frame.joint_matrices.size(), 12u);
  EXPECT_EQ(frame.deformations.size(), 2u);
  EXPECT_EQ(frame.items[1].deformed, -1);
  EXPECT_EQ(frame.relative_from_local[frame.items[1].transform][3], glm::vec4(1000, 1000, 1000, 1));

  scene.skins[0].joints.resize(2);  // vertices name joints that are not there
  const FrameData broken = make_frame_data(scene, evaluate_pose(scene, {}, 0), {});
  for (const DrawItem& item : broken.items) EXPECT_EQ(item.deformed, -1);
}

TEST(FrameData, ASkinIsMirroredWhenItsJointsAre) {
  Builder b;
  MeshSection section = triangle();
  section.joints0.assign(3, {0, 0, 0, 0});
  section.weights0.assign(3, {1, 0, 0, 0});
  b.add_mesh({section});
  const int node = b.add(-1, {}, 0), joint = b.add(-1, {});
  b.scene.skins = {{"", {joint}, {glm::dmat4(1.0)}}};
  b.scene.nodes[size_t(node)].skin = 0;
  EXPECT_FALSE(b.frame().items[0].mirrored);
  b.scene.nodes[size_t(node)].scale = {-1, 1, 1};
  EXPECT_FALSE(b.frame().items[0].mirrored);  // the node's transform does not reach the vertices
  b.scene.nodes[size_t(joint)].scale = {-1, 1, 1};
  EXPECT_TRUE(b.frame().items[0].mirrored);
}

TEST(FrameData, LightsShineAlongMinusZWhateverTheScale) {
  Builder b;
  b.scene.lights.resize(3);
  b.scene.lights[0].type = LightType::spot;
  b.scene.lights[0].color = {1, 0.5f, 0};
  b.scene.lights[0].intensity = 8;
  b.scene.lights[1].intensity = 0;
  b.scene.lights[2].color = {0, 0, 0};
  const int spot = b.add(-1, {1, 2, 3}), dark = b.add(-1, {}), black = b.add(-1, {}), hidden = b.add(-1, {}),
            flat = b.add(-1, {});
  b.scene.nodes[size_t(spot)].scale = {5, 0.1, 0.5};
  b.scene.nodes[size_t(spot)].rotation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // -z becomes +y
  b.scene.nodes[size_t(flat)].scale = {1, 1, 0};
  b.scene.nodes[size_t(hidden)].visible = false;
  for (int n : {spot, hidden, flat}) b.scene.nodes[size_t(n)].light = 0;
  b.scene.nodes[size_t(dark)].light = 1;
  b.scene.nodes[size_t(black)].light = 2;
  View view;
  view.position = {1, 0, 0};
  const FrameData frame = b.frame(view);
  ASSERT_EQ(frame.lights.size(), 2u);
  const LightItem& light = frame.lights[0];
  EXPECT_EQ(light.position, glm::vec3(0, 2, 3));
  EXPECT_NEAR(glm::length(light.direction - glm::vec3(0, 1, 0)), 0, 1e-6);
  EXPECT_EQ(light.intensity, glm::vec3(8, 4, 0));
  EXPECT_EQ(light.node, uint32_t(spot));
  EXPECT_EQ(frame.lights[1].direction, glm::vec3(0, 0, -1));
}

// A sun that has faded lights nothing, but its sky goes on from where it stands.
TEST(FrameData, TheFirstSunIsKnownWithoutItsLight) {
  Builder b;
  EXPECT_FALSE(b.frame().first_sun);
  b.scene.lights.resize(3);
  b.scene.lights[0].type = LightType::point;
  b.scene.lights[1].type = b.scene.lights[2].type = LightType::directional;
  b.scene.lights[1].intensity = 0;
  b.scene.lights[2].intensity = 5;
  for (int light = 0; light < 3; ++light) {
    const int node = b.add(-1, {});
    b.scene.nodes[size_t(node)].light = light;
    if (light == 1) b.scene.nodes[size_t(node)].rotation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // -z becomes +y
  }
  const FrameData frame = b.frame();
  EXPECT_EQ(frame.lights.size(), 2u);
  ASSERT_TRUE(frame.first_sun);
  EXPECT_EQ(frame.first_sun->intensity, glm::vec3(0));
  EXPECT_NEAR(glm::length(frame.first_sun->direction - glm::vec3(0, 1, 0)), 0, 1e-6);
}

TEST(FrameData, ManyItemsAndLightsAndTheSameInputGivesTheSameBytes) {
  Builder b;
  const int mesh = b.add_mesh({triangle()});
  b.scene.lights.resize(1);
  for (int i = 0; i < 100000; ++i) {
    b.add(-1, {i, 0, 0}, mesh);
    if (i < 65536) b.scene.nodes.back().light = 0;
  }
  const FrameData a = b.frame(), c = b.frame();
  EXPECT_EQ(a.items.size(), 100000u);
  EXPECT_EQ(a.lights.size(), 65536u);
  ASSERT_EQ(a.relative_from_local.size(), c.relative_from_local.size());
  EXPECT_EQ(std::memcmp(a.relative_from_local.data(), c.relative_from_local.data(),
                        a.relative_from_local.size() * sizeof(glm::mat4)),
            0);
  const DAabb bounds = world_bounds(b.scene, evaluate_pose(b.scene, {}, 0));
  EXPECT_NEAR(bounds.max.x, 100000, 0.1);
  EXPECT_NEAR(bounds.min.x, 0, 0.1);
}

}  // namespace
}  // namespace candela
