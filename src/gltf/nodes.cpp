#include "gltf/nodes.h"

#include <numeric>

#include "gltf/accessors.h"
#include "gltf/light_instances.h"

namespace candela::gltf {
namespace {

glm::dvec3 vec3_or(const std::vector<double>& v, const glm::dvec3& otherwise) {
  return v.size() == 3 ? glm::dvec3(v[0], v[1], v[2]) : otherwise;
}

void read_transform(Document& document, const tinygltf::Node& source, const std::string& path, Node& node) {
  if (source.matrix.size() == 16) {
    node.has_matrix = true;
    for (int i = 0; i < 16; ++i) node.matrix[i / 4][i % 4] = source.matrix[size_t(i)];
    for (int column = 0; column < 4; ++column) node.matrix[column][3] = column == 3;  // validated up to rounding
    return;
  }
  node.translation = vec3_or(source.translation, node.translation);
  node.scale = vec3_or(source.scale, node.scale);
  if (source.rotation.size() != 4) return;
  const glm::dquat q(source.rotation[3], source.rotation[0], source.rotation[1], source.rotation[2]);
  const double length = glm::length(q);
  if (length > 1e-12) {
    node.rotation = q / length;
  } else {
    document.warn(path + "/rotation", "the quaternion has no length; no rotation is used (ROTATION_NON_UNIT)");
  }
}

// -1 and indices that exist pass.
int checked(const Document& document, int index, size_t limit, const std::string& path, const char* key) {
  if (index < -1 || index >= int(limit))
    document.refuse(path + "/" + key, "there is no element {} (UNRESOLVED_REFERENCE)", index);
  return index;
}

// EXT_mesh_gpu_instancing: one mesh drawn once for each element of its attributes.
std::shared_ptr<const Instances> read_instances(Document& document, const Json& json, const std::string& path) {
  const Json* gpu = extension(json, "EXT_mesh_gpu_instancing");
  const Json* attributes = gpu ? member(*gpu, "attributes") : nullptr;
  if (!attributes) return nullptr;
  const std::string where = path + "/extensions/EXT_mesh_gpu_instancing/attributes";
  auto out = std::make_shared<Instances>();
  const auto elements = [&](const char* key) -> std::optional<Elements> {
    const int accessor = index_of(document, *attributes, key, document.model.accessors.size(), where);
    if (accessor < 0) return std::nullopt;
    Elements e = elements_of(document, accessor, where + "/" + key);
    if (out->count != 0 && e.count != out->count)
      document.refuse(where + "/" + key, "{} elements where another attribute has {}", e.count, out->count);
    out->count = e.count;
    return e;
  };
  if (const auto e = elements("TRANSLATION")) out->translation = read_vectors<glm::vec3>(document, *e, {});
  if (const auto e = elements("SCALE")) out->scale = read_vectors<glm::vec3>(document, *e, {});
  if (const auto e = elements("ROTATION")) {
    document.charge(e->count, sizeof(glm::quat), e->path);
    for (const glm::vec4& q : read_vectors<glm::vec4>(document, *e, {})) {
      const float length = glm::length(q);
      out->rotation.push_back(length > 1e-12f ? glm::quat(q.w, q.x, q.y, q.z) / length : glm::quat(1, 0, 0, 0));
    }
  }
  return out->count > 0 ? out : nullptr;
}

int light_of(const Document& document, const Json& json, const Scene& scene, const std::string& path) {
  const Json* light = extension(json, "KHR_lights_punctual");
  return light ? index_of(document, *light, "light", scene.lights.size(), path + "/extensions/KHR_lights_punctual")
               : -1;
}

Node read_node(Document& document, const Scene& scene, size_t index, const tinygltf::Node& source) {
  const Json& json = document.json["nodes"][index];
  const std::string path = fmt::format("/nodes/{}", index);
  Node node;
  node.name = source.name;
  read_transform(document, source, path, node);
  node.mesh = checked(document, source.mesh, scene.meshes.size(), path, "mesh");
  node.skin = checked(document, source.skin, document.model.skins.size(), path, "skin");
  node.camera = checked(document, source.camera, scene.cameras.size(), path, "camera");
  node.light = light_of(document, json, scene, path);
  node.light_instances = read_light_instances(document, scene, json, path);
  node.children = source.children;
  if (node.mesh >= 0) {
    const size_t targets = scene.meshes[size_t(node.mesh)].default_weights.size();
    node.weights.assign(source.weights.begin(), source.weights.end());
    if (!node.weights.empty() && node.weights.size() != targets) {
      document.warn(path + "/weights", "{} weights for {} morph targets (NODE_WEIGHTS_INVALID)", node.weights.size(),
                    targets);
      node.weights.resize(targets, 0.f);
    }
    node.instances = read_instances(document, json, path);
  }
  if (const Json* visibility = extension(json, "KHR_node_visibility"))
    node.visible = boolean(document, *visibility, "visible", true, path + "/extensions/KHR_node_visibility");
  return node;
}

void set_parents(const Document& document, Scene& scene) {
  for (size_t i = 0; i < scene.nodes.size(); ++i)
    for (size_t c = 0; c < scene.nodes[i].children.size(); ++c) {
      const std::string path = fmt::format("/nodes/{}/children/{}", i, c);
      const int child = scene.nodes[i].children[c];
      if (child < 0 || child >= int(scene.nodes.size()))
        document.refuse(path, "there is no node {} (UNRESOLVED_REFERENCE)", child);
      if (child == int(i)) document.refuse(path, "the node is its own child (NODE_LOOP)");
      if (scene.nodes[size_t(child)].parent >= 0)
        document.refuse(path, "node {} is already a child of node {} (NODE_PARENT_OVERRIDE)", child,
                        scene.nodes[size_t(child)].parent);
      scene.nodes[size_t(child)].parent = int(i);
    }
}

// Every node has one parent at most, so what no parentless node leads to lies on a loop.
void refuse_loops(const Document& document, const Scene& scene) {
  std::vector<int> open;
  std::vector<bool> reached(scene.nodes.size());
  for (size_t i = 0; i < scene.nodes.size(); ++i)
    if (scene.nodes[i].parent < 0) open.push_back(int(i));
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    reached[size_t(n)] = true;
    open.insert(open.end(), scene.nodes[size_t(n)].children.begin(), scene.nodes[size_t(n)].children.end());
  }
  for (size_t i = 0; i < reached.size(); ++i)
    if (!reached[i]) document.refuse(fmt::format("/nodes/{}", i), "the node is its own ancestor (NODE_LOOP)");
}

// Without scenes the file is a library (glTF 2.0 section 3.5.1); showing all of it is what a viewer is expected to do.
void choose_roots(Document& document, Scene& scene) {
  const tinygltf::Model& model = document.model;
  if (model.scenes.empty()) {
    if (!scene.nodes.empty()) document.warn("/scenes", "the file has no scene; all root nodes are drawn");
    for (size_t i = 0; i < scene.nodes.size(); ++i)
      if (scene.nodes[i].parent < 0) scene.roots.push_back(int(i));
  } else {
    const int which = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (which >= int(model.scenes.size()))
      document.refuse("/scene", "there is no scene {} (UNRESOLVED_REFERENCE)", which);
    std::vector<bool> listed(scene.nodes.size());
    for (size_t i = 0; i < model.scenes[size_t(which)].nodes.size(); ++i) {
      const int root = model.scenes[size_t(which)].nodes[i];
      const std::string path = fmt::format("/scenes/{}/nodes/{}", which, i);
      if (root < 0 || root >= int(scene.nodes.size()))
        document.refuse(path, "there is no node {} (UNRESOLVED_REFERENCE)", root);
      if (scene.nodes[size_t(root)].parent >= 0)
        document.refuse(path, "node {} is a child of node {}, not a root (SCENE_NON_ROOT_NODE)", root,
                        scene.nodes[size_t(root)].parent);
      if (listed[size_t(root)]) continue;
      listed[size_t(root)] = true;
      scene.roots.push_back(root);
    }
  }
  if (scene.roots.empty()) document.warn("/scenes", "the scene has no nodes; there is nothing to draw");
}

// Depth first, in file order; a stack of our own, because hierarchies may be deep.
void make_order(Scene& scene) {
  std::vector<int> open(scene.roots.rbegin(), scene.roots.rend());
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    scene.order.push_back(n);
    const std::vector<int>& children = scene.nodes[size_t(n)].children;
    open.insert(open.end(), children.rbegin(), children.rend());
  }
}

// A joint outside the scene still moves its mesh. Its ancestors and itself are placed, but nothing on them is drawn.
void place_joints(Scene& scene) {
  std::vector<bool> placed(scene.nodes.size());
  for (const int n : scene.order) placed[size_t(n)] = true;
  for (const Skin& skin : scene.skins)
    for (int joint : skin.joints) {
      std::vector<int> chain;
      for (; joint >= 0 && !placed[size_t(joint)]; joint = scene.nodes[size_t(joint)].parent) chain.push_back(joint);
      for (size_t i = chain.size(); i-- > 0;) {
        placed[size_t(chain[i])] = true;
        scene.nodes[size_t(chain[i])].visible = false;
        scene.order.push_back(chain[i]);
      }
    }
}

void check_joint_indices(const Document& document, const Scene& scene) {
  std::vector<int> highest(scene.meshes.size(), -1);
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    for (const MeshSection& section : scene.meshes[m].sections)
      for (const std::vector<glm::u16vec4>* set : {&section.joints0, &section.joints1})
        for (const glm::u16vec4& j : *set) highest[m] = std::max({highest[m], int(j.x), int(j.y), int(j.z), int(j.w)});
  for (size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0 || node.skin < 0) continue;
    const size_t joints = scene.skins[size_t(node.skin)].joints.size();
    if (highest[size_t(node.mesh)] >= int(joints))
      document.refuse(fmt::format("/nodes/{}", n),
                      "mesh {} names joint {} and skin {} has {} (ACCESSOR_JOINTS_INDEX_OOB)", node.mesh,
                      highest[size_t(node.mesh)], node.skin, joints);
  }
}

}  // namespace

void import_nodes(Document& document, Scene& scene) {
  if (const Json* nodes = member(document.json, "nodes")) scene.nodes.reserve(nodes->size());
  constexpr size_t at_once = 1024;
  for (;;) {
    const std::vector<tinygltf::Node> some = core_nodes(document, scene.nodes.size(), at_once);
    if (some.empty()) break;
    for (const tinygltf::Node& node : some) scene.nodes.push_back(read_node(document, scene, scene.nodes.size(), node));
  }
  set_parents(document, scene);
  refuse_loops(document, scene);
  choose_roots(document, scene);
  make_order(scene);
}

void import_skins(Document& document, Scene& scene) {
  for (size_t s = 0; s < document.model.skins.size(); ++s) {
    const tinygltf::Skin& source = document.model.skins[s];
    const std::string path = fmt::format("/skins/{}", s);
    Skin skin;
    skin.name = source.name;
    skin.joints = source.joints;
    if (skin.joints.empty()) document.refuse(path + "/joints", "the skin has no joints (EMPTY_ENTITY)");
    for (const int joint : skin.joints)
      if (joint < 0 || joint >= int(scene.nodes.size()))
        document.refuse(path + "/joints", "there is no node {} (UNRESOLVED_REFERENCE)", joint);
    document.charge(skin.joints.size(), sizeof(glm::dmat4), path);
    skin.inverse_bind.assign(skin.joints.size(), glm::dmat4(1.0));
    if (source.inverseBindMatrices >= 0) {
      const std::vector<float> matrices =
          all_floats(document, source.inverseBindMatrices, 16, path + "/inverseBindMatrices");
      if (matrices.size() < skin.joints.size() * 16)
        document.refuse(path + "/inverseBindMatrices", "{} matrices for {} joints (INVALID_IBM_ACCESSOR_COUNT)",
                        matrices.size() / 16, skin.joints.size());
      for (size_t i = 0; i < skin.joints.size() * 16; ++i)
        skin.inverse_bind[i / 16][int(i % 16 / 4)][int(i % 4)] = double(matrices[i]);
    }
    scene.skins.push_back(std::move(skin));
  }
  place_joints(scene);
  check_joint_indices(document, scene);
}

}  // namespace candela::gltf
