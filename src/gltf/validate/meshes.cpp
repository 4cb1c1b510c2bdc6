#include <map>
#include <set>

#include "gltf/validate/internal.h"

namespace candela::validation {
namespace {

// "TEXCOORD_1" -> {"TEXCOORD", 1}; index -1 for names without a number, -2 for malformed ones ("TEXCOORD_01").
struct Semantic {
  std::string_view base;
  int index = -1;
};
Semantic parse_semantic(std::string_view name) {
  const size_t split = name.rfind('_');
  if (split == std::string_view::npos) return {name, -1};
  const std::string_view digits = name.substr(split + 1);
  const bool good = !digits.empty() && digits.size() <= 4 &&
                    digits.find_first_not_of("0123456789") == std::string_view::npos &&
                    (digits.size() == 1 || digits[0] != '0');
  return {name.substr(0, split), good ? std::stoi(std::string(digits)) : -2};
}

bool is_indexed(std::string_view base) {
  return base == "TEXCOORD" || base == "COLOR" || base == "JOINTS" || base == "WEIGHTS";
}
bool is_plain(std::string_view base) { return base == "POSITION" || base == "NORMAL" || base == "TANGENT"; }

bool valid_attribute(std::string_view name, bool morph) {
  if (name.starts_with('_')) return true;
  const Semantic s = parse_semantic(name);
  if (is_plain(s.base)) return s.index == -1;
  if (morph && (s.base == "JOINTS" || s.base == "WEIGHTS")) return false;
  return is_indexed(s.base) && s.index >= 0;
}

// exact: as the specification (or KHR_mesh_quantization, where used) lists it; readable: other encodings that mean one
// thing.
enum class Fit { exact, readable, wrong };

Fit attribute_fit(std::string_view base, const AccessorLayout& a, bool morph, bool quantization) {
  const bool is_float = a.component_type == component_float;
  const bool small = a.component_type != component_uint && !is_float;
  const bool is_unsigned = a.component_type == component_ubyte || a.component_type == component_ushort;
  const Fit quantized = quantization ? Fit::exact : Fit::readable;
  const std::string_view shape = base == "TANGENT"                       ? (morph ? "VEC3" : "VEC4")
                                 : base == "TEXCOORD"                    ? "VEC2"
                                 : base == "JOINTS" || base == "WEIGHTS" ? "VEC4"
                                                                         : "VEC3";
  if (base == "COLOR" ? a.type != "VEC3" && a.type != "VEC4" : a.type != shape) return Fit::wrong;
  if (base == "JOINTS") return is_unsigned && !a.normalized ? Fit::exact : Fit::wrong;
  if (is_float) return Fit::exact;
  if (base == "WEIGHTS" || base == "COLOR")
    return a.normalized && is_unsigned ? Fit::exact : morph && small && a.normalized ? quantized : Fit::wrong;
  if (base == "TEXCOORD" && a.normalized && is_unsigned) return Fit::exact;
  if (base == "POSITION" || base == "TEXCOORD") return small ? quantized : Fit::wrong;
  if (morph) return small && !is_unsigned ? quantized : Fit::wrong;
  return small && !is_unsigned && a.normalized ? quantized : Fit::wrong;
}

class MeshChecker {
 public:
  explicit MeshChecker(Document& document) : d_(document), quantization_(document.uses("KHR_mesh_quantization")) {}

  void mesh(size_t index) {
    const Json& mesh = elements(d_.json, "meshes")[index];
    const std::string path = fmt::format("/meshes/{}", index);
    const Json& primitives = elements(mesh, "primitives");
    for (size_t i = 0; i < primitives.size(); ++i) primitive(primitives[i], fmt::format("{}/primitives/{}", path, i));
    if (primitives.empty()) return;
    const size_t targets = elements(primitives[0], "targets").size();
    for (size_t i = 1; i < primitives.size(); ++i)
      if (elements(primitives[i], "targets").size() != targets)
        d_.findings.fatal(
            "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT",
            fmt::format("{}/primitives/{}{}", path, i, primitives[i].contains("targets") ? "/targets" : ""),
            "all primitives must have the same number of morph targets ({})", targets);
    if (const Json& weights = elements(mesh, "weights"); !weights.empty() && weights.size() != targets)
      d_.findings.fatal("MESH_INVALID_WEIGHTS_COUNT", path + "/weights", "{} weights for {} morph targets",
                        weights.size(), targets);
  }

 private:
  void primitive(const Json& primitive, const std::string& path) {
    const Json& attributes = member(primitive, "attributes");
    const std::string attributes_path = path + "/attributes";
    vertex_count_ = 0;
    semantics_.clear();
    if (attributes.contains("POSITION")) attribute(attributes, "POSITION", attributes_path);
    for (const auto& [name, item] : attributes.items())
      if (name != "POSITION") attribute(attributes, name, attributes_path);
    continuity(attributes_path);
    if (!attributes.contains("POSITION"))
      d_.findings.warning("MESH_PRIMITIVE_NO_POSITION", attributes_path, "no POSITION attribute found");
    if (attributes.contains("TANGENT") && !attributes.contains("NORMAL"))
      d_.findings.warning("MESH_PRIMITIVE_TANGENT_WITHOUT_NORMAL", attributes_path + "/TANGENT",
                          "TANGENT attribute without NORMAL found");
    const uint64_t drawn = indices(primitive, path);
    mode(primitive, path, drawn);
    targets(primitive, path);
    material(primitive, path);
    draco(primitive, path);
  }

  void attribute(const Json& attributes, const std::string& name, const std::string& path) {
    const std::string at = path + "/" + pointer_token(name);
    const bool known = valid_attribute(name, false);
    if (!known) d_.findings.warning("MESH_PRIMITIVE_INVALID_ATTRIBUTE", at, "invalid attribute name, ignored");
    const AccessorLayout* a = d_.accessor(attributes, name, path);
    if (!a) return;
    const Semantic semantic = parse_semantic(name);
    if (known && is_indexed(semantic.base)) semantics_[semantic.base].insert(semantic.index);
    if (known && !name.starts_with('_'))
      format(*a, semantic.base, at, false);
    else if (a->component_type == component_uint)
      d_.findings.warning("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT", at,
                          "mesh attributes cannot use UNSIGNED_INT, ignored");
    if (name == "POSITION" && !a->has_bounds)
      d_.findings.warning("MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", at,
                          "accessor.min and accessor.max must be defined for POSITION");
    if (vertex_count_ == 0) vertex_count_ = a->count;
    if (a->count != vertex_count_)
      d_.findings.fatal("MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT", at, "{} elements, other attributes have {}", a->count,
                        vertex_count_);
    vertex_view(*a, whole(attributes[name]), at);
  }

  void format(const AccessorLayout& a, std::string_view base, const std::string& path, bool morph) {
    const Fit fit = attribute_fit(base, a, morph, quantization_);
    if (fit == Fit::exact) return;
    d_.findings.add(fit == Fit::wrong ? Harm::fatal : Harm::warning,
                    "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", path,
                    fmt::format("invalid accessor format {} for this attribute", a.format()));
  }

  void vertex_view(const AccessorLayout& a, int64_t accessor_index, const std::string& path) {
    d_.use_view(a, ViewUse::vertex, path);
    if (a.buffer_view < 0) return;
    const int64_t view_offset = integer(elements(d_.json, "bufferViews")[a.buffer_view], "byteOffset", 0);
    if ((a.offset + uint64_t(view_offset)) % 4 || a.stride % 4)
      d_.findings.warning("MESH_PRIMITIVE_ACCESSOR_UNALIGNED", path,
                          "vertex attribute data must be aligned to 4 bytes");
    const int64_t first = view_users_.try_emplace(a.buffer_view, accessor_index).first->second;
    if (first != accessor_index && !a.view_has_stride)
      d_.findings.warning(
          "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE", path,
          "byteStride must be defined when several accessors use the same buffer view; read as tightly packed");
  }

  // A set with joints and no weights, or the reverse, leaves the skinned shape open.
  void continuity(const std::string& path) {
    for (const auto& [base, found] : semantics_)
      if (*found.rbegin() + 1 != int(found.size()))
        d_.findings.warning("MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY", path,
                            "the indices of {} must start with 0 and be continuous", base);
    if (semantics_["JOINTS"] != semantics_["WEIGHTS"])
      d_.findings.fatal("MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", path, "{} JOINTS attributes, but {} WEIGHTS",
                        semantics_["JOINTS"].size(), semantics_["WEIGHTS"].size());
  }

  uint64_t indices(const Json& primitive, const std::string& path) {
    const AccessorLayout* a = d_.accessor(primitive, "indices", path);
    if (!a) return vertex_count_;
    const std::string at = path + "/indices";
    const bool good = a->type == "SCALAR" && !a->normalized &&
                      (a->component_type == component_ubyte || a->component_type == component_ushort ||
                       a->component_type == component_uint);
    if (!good)
      d_.findings.fatal("MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT", at, "invalid indices accessor format {}",
                        a->format());
    if (a->view_has_stride)
      d_.findings.fatal("MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE", at,
                        "byteStride must not be defined for indices");
    d_.use_view(*a, ViewUse::index, at);
    return a->count;
  }

  void mode(const Json& primitive, const std::string& path, uint64_t n) {
    const int64_t mode = integer(primitive, "mode", 4);
    const bool good = mode == 0   ? n >= 1
                      : mode == 1 ? n >= 2 && n % 2 == 0
                      : mode <= 3 ? n >= 2
                      : mode == 4 ? n >= 3 && n % 3 == 0
                                  : n >= 3;
    if (!good && n > 0)
      d_.findings.warning("MESH_PRIMITIVE_INCOMPATIBLE_MODE", path, "{} vertices or indices do not fit drawing mode {}",
                          n, mode);
  }

  void targets(const Json& primitive, const std::string& path) {
    const Json& attributes = member(primitive, "attributes");
    const Json& targets = elements(primitive, "targets");
    for (size_t i = 0; i < targets.size(); ++i) {
      const std::string target_path = fmt::format("{}/targets/{}", path, i);
      for (const auto& [name, item] : targets[i].items()) target_attribute(attributes, targets[i], name, target_path);
    }
  }

  void target_attribute(const Json& attributes, const Json& target, const std::string& name, const std::string& path) {
    const std::string at = path + "/" + pointer_token(name);
    const bool known = valid_attribute(name, true);
    if (!known) d_.findings.warning("MESH_PRIMITIVE_INVALID_ATTRIBUTE", at, "invalid attribute name, ignored");
    const AccessorLayout* a = d_.accessor(target, name, path);
    if (!attributes.contains(name))
      d_.findings.warning("MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR", at,
                          "the primitive does not define this attribute, ignored");
    if (!a) return;
    if (vertex_count_ && a->count != vertex_count_)
      d_.findings.fatal("MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT", at, "{} elements, the base has {}",
                        a->count, vertex_count_);
    if (known && !name.starts_with('_')) format(*a, parse_semantic(name).base, at, true);
    if (name == "POSITION" && !a->has_bounds)
      d_.findings.warning("MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", at,
                          "accessor.min and accessor.max must be defined for POSITION");
    vertex_view(*a, whole(target[name]), at);
  }

  void material(const Json& primitive, const std::string& path) {
    const int64_t index = d_.reference(primitive, "material", "materials", path);
    if (index < 0) return;
    const Json& material = elements(d_.json, "materials")[index];
    auto [entry, is_new] = texcoord_uses_.try_emplace(index);
    if (is_new) collect_texcoord_uses(material, fmt::format("/materials/{}", index), entry->second);
    for (const TexcoordUse& use : entry->second)
      if (!semantics_["TEXCOORD"].contains(int(use.set)))
        d_.findings.warning("MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", path + "/material",
                            "{} needs TEXCOORD_{}, which the primitive lacks", use.path, use.set);
    const Json& attributes = member(primitive, "attributes");
    const bool coat = extension(material, "KHR_materials_clearcoat").contains("clearcoatNormalTexture");
    if (coat && !material.contains("normalTexture") && !attributes.contains("TANGENT") &&
        integer(primitive, "mode", 4) >= 4)
      d_.findings.warning(
          "MESH_PRIMITIVE_NO_TANGENT_SPACE", path + "/material",
          "the material needs a tangent space, and there is neither TANGENT nor a normal map to make it from");
  }

  void draco(const Json& primitive, const std::string& path) {
    const Json& packed = extension(primitive, "KHR_draco_mesh_compression");
    if (packed.is_object())
      d_.reference(packed, "bufferView", "bufferViews", path + "/extensions/KHR_draco_mesh_compression");
  }

  Document& d_;
  const bool quantization_;
  uint64_t vertex_count_ = 0;                            // of the primitive in hand
  std::map<std::string_view, std::set<int>> semantics_;  // its indexed attributes
  std::map<int64_t, int64_t> view_users_;                // the first accessor of each view
  std::map<int64_t, std::vector<TexcoordUse>> texcoord_uses_;
};

}  // namespace

void check_meshes(Document& document) {
  MeshChecker checker(document);
  for (size_t i = 0; i < document.count("meshes"); ++i) checker.mesh(i);
}

}  // namespace candela::validation
