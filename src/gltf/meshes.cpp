#include "gltf/meshes.h"

#include <numeric>

#include "gltf/draco.h"
#include "gltf/mikktspace.h"
#include "gltf/topology.h"
#include "gltf/variants.h"
#include "gltf/vertices.h"

namespace candela::gltf {
namespace {

// One primitive before its vertices are read.
struct Source {
  const tinygltf::Primitive* primitive;
  const Json* json;
  std::string path;
  std::optional<DracoPrimitive> draco;
  size_t vertex_count = 0;
  std::vector<uint32_t> list;  // expanded to points, lines or triangles
  bool restarts = false;       // some index is the restart value
  std::vector<uint32_t> used;  // the vertices that `list` names, ascending; empty: all
};

std::optional<Elements> attribute(Document& document, const Source& source, const std::string& semantic) {
  if (source.draco)
    if (const auto found = source.draco->attributes.find(semantic); found != source.draco->attributes.end())
      return found->second;
  const auto found = source.primitive->attributes.find(semantic);
  if (found == source.primitive->attributes.end()) return std::nullopt;
  const std::string path = source.path + "/attributes/" + semantic;
  Elements elements = elements_of(document, found->second, path);
  if (source.vertex_count != 0 && elements.count != source.vertex_count)
    document.refuse(path, "{} elements where POSITION has {} (MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT)", elements.count,
                    source.vertex_count);
  return elements;
}

bool stored_plainly(const Document& document, const tinygltf::Primitive& primitive) {
  const auto has_view = [&](int accessor) {
    return accessor >= 0 && size_t(accessor) < document.model.accessors.size() &&
           document.model.accessors[size_t(accessor)].bufferView != document.missing_view;
  };
  const auto position = primitive.attributes.find("POSITION");
  return position != primitive.attributes.end() && has_view(position->second) &&
         (primitive.indices < 0 || has_view(primitive.indices));
}

void open_draco(Document& document, Source& source) {
  const Json* draco = extension(*source.json, "KHR_draco_mesh_compression");
  if (!draco) return;
  const std::string path = source.path + "/extensions/KHR_draco_mesh_compression";
  if (source.primitive->mode != TINYGLTF_MODE_TRIANGLES && source.primitive->mode != TINYGLTF_MODE_TRIANGLE_STRIP)
    document.refuse(path, "Draco compresses triangles alone, and the mode is {}", source.primitive->mode);
  std::string why;
  source.draco = decode_draco(document, *draco, *source.primitive, path, why);
  if (source.draco) {
    if (!source.draco->attributes.contains("POSITION")) document.refuse(path, "the Draco data has no POSITION");
    source.vertex_count = source.draco->vertex_count;
  } else if (stored_plainly(document, *source.primitive)) {
    document.warn(path, "{}; the uncompressed copy is used", why);
  } else {
    document.refuse(path, "{}; without it this primitive has no vertices", why);
  }
}

constexpr uint32_t restarted = std::numeric_limits<uint32_t>::max();

// Leaves out the points, lines or triangles of a list that use the restart value.
void drop_restarted(int mode, std::vector<uint32_t>& list) {
  const size_t corners = mode == TINYGLTF_MODE_POINTS ? 1 : mode <= TINYGLTF_MODE_LINE_STRIP ? 2 : 3;
  size_t kept = 0;
  for (size_t i = 0; i + corners <= list.size(); i += corners) {
    const auto first = list.begin() + long(i);
    if (std::find(first, first + long(corners), restarted) != first + long(corners)) continue;
    std::copy(first, first + long(corners), list.begin() + long(kept));
    kept += corners;
  }
  list.resize(kept);
}

std::vector<uint32_t> read_indices(Document& document, Source& source) {
  const std::string path = source.path + "/indices";
  const Elements elements = elements_of(document, source.primitive->indices, path);
  document.charge(elements.count, sizeof(uint32_t), elements.path + "/count");
  std::vector<uint32_t> out(elements.count);
  read_unsigned(document, elements, 1, {}, out);
  const uint32_t restart = uint32_t((uint64_t(1) << 8 * component_bytes(elements.component_type)) - 1);
  for (size_t i = 0; i < out.size(); ++i) {
    if (out[i] < source.vertex_count && out[i] != restart) continue;
    if (out[i] == restart) {
      if (!source.restarts)
        document.warn(path,
                      "index {} holds {}, the primitive restart value; what uses it is left out "
                      "(ACCESSOR_INDEX_PRIMITIVE_RESTART)",
                      i, out[i]);
      source.restarts = true, out[i] = restarted;
      continue;
    }
    document.refuse(path, "index {} names vertex {} of {} (ACCESSOR_INDEX_OOB)", i, out[i], source.vertex_count);
  }
  return out;
}

// Keeps the vertices that the list names: primitives that share one large vertex buffer would otherwise each copy all
// of it.
void drop_unused_vertices(Source& source) {
  std::vector<uint32_t>& used = source.used;
  if (source.list.size() < source.vertex_count / 8) {
    used = source.list;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (uint32_t& v : source.list) v = uint32_t(std::lower_bound(used.begin(), used.end(), v) - used.begin());
    return;
  }
  std::vector<uint32_t> place(source.vertex_count, 0);
  for (const uint32_t v : source.list) place[v] = 1;
  for (uint32_t v = 0; v < place.size(); ++v)
    if (place[v]) {
      place[v] = uint32_t(used.size());
      used.push_back(v);
    }
  if (used.size() == source.vertex_count) return used.clear();
  for (uint32_t& v : source.list) v = place[v];
}

void make_list(Document& document, Source& source) {
  const int mode = source.primitive->mode;
  std::vector<uint32_t> vertices;
  if (source.draco) {
    source.list = std::move(source.draco->index);  // the decoder gives triangles, whatever the mode
    for (const uint32_t v : source.list)
      if (v >= source.vertex_count)
        document.refuse(source.path, "the Draco data names vertex {} of {} (ACCESSOR_INDEX_OOB)", v,
                        source.vertex_count);
  } else {
    const bool indexed = source.primitive->indices >= 0;
    if (indexed) {
      vertices = read_indices(document, source);
    } else {
      document.charge(source.vertex_count, sizeof(uint32_t), source.path);
      vertices.resize(source.vertex_count);
      std::iota(vertices.begin(), vertices.end(), 0u);
    }
    if (has_leftovers(mode, vertices.size()))
      document.warn(
          source.path,
          "{} vertices do not make whole elements of mode {}; the rest is left out (MESH_PRIMITIVE_INCOMPATIBLE_MODE)",
          vertices.size(), mode);
    document.charge(vertices.size(), 3 * sizeof(uint32_t), source.path);
    source.list = expanded_to_list(mode, vertices);
    if (source.restarts) drop_restarted(mode, source.list);
  }
  if (!source.list.empty()) drop_unused_vertices(source);
}

// Returns whether the attribute is there as floats.
template <class V>
bool read_optional(Document& document, const Source& source, const char* semantic, std::vector<V>& out) {
  const std::optional<Elements> elements = attribute(document, source, semantic);
  if (elements) out = read_vectors<V>(document, *elements, source.used);
  return elements && elements->component_type == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

void read_color(Document& document, const Source& source, MeshSection& section) {
  const std::optional<Elements> elements = attribute(document, source, "COLOR_0");
  if (!elements) return;
  if (elements->components == 4) {
    section.color = read_vectors<glm::vec4>(document, *elements, source.used);
    return;
  }
  const std::vector<glm::vec3> rgb = read_vectors<glm::vec3>(document, *elements, source.used);
  section.color.reserve(rgb.size());
  for (const glm::vec3& c : rgb) section.color.emplace_back(c, 1.f);
}

void read_joints(Document& document, const Source& source, int set, MeshSection& section) {
  const std::string number = std::to_string(set);
  const std::optional<Elements> joints = attribute(document, source, "JOINTS_" + number);
  const std::optional<Elements> weights = attribute(document, source, "WEIGHTS_" + number);
  if (!joints || !weights) {
    if (joints || weights)
      document.warn(source.path,
                    "joints and weights of set {} are not both there; the set is left out "
                    "(MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH)",
                    set);
    return;
  }
  const size_t count = section.position.size();
  document.charge(count, 2 * sizeof(glm::uvec4), joints->path);
  std::vector<uint32_t> raw(count * 4);
  read_unsigned(document, *joints, 4, source.used, raw);
  std::vector<glm::u16vec4>& out = set == 0 ? section.joints0 : section.joints1;
  out.resize(count);
  for (size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] > 0xffff) document.refuse(joints->path, "joint {} is out of range (ACCESSOR_JOINTS_INDEX_OOB)", raw[i]);
    out[i / 4][int(i % 4)] = uint16_t(raw[i]);
  }
  (set == 0 ? section.weights0 : section.weights1) = read_vectors<glm::vec4>(document, *weights, source.used);
}

void read_morph_targets(Document& document, const Source& source, MeshSection& section) {
  for (size_t t = 0; t < source.primitive->targets.size(); ++t) {
    MorphTarget target;
    for (const auto& [semantic, accessor] : source.primitive->targets[t]) {
      const std::string path = fmt::format("{}/targets/{}/{}", source.path, t, semantic);
      std::vector<glm::vec3>* out = semantic == "POSITION"  ? &target.position
                                    : semantic == "NORMAL"  ? &target.normal
                                    : semantic == "TANGENT" ? &target.tangent
                                                            : nullptr;
      if (!out) {
        document.warn(path, "morphing {} is not supported; it stays as in the base mesh", semantic);
        continue;
      }
      const Elements elements = elements_of(document, accessor, path);
      if (elements.count != source.vertex_count)
        document.refuse(path, "{} elements where POSITION has {} (MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT)",
                        elements.count, source.vertex_count);
      *out = read_vectors<glm::vec3>(document, elements, source.used);
    }
    if (section.normal.empty()) target.normal.clear();
    if (section.tangent.empty()) target.tangent.clear();
    section.morph.push_back(std::move(target));
  }
}

struct StoredAsFloat {
  bool normal = false, tangent = false;
};

void complete_normals_and_tangents(Document& document, const Scene& scene, MeshSection& section,
                                   StoredAsFloat stored_as_float) {
  const Material* material = section.material >= 0 ? &scene.materials[size_t(section.material)] : nullptr;
  const bool wants_tangents = material && material->wants_tangents() && section.topology == Topology::triangles;
  if (section.normal.empty() || !wants_tangents) {
    section.tangent.clear();
    for (MorphTarget& target : section.morph) target.tangent.clear();
  }
  if (section.normal.empty()) {
    if (section.topology == Topology::triangles) {
      document.charge(section.index.size(), 128, section.place);
      generate_flat_normals(section);
    }
  } else {
    repair_normals(document, section, stored_as_float.normal);
  }
  repair_tangents(document, section, stored_as_float.tangent);
  if (!wants_tangents || !section.tangent.empty()) return;
  const int uv_set = material->tangent_uv_set();
  if ((uv_set == 0 ? section.uv0 : section.uv1).empty()) {
    document.warn(section.place,
                  "the {} needs TEXCOORD_{}, which is absent; it has no effect (MESH_PRIMITIVE_TOO_FEW_TEXCOORDS)",
                  material->normal_texture             ? "normal texture"
                  : material->clearcoat.normal_texture ? "clear coat's normal texture"
                                                       : "anisotropy",
                  uv_set);
    return;
  }
  document.charge(section.index.size(), 64, section.place);
  generate_tangents(section, uv_set);
}

void read_vertices(Document& document, const Scene& scene, const Source& source, const Elements& position,
                   MeshSection& section) {
  section.position = read_vectors<glm::vec3>(document, position, source.used);
  if (source.used.empty() && !source.draco && position.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT)
    report_wrong_bounds(document, section,
                        document.model.accessors[size_t(source.primitive->attributes.at("POSITION"))], position.path);
  const StoredAsFloat stored_as_float{.normal = read_optional(document, source, "NORMAL", section.normal),
                                      .tangent = read_optional(document, source, "TANGENT", section.tangent)};
  const auto found = document.uv_sets.find(section.material);
  const std::array<int, 2> sets = found == document.uv_sets.end() ? std::array{0, 1} : found->second;
  read_optional(document, source, fmt::format("TEXCOORD_{}", sets[0]).c_str(), section.uv0);
  read_optional(document, source, fmt::format("TEXCOORD_{}", sets[1]).c_str(), section.uv1);
  read_color(document, source, section);
  read_joints(document, source, 0, section);
  if (!section.joints0.empty()) read_joints(document, source, 1, section);
  if (source.primitive->attributes.contains("JOINTS_2"))
    document.warn(source.path + "/attributes/JOINTS_2", "more than 8 joints a vertex: the first 8 count");
  if (!section.joints0.empty()) repair_weights(document, section);
  read_morph_targets(document, source, section);
  complete_normals_and_tangents(document, scene, section, stored_as_float);
  for (const glm::vec3& p : section.position) section.bounds.add(p);
}

std::optional<MeshSection> import_primitive(Document& document, const Scene& scene, size_t mesh, size_t primitive) {
  Source source{.primitive = &document.model.meshes[mesh].primitives[primitive],
                .json = &document.json["meshes"][mesh]["primitives"][primitive],
                .path = fmt::format("/meshes/{}/primitives/{}", mesh, primitive)};
  if (source.primitive->mode < 0 || source.primitive->mode > 6)
    document.refuse(source.path + "/mode", "{} is no primitive mode (VALUE_NOT_IN_LIST)", source.primitive->mode);
  if (source.primitive->material >= int(scene.materials.size()) || source.primitive->material < -1)
    document.refuse(source.path + "/material", "there is no material {} (UNRESOLVED_REFERENCE)",
                    source.primitive->material);
  open_draco(document, source);
  const std::optional<Elements> position = attribute(document, source, "POSITION");
  if (!position) {
    document.warn(source.path, "the primitive has no POSITION and is not drawn (MESH_PRIMITIVE_NO_POSITION)");
    return std::nullopt;
  }
  source.vertex_count = position->count;
  if (source.vertex_count >= UINT32_MAX)
    document.refuse(position->path + "/count", "{} vertices are too many", source.vertex_count);
  make_list(document, source);
  MeshSection section;
  section.place = source.path;
  section.topology = topology_of(source.primitive->mode);
  section.material = material_in_variant(document, *source.json, source.path, scene, source.primitive->material);
  section.index = std::move(source.list);
  if (section.index.empty()) return std::nullopt;
  read_vertices(document, scene, source, *position, section);
  return section;
}

void read_default_weights(Document& document, size_t mesh, Mesh& out) {
  size_t targets = 0;
  for (const MeshSection& section : out.sections) targets = std::max(targets, section.morph.size());
  const std::string path = fmt::format("/meshes/{}", mesh);
  for (const MeshSection& section : out.sections)
    if (section.morph.size() != targets)
      document.refuse(path + "/primitives",
                      "primitives of one mesh have {} and {} morph targets (MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT)",
                      section.morph.size(), targets);
  const std::vector<double>& weights = document.model.meshes[mesh].weights;
  if (!weights.empty() && weights.size() != targets)
    document.warn(path + "/weights", "{} weights for {} morph targets (MESH_INVALID_WEIGHTS_COUNT)", weights.size(),
                  targets);
  out.default_weights.assign(targets, 0.f);
  for (size_t i = 0; i < std::min(weights.size(), targets); ++i) out.default_weights[i] = float(weights[i]);
}

}  // namespace

void import_meshes(Document& document, Scene& scene) {
  std::vector<bool> used(document.model.meshes.size());
  if (const Json* nodes = member(document.json, "nodes"))
    for (const Json& node : *nodes) {
      const Json* mesh = member(node, "mesh");
      if (mesh && mesh->is_number_unsigned() && mesh->get<uint64_t>() < used.size()) used[mesh->get<size_t>()] = true;
    }
  for (size_t m = 0; m < document.model.meshes.size(); ++m) {
    Mesh mesh;
    mesh.name = document.model.meshes[m].name;
    // What no node shows is not read: its file may be absent.
    for (size_t p = 0; used[m] && p < document.model.meshes[m].primitives.size(); ++p)
      if (std::optional<MeshSection> section = import_primitive(document, scene, m, p))
        mesh.sections.push_back(std::move(*section));
    read_default_weights(document, m, mesh);
    scene.meshes.push_back(std::move(mesh));
  }
}

}  // namespace candela::gltf
