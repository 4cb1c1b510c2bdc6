#include <cmath>

#include "gltf/validate/internal.h"

// Nodes, their hierarchy, and scenes.
namespace candela::validation {
namespace {

size_t morph_target_count(const Document& d, int64_t mesh) {
  if (mesh < 0) return 0;
  const Json& primitives = elements(elements(d.json, "meshes")[mesh], "primitives");
  return primitives.empty() ? 0 : elements(primitives[0], "targets").size();
}

bool mesh_has_joints(const Document& d, int64_t mesh) {
  for (const Json& primitive : elements(elements(d.json, "meshes")[mesh], "primitives"))
    if (member(primitive, "attributes").contains("JOINTS_0")) return true;
  return false;
}

void check_matrix(Document& d, const Json& node, const std::string& path) {
  const Json& matrix = elements(node, "matrix");
  if (matrix.empty()) return;
  for (const char* key : {"translation", "rotation", "scale"})
    if (node.contains(key))
      return d.findings.fatal("NODE_MATRIX_TRS", path + "/matrix",
                              "a node can have either a matrix or translation, rotation, scale");
  double m[16];
  for (size_t i = 0; i < 16; ++i) m[i] = matrix[i].get<double>();
  // Exporters multiply matrices in 32-bit float: the last row may be off by some of its roundings.
  const double rounding = 1e-5;
  if (!(std::abs(m[3]) <= rounding && std::abs(m[7]) <= rounding && std::abs(m[11]) <= rounding &&
        std::abs(m[15] - 1) <= rounding))
    return d.findings.fatal("NODE_MATRIX_NON_TRS", path + "/matrix", "the last row of the matrix is not 0, 0, 0, 1");
  const auto dot = [&](int a, int b) { return m[a] * m[b] + m[a + 1] * m[b + 1] + m[a + 2] * m[b + 2]; };
  for (const auto& [a, b] : {std::pair{0, 4}, {0, 8}, {4, 8}})
    if (std::abs(dot(a, b)) > 1e-3 * std::sqrt(dot(a, a) * dot(b, b)))
      return d.findings.warning("NODE_MATRIX_NON_TRS", path + "/matrix",
                                "the matrix is sheared, so it is no translation, rotation and scale");
}

void check_rotation(Document& d, const Json& node, const std::string& path) {
  const Json& rotation = elements(node, "rotation");
  if (rotation.empty()) return;
  double square = 0;
  for (const Json& value : rotation) square += value.get<double>() * value.get<double>();
  if (std::abs(std::sqrt(square) - 1) <= 1e-4) return;
  const bool usable = square > 1e-12 && std::isfinite(square);
  d.findings.add(usable ? Harm::warning : Harm::fatal, "ROTATION_NON_UNIT", path + "/rotation",
                 fmt::format("the quaternion has length {}, not 1", std::sqrt(square)));
}

void check_skinned(Document& d, const Json& node, const std::string& path, int64_t mesh) {
  const bool has_skin = node.contains("skin");
  if (has_skin && !node.contains("mesh"))
    d.findings.warning("UNSATISFIED_DEPENDENCY", path + "/skin", "skin without mesh, ignored");
  d.reference(node, "skin", "skins", path);
  if (mesh < 0) return;
  const bool has_joints = mesh_has_joints(d, mesh);
  if (has_skin && !has_joints)
    d.findings.warning("NODE_SKIN_WITH_NON_SKINNED_MESH", path,
                       "the node has a skin, but its mesh has no joints; drawn without it");
  if (!has_skin && has_joints)
    d.findings.warning("NODE_SKINNED_MESH_WITHOUT_SKIN", path,
                       "the mesh has joints, but the node has no skin; drawn without it");
}

void check_instancing(Document& d, const Json& node, const std::string& node_path) {
  const Json& attributes = member(extension(node, "EXT_mesh_gpu_instancing"), "attributes");
  if (!attributes.is_object()) return;
  const std::string path = node_path + "/extensions/EXT_mesh_gpu_instancing/attributes";
  uint64_t count = 0;
  for (const auto& [name, item] : attributes.items()) {
    const AccessorLayout* a = d.accessor(attributes, name, path);
    if (!a) continue;
    const std::string at = path + "/" + pointer_token(name);
    const bool is_rotation = name == "ROTATION";
    if (is_rotation || name == "TRANSLATION" || name == "SCALE") {
      const bool packed =
          is_rotation && a->normalized && (a->component_type == component_byte || a->component_type == component_short);
      if (a->type != (is_rotation ? "VEC4" : "VEC3") || (a->component_type != component_float && !packed))
        d.findings.fatal("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", at,
                         "invalid accessor format {} for this attribute", a->format());
    }
    if (count == 0) count = a->count;
    if (a->count != count)
      d.findings.fatal("MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT", at, "{} elements, other attributes have {}", a->count,
                       count);
  }
}

// An index into the lights of KHR_lights_punctual that a node's extension names; -1 where it names none.
int64_t check_light_index(Document& d, const Json& use, const std::string& path) {
  const Json& root = extension(d.json, "KHR_lights_punctual");
  if (!root.is_object()) {
    d.findings.fatal("UNSATISFIED_DEPENDENCY", path, "'/extensions/KHR_lights_punctual' must be defined");
    return -1;
  }
  const Json& lights = elements(root, "lights");
  const int64_t index = integer(use, "light", -1);
  if (index < 0 || uint64_t(index) >= lights.size()) {
    d.findings.fatal("UNRESOLVED_REFERENCE", path + "/light", "unresolved reference: {} (there are {} lights)", index,
                     lights.size());
    return -1;
  }
  const std::string_view type = text(lights[index], "type");
  if (type != "directional" && type != "point" && type != "spot")
    d.findings.fatal("VALUE_NOT_IN_LIST", fmt::format("/extensions/KHR_lights_punctual/lights/{}/type", index),
                     "'{}' is not one of ('directional', 'point', 'spot'), and {} uses it", type.substr(0, 60), path);
  return index;
}

void check_node_light(Document& d, const Json& node, const std::string& node_path) {
  const Json& use = extension(node, "KHR_lights_punctual");
  if (use.is_object()) check_light_index(d, use, node_path + "/extensions/KHR_lights_punctual");
}

// Formats and counts; the values are looked at where they are read.
void check_light_attribute(Document& d, const Json& attributes, const std::string& name, const std::string& path,
                           std::string_view light_name, uint64_t count) {
  const std::string at = path + "/" + pointer_token(name);
  const bool is_vector = name == "TRANSLATION" || name == "DIRECTION" || name == "COLOR" || name == "MODULATION";
  if (!is_vector && name != "INTENSITY" && name != "RANGE")
    return d.findings.fatal("MESH_PRIMITIVE_INVALID_ATTRIBUTE", at,
                            "lights of '{}': there are TRANSLATION, DIRECTION, COLOR, INTENSITY, RANGE and MODULATION",
                            light_name);
  const AccessorLayout* a = d.accessor(attributes, name, path);
  if (!a) return;
  const std::string_view type = is_vector ? "VEC3" : "SCALAR";
  if (a->type != type || a->component_type != component_float)
    d.findings.fatal("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", at,
                     "lights of '{}': invalid accessor format {}, must be {{{}, FLOAT}}", light_name, a->format(),
                     type);
  if (a->count != count)
    d.findings.fatal("MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT", at, "lights of '{}': {} elements, TRANSLATION has {}",
                     light_name, a->count, count);
  d.use_view(*a, ViewUse::other, at);
}

void check_light_instances(Document& d, const Json& node, const std::string& node_path) {
  const Json& use = extension(node, "CANDELA_light_instances");
  if (!use.is_object()) return;
  const std::string path = node_path + "/extensions/CANDELA_light_instances", at = path + "/attributes";
  const int64_t index = check_light_index(d, use, path);
  if (index < 0) return;
  const Json& light = elements(extension(d.json, "KHR_lights_punctual"), "lights")[index];
  const std::string_view name = text(light, "name"), type = text(light, "type");
  if (type == "directional")
    d.findings.fatal("VALUE_NOT_IN_LIST", path + "/light",
                     "light {} '{}' is directional; instances are of point and spot lights", index, name);
  const Json& attributes = member(use, "attributes");
  if (!attributes.contains("TRANSLATION"))
    return d.findings.fatal("UNDEFINED_PROPERTY", at, "lights of '{}': property 'TRANSLATION' must be defined", name);
  if (attributes.contains("DIRECTION") && type == "point")
    d.findings.warning("UNSATISFIED_DEPENDENCY", at + "/DIRECTION",
                       "light {} '{}' is a point light, which has no direction; ignored", index, name);
  const AccessorLayout* translation = d.accessor(attributes, "TRANSLATION", at);
  if (!translation) return;
  for (const auto& [attribute, item] : attributes.items())
    check_light_attribute(d, attributes, attribute, at, name, translation->count);
}

// Centres are nodes below the body's, so that what moves or hides it moves and hides them. Needs Document::parents.
void check_metaballs(Document& d, size_t i) {
  const Json& node = elements(d.json, "nodes")[i];
  const Json& body = extension(node, "CANDELA_metaballs");
  if (!body.is_object()) return;
  const std::string path = fmt::format("/nodes/{}/extensions/CANDELA_metaballs", i);
  if (node.contains("mesh"))
    d.findings.fatal("VALUE_NOT_IN_LIST", path, "the node has a mesh too; put one of them on a child");
  d.reference(body, "material", "materials", path);
  const Json& balls = elements(body, "balls");
  constexpr size_t most = 1024;
  if (balls.size() > most)
    d.findings.fatal("VALUE_NOT_IN_RANGE", path + "/balls", "{} balls, and a body has at most {}", balls.size(), most);
  for (size_t b = 0; b < balls.size(); ++b) {
    const std::string at = fmt::format("{}/balls/{}", path, b);
    int64_t above = d.reference(balls[b], "node", "nodes", at);
    if (above < 0) continue;
    // No more steps than there are nodes: loops are reported elsewhere.
    for (size_t step = 0; step <= d.parents.size() && above >= 0; ++step) {
      above = d.parents[above];
      if (above == int64_t(i)) break;
    }
    if (above != int64_t(i))
      d.findings.fatal("UNRESOLVED_REFERENCE", at + "/node", "node {} is not below node {}, whose ball it is to be",
                       integer(balls[b], "node", -1), i);
  }
}

void check_node(Document& d, size_t i) {
  const Json& node = elements(d.json, "nodes")[i];
  const std::string path = fmt::format("/nodes/{}", i);
  d.reference(node, "camera", "cameras", path);
  const int64_t mesh = d.reference(node, "mesh", "meshes", path);
  check_matrix(d, node, path);
  check_rotation(d, node, path);
  check_skinned(d, node, path, mesh);
  check_instancing(d, node, path);
  check_node_light(d, node, path);
  check_light_instances(d, node, path);
  const Json& weights = elements(node, "weights");
  if (!node.contains("mesh") && node.contains("weights"))
    d.findings.warning("UNSATISFIED_DEPENDENCY", path + "/weights", "weights without mesh, ignored");
  else if (!weights.empty() && mesh >= 0 && weights.size() != morph_target_count(d, mesh))
    d.findings.fatal("NODE_WEIGHTS_INVALID", path + "/weights", "{} weights for {} morph targets", weights.size(),
                     morph_target_count(d, mesh));
}

void link_parents(Document& d) {
  const Json& nodes = elements(d.json, "nodes");
  d.parents.assign(nodes.size(), -1);
  for (size_t i = 0; i < nodes.size(); ++i) {
    const Json& children = elements(nodes[i], "children");
    for (size_t k = 0; k < children.size(); ++k) {
      const int64_t child = whole(children[k]);
      const std::string path = fmt::format("/nodes/{}/children/{}", i, k);
      if (uint64_t(child) >= nodes.size())
        d.findings.fatal("UNRESOLVED_REFERENCE", path, "unresolved reference: {} (there are {} nodes)", child,
                         nodes.size());
      else if (d.parents[child] >= 0)
        d.findings.fatal("NODE_PARENT_OVERRIDE", path, "node {} already has the parent {}", child, d.parents[child]);
      else
        d.parents[child] = int64_t(i);
    }
  }
}

// Walks up from every node once; meeting a node of the same walk again is a loop.
void find_loops(Document& d) {
  std::vector<size_t> walk_of(d.parents.size(), 0);
  for (size_t i = 0; i < d.parents.size(); ++i) {
    int64_t at = int64_t(i);
    while (at >= 0 && walk_of[at] == 0) {
      walk_of[at] = i + 1;
      at = d.parents[at];
    }
    if (at < 0 || walk_of[at] != i + 1) continue;
    const int64_t first = at;
    do {
      d.findings.fatal("NODE_LOOP", fmt::format("/nodes/{}", at), "the node is its own ancestor");
      at = d.parents[at];
    } while (at != first);
  }
}

void check_scenes(Document& d) {
  d.reference(d.json, "scene", "scenes", "");
  const Json& scenes = elements(d.json, "scenes");
  for (size_t i = 0; i < scenes.size(); ++i) {
    const Json& nodes = elements(scenes[i], "nodes");
    for (size_t k = 0; k < nodes.size(); ++k) {
      const int64_t node = whole(nodes[k]);
      const std::string path = fmt::format("/scenes/{}/nodes/{}", i, k);
      if (uint64_t(node) >= d.parents.size())
        d.findings.fatal("UNRESOLVED_REFERENCE", path, "unresolved reference: {} (there are {} nodes)", node,
                         d.parents.size());
      else if (d.parents[node] >= 0)
        d.findings.fatal("SCENE_NON_ROOT_NODE", path, "node {} is a child of node {}", node, d.parents[node]);
    }
  }
}

}  // namespace

void check_nodes(Document& d) {
  for (size_t i = 0; i < d.count("nodes"); ++i) check_node(d, i);
  link_parents(d);
  find_loops(d);
  for (size_t i = 0; i < d.count("nodes"); ++i) check_metaballs(d, i);
  check_scenes(d);
}

}  // namespace candela::validation
