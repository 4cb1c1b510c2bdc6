#include "gltf/validate/validate.h"

#include <cmath>

#include "gltf/validate/internal.h"

namespace candela::validation {

void Findings::add(Harm harm, std::string_view code, std::string path, std::string message) {
  constexpr size_t most_warnings = 200, most_fatal = 100;
  size_t& count = harm == Harm::fatal ? fatal_count_ : warning_count_;
  if (++count > (harm == Harm::fatal ? most_fatal : most_warnings)) return;
  findings_.push_back({harm == Harm::fatal, std::string(code), std::move(path), std::move(message)});
}

const Json& member(const Json& object, std::string_view key) {
  static const Json none;
  if (!object.is_object()) return none;
  const auto found = object.find(key);
  return found == object.end() ? none : *found;
}

const Json& elements(const Json& object, std::string_view key) {
  static const Json none = Json::array();
  const Json& found = member(object, key);
  return found.is_array() ? found : none;
}

const Json& extension(const Json& object, std::string_view name) { return member(member(object, "extensions"), name); }

bool is_whole(const Json& value) {
  if (value.is_number_integer()) return true;
  return value.is_number_float() && std::trunc(value.get<double>()) == value.get<double>();
}

int64_t whole(const Json& value) {
  constexpr int64_t most = int64_t(1) << 62;  // the sum of two still fits 64 bits
  const double x = value.get<double>();
  if (std::abs(x) >= double(most)) return x < 0 ? -most : most;
  return value.is_number_float() ? int64_t(x) : value.get<int64_t>();
}

int64_t integer(const Json& object, std::string_view key, int64_t otherwise) {
  const Json& found = member(object, key);
  return is_whole(found) ? whole(found) : otherwise;
}

double number(const Json& object, std::string_view key, double otherwise) {
  const Json& found = member(object, key);
  return found.is_number() ? found.get<double>() : otherwise;
}

std::string_view text(const Json& object, std::string_view key) {
  const Json& found = member(object, key);
  return found.is_string() ? std::string_view(found.get_ref<const std::string&>()) : std::string_view();
}

int component_bytes(int component_type) {
  switch (component_type) {
    case component_byte:
    case component_ubyte:
      return 1;
    case component_short:
    case component_ushort:
      return 2;
    case component_uint:
    case component_float:
      return 4;
    default:
      return 0;
  }
}

std::string AccessorLayout::format() const {
  std::string_view name = "UNSIGNED_INT";
  switch (component_type) {
    case component_byte:
      name = "BYTE";
      break;
    case component_ubyte:
      name = "UNSIGNED_BYTE";
      break;
    case component_short:
      name = "SHORT";
      break;
    case component_ushort:
      name = "UNSIGNED_SHORT";
      break;
    case component_float:
      name = "FLOAT";
      break;
  }
  return fmt::format("{{{}, {}{}}}", type, name, normalized ? " normalized" : "");
}

bool Document::uses(std::string_view extension_name) const {
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    for (const Json& name : elements(json, list))
      if (name.is_string() && name.get_ref<const std::string&>() == extension_name) return true;
  return false;
}

int64_t Document::reference(const Json& object, std::string_view key, std::string_view root_array,
                            const std::string& path) {
  const int64_t index = integer(object, key, -1);
  if (index < 0) return -1;
  if (uint64_t(index) < count(root_array)) return index;
  findings.fatal("UNRESOLVED_REFERENCE", path + "/" + pointer_token(key), "unresolved reference: {} (there are {} {})",
                 index, count(root_array), root_array);
  return -1;
}

const AccessorLayout* Document::accessor(const Json& object, std::string_view key, const std::string& path) {
  const int64_t index = reference(object, key, "accessors", path);
  if (index < 0) return nullptr;
  if (accessors[index].usable) return &accessors[index];
  const Json& json_accessor = elements(json, "accessors")[index];
  const bool type_listed = accessors[index].components > 0;
  findings.fatal("VALUE_NOT_IN_LIST", fmt::format("/accessors/{}/{}", index, type_listed ? "componentType" : "type"),
                 "{} is not in the specification's list, and {}/{} uses it",
                 type_listed ? std::to_string(integer(json_accessor, "componentType", 0))
                             : std::string(text(json_accessor, "type")),
                 path, key);
  return nullptr;
}

void Document::use_view(const AccessorLayout& accessor, ViewUse use, const std::string& path) {
  if (accessor.buffer_view < 0) return;
  ViewUse& first = view_uses[accessor.buffer_view];
  const auto name = [](ViewUse u) {
    return u == ViewUse::index ? "IndexBuffer" : u == ViewUse::vertex ? "VertexBuffer" : "Other";
  };
  if (first == ViewUse::none)
    first = use;
  else if (first != use)
    findings.warning("BUFFER_VIEW_TARGET_OVERRIDE", path, "buffer view {} is used as {} and as {}",
                     accessor.buffer_view, name(first), name(use));
}

}  // namespace candela::validation

namespace candela {

std::vector<Finding> validate_gltf(const nlohmann::json& json, const GltfParts& parts) {
  using namespace validation;
  Findings findings;
  check_major_version(json, findings);
  if (!findings.any_fatal()) check_schema(json, findings);
  if (findings.any_fatal()) return findings.take();
  Document document{json, parts, findings, {}, {}, {}};
  for (const auto check : {check_asset, check_buffers, check_accessors, check_textures, check_materials, check_meshes,
                           check_nodes, check_skins, check_animations, check_extensions}) {
    check(document);
    if (findings.any_fatal()) break;
  }
  return findings.take();
}

}  // namespace candela
