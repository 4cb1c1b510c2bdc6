#pragma once
#include <glm/gtc/quaternion.hpp>

#include "gltf_builder.h"
#include "scene/frame_data.h"
#include "scene/pose.h"
#include "scene/view.h"

namespace candela::test {

// Pieces of scenes. Each returns the node.
inline int add_node(GltfBuilder& b, Json node) {
  b.json["nodes"].push_back(std::move(node));
  const int index = int(b.json["nodes"].size()) - 1;
  b.json["scenes"][0]["nodes"].push_back(index);
  return index;
}
inline GltfBuilder empty_scene() {
  GltfBuilder b;
  b.json["nodes"] = Json::array();
  b.json["scenes"][0]["nodes"] = Json::array();
  return b;
}
// The "rotation" of a node that turns direction `from` (unit) to `to` (any length).
inline Json rotation_between(glm::dvec3 from, glm::dvec3 to) {
  const glm::dquat q(from, glm::normalize(to));
  return {q.x, q.y, q.z, q.w};
}
// A square in the plane z = 0 that faces +Z, of half size `half`.
inline int add_square_mesh(GltfBuilder& b, float half, int material) {
  const int position = b.accessor<float>("VEC3", {-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0});
  const int normal = b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  Json& p = b.primitive({{"POSITION", position}, {"NORMAL", normal}});
  p["indices"] = b.accessor<uint16_t>("SCALAR", {0, 1, 2, 0, 2, 3});
  p["material"] = material;
  return int(b.json["meshes"].size()) - 1;
}
inline int add_material(GltfBuilder& b, Json material) {
  b.json["materials"].push_back(std::move(material));
  return int(b.json["materials"].size()) - 1;
}
inline Json base_color(double r, double g, double b, double a = 1) {
  return {{"baseColorFactor", {r, g, b, a}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
}
// Diffuse alone: KHR_materials_specular with no specular at all.
inline Json diffuse_material(double r, double g, double b) {
  return {{"pbrMetallicRoughness", base_color(r, g, b)},
          {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
}
inline Json unlit_material(double r, double g, double b, double a = 1) {
  return {{"pbrMetallicRoughness", base_color(r, g, b, a)}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}
inline void add_light(GltfBuilder& b, Json light, Json node) {
  Json& lights = b.json["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(std::move(light));
  node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
  add_node(b, std::move(node));
  b.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_specular", "KHR_materials_unlit"};
}
inline void use_materials(GltfBuilder& b) {
  b.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_specular", "KHR_materials_unlit"};
}

// What a camera at (0, 0, 4) sees of a scene at its start, 64 pixels by 36.
struct SeenScene {
  Scene scene;
  Pose pose;
  View view;
  FrameData data;
};
inline SeenScene seen_from_the_front(const GltfBuilder& builder) {
  const auto scene = builder.load(LoadFor::raster);
  EXPECT_TRUE(scene) << scene.error().text();
  SeenScene out{*scene, evaluate_pose(*scene, {}, 0), {}, {}};
  CameraRequest request;
  request.eye = glm::dvec3(0, 0, 4), request.target = glm::dvec3(0);
  const auto view = make_view(out.scene, out.pose, request, 64, 36, world_bounds(out.scene, out.pose));
  EXPECT_TRUE(view) << view.error().text();
  out.view = *view;
  out.data = make_frame_data(out.scene, out.pose, out.view);
  return out;
}

}  // namespace candela::test
