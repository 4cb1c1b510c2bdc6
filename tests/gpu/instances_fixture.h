#pragma once
#include "../unit/scene_pieces.h"
#include "base/rng.h"

namespace candela::test {

// Meshes with a node each, and instances of meshes with sections that are drawn alike and otherwise, among and above
// them: below a moving and turning parent, mirrored, and blended.
struct Crowd : GltfBuilder {
  Crowd(glm::dvec3 away, uint32_t count) {
    json["nodes"] = Json::array(), json["scenes"][0]["nodes"] = Json::array();
    use_materials(*this);
    Json mask = diffuse_material(0.9, 0.3, 0.1), glass = diffuse_material(0.2, 0.4, 0.9);
    mask["alphaMode"] = "MASK";
    glass["alphaMode"] = "BLEND", glass["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
    Json both = diffuse_material(0.3, 0.8, 0.4);
    both["doubleSided"] = true;
    const int clay = add_material(*this, diffuse_material(0.8, 0.7, 0.6)), red = add_material(*this, mask),
              green = add_material(*this, both), pane = add_material(*this, glass),
              grey = add_material(*this, diffuse_material(0.4, 0.4, 0.4));
    const int wall = add_square_mesh(*this, 6, clay), chips = add_square_mesh(*this, 0.2f, green),
              panes = add_square_mesh(*this, 0.3f, pane);
    for (const auto& [half, material] : {std::pair(0.15f, red), std::pair(0.12f, grey), std::pair(0.1f, clay)}) {
      const int more = add_square_mesh(*this, half, material);
      json["meshes"][size_t(chips)]["primitives"].push_back(json["meshes"][size_t(more)]["primitives"][0]);
    }
    Rng rng(5);
    add_node(*this, {{"mesh", wall}, {"translation", at(away, {0, 0, -7})}});
    const int mover = add_node(*this, {{"translation", at(away, {0, 0.5, -4})}, {"scale", {1, 1.25, 0.75}}});
    Json below = instances(chips, count, rng);
    json["nodes"].push_back(below);
    json["nodes"][size_t(mover)]["children"] = {int(json["nodes"].size()) - 1};
    add_node(*this, {{"mesh", chips}, {"translation", at(away, {0.5, 0, -3})}});
    Json mirrored = instances(chips, count, rng);
    mirrored["translation"] = at(away, {0, -0.5, -5}), mirrored["scale"] = {-1, 1, 1};
    add_node(*this, mirrored);
    Json blended = instances(panes, count / 4, rng);
    blended["translation"] = at(away, {0, 0, -3.5});
    add_node(*this, blended);
    add_node(*this, {{"mesh", chips}, {"translation", at(away, {-0.5, 0.2, -2.5})}});
    const double s = std::sqrt(0.5);
    add_light(*this, {{"type", "directional"}, {"intensity", 2}}, {{"rotation", {-0.4, 0.1, 0, 0.9}}});
    add_light(*this, {{"type", "point"}, {"intensity", 20}, {"range", 9}}, {{"translation", at(away, {1, 1, -2})}});
    use("EXT_mesh_gpu_instancing", true);
    const int times = accessor<float>("SCALAR", {0, 1, 2});
    std::vector<float> places;
    for (const glm::dvec3 p : {glm::dvec3(0, 0.5, -4), glm::dvec3(1, 0.5, -5), glm::dvec3(-1, 0.3, -4)})
      for (int axis = 0; axis < 3; ++axis) places.push_back(float(away[axis] + p[axis]));
    const std::vector<float> turns = {0, 0, 0, 1, 0, float(s), 0, float(s), 0.5f, 0.5f, 0.5f, 0.5f};
    json["animations"] = {{{"samplers",
                            {{{"input", times}, {"output", accessor<float>("VEC3", places)}},
                             {{"input", times}, {"output", accessor<float>("VEC4", turns)}}}},
                           {"channels",
                            {{{"sampler", 0}, {"target", {{"node", mover}, {"path", "translation"}}}},
                             {{"sampler", 1}, {"target", {{"node", mover}, {"path", "rotation"}}}}}}}};
  }

  static Json at(glm::dvec3 away, glm::dvec3 p) { return {away.x + p.x, away.y + p.y, away.z + p.z}; }

 private:
  Json instances(int mesh, uint32_t count, Rng& rng) {
    std::vector<float> translation, rotation, scale;
    for (uint32_t i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        translation.push_back(float(rng.uniform(-2, 2)));
        scale.push_back(float(rng.uniform(0.5, 1.5)));
      }
      const glm::dquat q = glm::normalize(glm::dquat(rng.uniform(), rng.uniform(), rng.uniform(), rng.uniform()));
      for (const double v : {q.x, q.y, q.z, q.w}) rotation.push_back(float(v));
    }
    const Json attributes = {{"TRANSLATION", accessor<float>("VEC3", translation)},
                             {"ROTATION", accessor<float>("VEC4", rotation)},
                             {"SCALE", accessor<float>("VEC3", scale)}};
    return {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}};
  }
};

}  // namespace candela::test
