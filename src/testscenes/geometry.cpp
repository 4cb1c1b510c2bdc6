#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {

namespace {
using std::numbers::pi;

}  // namespace

void make_skinned(GlbWriter& out, SceneOptions&) {
  constexpr double height = 3, joint_gap = 1;
  std::vector<OutlinePoint> outline;
  constexpr int rings = 24;
  for (int j = 0; j <= rings; ++j) outline.push_back({0.3 - 0.1 * j / rings, height * j / rings, 1, 0.03});
  outline.push_back({0.2, height, 0, 1});
  outline.push_back({0, height, 0, 1});
  const Shape tube = lathe(outline, 16, {1, 4});
  json primitive = out.primitive(tube);

  std::vector<glm::u16vec4> joints;
  std::vector<double> weights;
  for (glm::dvec3 p : tube.position) {
    // Joints sit at heights 0, 1, 2; a vertex between two of them follows both.
    const double at = std::clamp(p.y / joint_gap - 0.5, 0.0, 2.0);
    const auto lower = uint16_t(std::min(std::floor(at), 1.0));
    const double t = smooth_step(0.2, 0.8, at - lower);
    joints.push_back(glm::u16vec4(t < 1 ? lower : 0, t > 0 ? lower + 1 : 0, 0, 0));  // unused slots name joint 0
    weights.insert(weights.end(), {1 - t, t, 0, 0});
  }
  primitive["attributes"]["JOINTS_0"] = out.joint_accessor(joints);
  primitive["attributes"]["WEIGHTS_0"] = out.float_accessor(weights, 4);
  const int stripes =
      out.texture("stripes", png_from(8, 64, 3, [](double, double v) {
                    return int(v * 4) % 2 ? glm::dvec4(0.9, 0.35, 0.15, 1) : glm::dvec4(0.95, 0.85, 0.6, 1);
                  }));
  const int mesh = out.mesh("tube", primitive, out.material("stripes", pbr_textured(stripes, 0, 0.5)));

  const int armature = out.node("armature", json::object());
  const int root = out.child(armature, "joint 0", json::object());
  const int middle = out.child(root, "joint 1", {{"translation", vector_json({0, joint_gap, 0})}});
  const int top = out.child(middle, "joint 2", {{"translation", vector_json({0, joint_gap, 0})}});
  std::vector<glm::dmat4> inverse_bind(3, glm::dmat4(1.0));
  for (int i = 0; i < 3; ++i) inverse_bind[size_t(i)][3] = glm::dvec4(0, -joint_gap * i, 0, 1);
  out.root["skins"] = json::array({{{"joints", {root, middle, top}},
                                    {"skeleton", root},
                                    {"inverseBindMatrices", out.mat4_accessor(inverse_bind)}}});
  out.node("tube", {{"mesh", mesh}, {"skin", 0}});

  const std::array times{0.0, 1.0, 2.0, 3.0, 4.0};
  for (int joint : {middle, top}) {
    std::vector<double> values;
    for (double angle : {0.0, 0.9, 0.0, -0.9, 0.0}) push(values, rotation_about({0.3, 0, 1}, angle));
    out.animate(joint, "rotation", "LINEAR", times, values, 4);
  }
  const int floor =
      out.mesh("floor", out.primitive(ground(8, 1, 1)), out.material("floor", pbr({0.35, 0.4, 0.4, 1}, 0, 0.8)));
  out.node("floor", {{"mesh", floor}});
  add_sun(out, {2, 3, 2}, {1, 1, 1}, 3);
  out.camera_node({0, 2, 6}, {0, 1.3, 0}, 0.7);
}

void make_morph(GlbWriter& out, SceneOptions&) {
  const Shape cube = box({1.2, 1.2, 1.2}, 8);
  json primitive = out.primitive(cube);
  std::vector<glm::dvec3> round_position, round_normal, twist_position, twist_normal;
  for (size_t i = 0; i < cube.position.size(); ++i) {
    const glm::dvec3 p = cube.position[i], n = cube.normal[i], outward = glm::normalize(p);
    round_position.push_back(outward * 0.8 - p);
    round_normal.push_back(outward - n);
    const glm::dquat turn = rotation_about({0, 1, 0}, p.y * 1.2);
    twist_position.push_back(turn * p - p);
    twist_normal.push_back(turn * n - n);
  }
  primitive["targets"] = json::array(
      {{{"POSITION", out.vec3_accessor(round_position, true)}, {"NORMAL", out.vec3_accessor(round_normal)}},
       {{"POSITION", out.vec3_accessor(twist_position, true)}, {"NORMAL", out.vec3_accessor(twist_normal)}}});
  const int texture = out.texture("checker", checker_png(32, 4, {0.1, 0.45, 0.5}, {0.85, 0.9, 0.85}));
  const int mesh = out.mesh("cube", primitive, out.material("checker", pbr_textured(texture, 0, 0.4)));
  out.root["meshes"][size_t(mesh)]["weights"] = {0, 0};
  out.root["meshes"][size_t(mesh)]["extras"] = {{"targetNames", {"round", "twist"}}};
  const int left = out.node("animated", {{"mesh", mesh}, {"translation", vector_json({-1, 0, 0})}});
  out.node("fixed weights", {{"mesh", mesh}, {"translation", vector_json({1, 0, 0})}, {"weights", {0.5, 0.75}}});
  const std::array times{0.0, 1.0, 2.0, 3.0};
  const std::array weights{0.0, 0.0, 1.0, 0.0, 0.5, 1.0, 0.0, 0.0};
  out.animate(left, "weights", "LINEAR", times, weights, 1);
  add_sun(out, {1, 2, 3}, {1, 0.95, 0.9}, 3);
  out.camera_node({0, 1.5, 4}, {0, 0, 0}, 0.75);
}

void make_instanced(GlbWriter& out, SceneOptions& options) {
  out.use_extension("EXT_mesh_gpu_instancing");
  constexpr int rows = 20, columns = 25;
  std::vector<double> translation, rotation, scale;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      Rng& rng = options.rng;
      const double height = rng.uniform(0.4, 2.2), width = rng.uniform(0.5, 0.9);
      const double x = column - (columns - 1) / 2.0 + rng.uniform(-0.15, 0.15), z = -row + rng.uniform(-0.15, 0.15);
      push(translation, glm::dvec3(x, height / 2, z));
      push(rotation, rotation_about({0, 1, 0}, rng.uniform(0, pi)));
      push(scale, glm::dvec3(width, height, width));
    }
  const int texture = out.texture("windows", png_from(32, 32, 3, [](double u, double v) {
                                    const bool window = std::fmod(u * 4, 1) > 0.35 && std::fmod(v * 6, 1) > 0.4;
                                    return window ? glm::dvec4(0.95, 0.8, 0.45, 1) : glm::dvec4(0.3, 0.32, 0.38, 1);
                                  }));
  const int mesh =
      out.mesh("block", out.primitive(box({0.8, 1, 0.8})), out.material("windows", pbr_textured(texture, 0, 0.7)));
  const json attributes = {{"TRANSLATION", out.float_accessor(translation, 3)},
                           {"ROTATION", out.float_accessor(rotation, 4)},
                           {"SCALE", out.float_accessor(scale, 3)}};
  out.node("field", {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
  const int floor =
      out.mesh("floor", out.primitive(ground(60, 1, 1)), out.material("floor", pbr({0.3, 0.33, 0.3, 1}, 0, 0.9)));
  out.node("floor", {{"mesh", floor}});
  add_sun(out, {2, 3, 1}, {1, 0.93, 0.82}, 3);
  out.camera_node({3, 5, 6}, {0, 0, -7}, 0.8);
}

void make_primitive_modes(GlbWriter& out, SceneOptions&) {
  constexpr int points = 0, lines = 1, line_loop = 2, line_strip = 3, triangles = 4, triangle_strip = 5,
                triangle_fan = 6;
  const auto colored = [](std::vector<glm::dvec3> position) {
    Shape shape;
    shape.position = std::move(position);
    for (size_t i = 0; i < shape.position.size(); ++i) {
      const double t = 2 * pi * double(i) / double(shape.position.size());
      shape.color.emplace_back(0.5 + 0.5 * std::cos(t), 0.5 + 0.5 * std::cos(t - 2.1), 0.5 + 0.5 * std::cos(t - 4.2),
                               1);
    }
    return shape;
  };
  const auto ring = [](int count, double radius) {
    std::vector<glm::dvec3> out;
    for (int i = 0; i < count; ++i)
      out.emplace_back(radius * std::cos(2 * pi * i / count), radius * std::sin(2 * pi * i / count), 0);
    return out;
  };
  Shape strip = colored({{-0.4, -0.4, 0}, {0.1, -0.4, 0}, {-0.25, 0, 0}, {0.25, 0, 0}, {-0.1, 0.4, 0}, {0.4, 0.4, 0}});
  Shape fan = colored({{0, 0, 0}, {0.45, 0, 0}, {0.3, 0.35, 0}, {-0.1, 0.45, 0}, {-0.4, 0.2, 0}, {-0.4, -0.2, 0}});
  strip.normal.assign(strip.position.size(), {0, 0, 1});
  fan.normal.assign(fan.position.size(), {0, 0, 1});
  Shape single = colored({{-0.4, -0.4, 0}, {0.4, -0.4, 0}, {0, 0.4, 0}});
  single.normal.assign(3, {0, 0, 1});

  const struct {
    const char* name;
    int mode;
    Shape shape;
  } cases[] = {
      {"points", points, colored(ring(24, 0.4))},      {"lines", lines, colored(ring(16, 0.4))},
      {"line loop", line_loop, colored(ring(7, 0.4))}, {"line strip", line_strip, colored(ring(7, 0.4))},
      {"triangles", triangles, std::move(single)},     {"triangle strip", triangle_strip, std::move(strip)},
      {"triangle fan", triangle_fan, std::move(fan)},
  };
  const int material = out.material("white", pbr({1, 1, 1, 1}, 0, 0.9));
  int i = 0;
  for (const auto& entry : cases) {
    json primitive = out.primitive(entry.shape);
    primitive["mode"] = entry.mode;
    const int mesh = out.mesh(entry.name, primitive, material);
    out.node(entry.name,
             {{"mesh", mesh}, {"translation", vector_json({(i % 4) * 1.1 - 1.65, i < 4 ? 0.55 : -0.55, 0})}});
    ++i;
  }
  // Shared vertices with a colour at each corner of a box, and no material at all.
  Shape corners = box({0.6, 0.6, 0.6});
  for (glm::dvec3 p : corners.position) corners.color.emplace_back(p / 0.6 + 0.5, 1);
  out.node("no material", {{"mesh", out.mesh("no material", out.primitive(corners), -1)},
                           {"translation", vector_json({1.65, -0.55, 0})},
                           {"rotation", quaternion_json(rotation_about({1, 1, 0}, 0.7))}});
  add_sun(out, {1, 1, 3}, {1, 1, 1}, 3);
  out.camera_node({0, 0, 4}, {0, 0, 0}, 0.62);
}

}  // namespace candela
