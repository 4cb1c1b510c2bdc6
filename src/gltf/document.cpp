#include "gltf/document.h"

#include <charconv>

#include "base/input.h"
#include "base/names.h"
#include "gltf/meshopt.h"
#include "gltf/named_files.h"
#include "gltf/repair.h"
#include "gltf/validate/used_parts.h"
#include "gltf/validate/validate.h"

namespace candela::gltf {
namespace {

// What tinygltf is given: the core members that it reads well. Extensions and extras go (it recurses into them without
// a limit), as do buffers and images (it would read files and decode pixels) and animations (it drops channels without
// a node).
Json core_only(const Json& value, int depth) {
  constexpr int deepest = 12;  // core glTF needs 8 levels
  if (depth > deepest) return nullptr;
  if (value.is_object()) {
    Json out = Json::object();
    for (const auto& [key, item] : value.items())
      if (key != "extensions" && key != "extras") out[key] = core_only(item, depth + 1);
    return out;
  }
  if (value.is_array()) {
    Json out = Json::array();
    for (const Json& item : value) out.push_back(core_only(item, depth + 1));
    return out;
  }
  return value;
}

// Throws Failure. Frees `core` before tinygltf makes its own.
void parse_with_tinygltf(const Document& document, Json core, tinygltf::Model& model) {
  const std::string text = core.dump();
  core = nullptr;
  tinygltf::TinyGLTF parser;
  std::string error, warning;
  const bool parsed = parser.LoadASCIIFromString(&model, &error, &warning, text.data(), unsigned(text.size()), "", 0);
  while (!error.empty() && std::isspace(static_cast<unsigned char>(error.back()))) error.pop_back();
  if (!parsed) document.refuse("/", "the structure could not be read: {}", error);
  for (size_t i = 0; i < model.meshes.size(); ++i)
    if (model.meshes[i].primitives.size() != document.json["meshes"][i].value("primitives", Json::array()).size())
      document.refuse(fmt::format("/meshes/{}/primitives", i), "a primitive could not be read: {}", error);
}

// tinygltf refuses index accessors without a buffer view, which Draco files have; they get one past the last.
void parse_core(Document& document) {
  Json core = Json::object();
  for (const char* key :
       {"asset", "accessors", "bufferViews", "meshes", "scenes", "scene", "textures", "samplers", "skins", "cameras"})
    if (const Json* value = member(document.json, key)) core[key] = core_only(*value, 1);
  Json& views = core["bufferViews"];
  if (!views.is_array()) views = Json::array();
  document.missing_view = int(views.size());
  views.push_back({{"buffer", 0}, {"byteLength", 1}});
  if (core.contains("accessors"))
    for (Json& accessor : core["accessors"])
      if (accessor.is_object() && !accessor.contains("bufferView")) accessor["bufferView"] = document.missing_view;
  parse_with_tinygltf(document, std::move(core), document.model);
}

// Versions: a 2.x file is readable unless it says that it needs a later minor version (glTF 2.0 section 3.2).
void check_version(const Document& document) {
  const tinygltf::Asset& asset = document.model.asset;
  int major = 0, minor = 0;
  if (std::sscanf(asset.version.c_str(), "%d.%d", &major, &minor) != 2 || major != 2)
    document.refuse("/asset/version", "glTF version '{}' is not 2.x (UNKNOWN_ASSET_MAJOR_VERSION)", asset.version);
  if (asset.minVersion.empty()) return;
  if (std::sscanf(asset.minVersion.c_str(), "%d.%d", &major, &minor) != 2 || major != 2 || minor > 0)
    document.refuse("/asset/minVersion", "the file needs glTF {}; this program reads 2.0 (UNKNOWN_ASSET_MINOR_VERSION)",
                    asset.minVersion);
}

// "light 'Torch': " for a path into the lights: what the validation found is told by number and by name.
std::string light_named_by(const Json& json, const std::string& path) {
  constexpr std::string_view lights = "/extensions/KHR_lights_punctual/lights/";
  size_t index = 0;
  if (!path.starts_with(lights) ||
      std::from_chars(path.data() + lights.size(), path.data() + path.size(), index).ec != std::errc())
    return {};
  const Json::json_pointer pointer(std::string(lights) + std::to_string(index) + "/name");
  return json.contains(pointer) && json[pointer].is_string()
             ? fmt::format("light '{}': ", json[pointer].get_ref<const std::string&>())
             : std::string();
}

// What is wrong with parts that the scene does not use is no reason to refuse it: they are blanked and become warnings.
// The checks stop at the first group of parts that has a fault, so they begin again.
std::vector<Finding> without_unused_faults(Document& document, const GltfParts& parts, bool animated,
                                           std::vector<Finding>& warnings) {
  std::vector<Finding> found = validate_gltf(document.json, parts);
  // Of lights the reader refuses what the checks only warn of.
  const auto may_refuse = [](const Finding& finding) { return finding.fatal || finding.path.starts_with(lights_path); };
  if (std::ranges::none_of(found, may_refuse)) return found;
  const UsedParts used(document.json, animated);
  constexpr int most_rounds = 16;
  for (int round = 0; round < most_rounds; ++round) {
    std::set<std::string> unused;
    for (const Finding& finding : found)
      if (may_refuse(finding) && !used.uses(finding.path)) {
        unused.insert(finding.path);
        warnings.push_back({false, finding.code, finding.path, finding.message + "; the scene does not use it"});
      }
    if (unused.empty()) break;
    for (const std::string& path : unused) blank_part(document.json, path);
    found = validate_gltf(document.json, parts);
  }
  return found;
}

void validate(Document& document, const GltfParts& parts, bool animated, std::vector<Finding>& findings) {
  const std::vector<Finding> more = without_unused_faults(document, parts, animated, findings);
  findings.insert(findings.end(), more.begin(), more.end());
  for (const Finding& finding : findings)
    if (finding.fatal)
      document.refuse(finding.path, "{}{} ({})", light_named_by(document.json, finding.path), finding.message,
                      finding.code);
  for (const Finding& finding : findings) {
    document.warn(finding.path, "{}{} ({})", light_named_by(document.json, finding.path), finding.message,
                  finding.code);
    document.finding_codes.insert(finding.code);
  }
}

}  // namespace

void Document::charge(size_t count, size_t size, const std::string& path) {
  // Draco and meshopt pack a vertex into about a byte and flat normals triple the vertices: 256 is far from honest
  // files.
  const size_t most = (size_t(64) << 20) + 256 * bytes_read;
  if (size != 0 && count > (most - bytes_expanded) / size)
    refuse(path, "{} elements of {} bytes are out of proportion to the {} bytes of the file", count, size, bytes_read);
  uint64_t sum = bytes_expanded;
  if (auto fits = charge_decoded(sum, count * size, place(path)); !fits) throw Failure{fits.error()};
  bytes_expanded = sum;
}

Document open_document(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder,
                       bool animated) {
  Document document;
  document.name = name;
  document.folder = folder;
  document.bytes_read = bytes.size();
  std::vector<Finding> findings;
  const Expected<GltfParts> parts = split_gltf(bytes, name, findings);
  if (!parts) throw Failure{parts.error()};
  Expected<Json> json = parse_gltf_json(parts->json, name);
  if (!json) throw Failure{json.error()};
  document.json = std::move(*json);
  const std::vector<Finding> repairs = repair_gltf(document.json);
  findings.insert(findings.end(), repairs.begin(), repairs.end());
  validate(document, *parts, animated, findings);
  parse_core(document);
  check_version(document);
  document.binary = parts->binary;
  document.has_binary = parts->has_binary;
  document.decompressed.resize(document.model.bufferViews.size());
  if (const Json* buffers = member(document.json, "buffers")) document.buffers.resize(buffers->size());
  return document;
}

std::vector<tinygltf::Node> core_nodes(const Document& document, size_t first, size_t count) {
  const Json* nodes = member(document.json, "nodes");
  if (!nodes || !nodes->is_array() || first >= nodes->size()) return {};
  Json part = Json::array();
  for (size_t i = first; i < std::min(first + count, nodes->size()); ++i) part.push_back(core_only((*nodes)[i], 2));
  Json core = Json::object();
  core["asset"] = {{"version", "2.0"}};
  core["nodes"] = std::move(part);
  tinygltf::Model model;
  parse_with_tinygltf(document, std::move(core), model);
  return std::move(model.nodes);
}

std::span<const std::byte> view_bytes(Document& document, int view, const std::string& path) {
  if (view < 0 || view >= document.missing_view)
    document.refuse(path, "there is no buffer view {} (UNRESOLVED_REFERENCE)", view);
  std::optional<std::vector<std::byte>>& decompressed = document.decompressed[size_t(view)];
  if (decompressed) return *decompressed;
  const std::string view_path = fmt::format("/bufferViews/{}", view);
  for (const char* name : {ext_meshopt, khr_meshopt})
    if (const Json* meshopt = extension(document.json["bufferViews"][size_t(view)], name)) {
      decompressed = decompress_view(document, *meshopt, name, view_path);
      return *decompressed;
    }
  const tinygltf::BufferView& v = document.model.bufferViews[size_t(view)];
  if (v.buffer < 0 || size_t(v.buffer) >= document.buffers.size())
    document.refuse(view_path + "/buffer", "there is no buffer {} (UNRESOLVED_REFERENCE)", v.buffer);
  const std::span<const std::byte> buffer = buffer_bytes(document, size_t(v.buffer));
  if (v.byteOffset > buffer.size() || v.byteLength > buffer.size() - v.byteOffset)
    document.refuse(view_path, "bytes {} to {} lie outside buffer {} of {} bytes (BUFFER_VIEW_TOO_LONG)", v.byteOffset,
                    double(v.byteOffset) + double(v.byteLength), v.buffer, buffer.size());
  return buffer.subspan(v.byteOffset, v.byteLength);
}

const Json* member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

const Json* extension(const Json& object, const char* name) {
  const Json* extensions = member(object, "extensions");
  const Json* found = extensions ? member(*extensions, name) : nullptr;
  return found && found->is_object() ? found : nullptr;
}

std::string named(const std::string& path, const Json& object) {
  const Json* name = member(object, "name");
  return name && name->is_string() ? path + " " + quoted_name(name->get_ref<const std::string&>()) : path;
}

double number(const Document& document, const Json& object, const char* key, double otherwise,
              const std::string& path) {
  const Json* value = member(object, key);
  if (!value) return otherwise;
  if (!value->is_number()) document.refuse(path + "/" + key, "a number is wanted (TYPE_MISMATCH)");
  return value->get<double>();
}

int index_of(const Document& document, const Json& object, const char* key, size_t limit, const std::string& path) {
  const Json* value = member(object, key);
  if (!value) return -1;
  if (!value->is_number_integer()) document.refuse(path + "/" + key, "an index is wanted (TYPE_MISMATCH)");
  if (value->is_number_unsigned() ? value->get<uint64_t>() >= limit
                                  : value->get<int64_t>() < 0 || uint64_t(value->get<int64_t>()) >= limit)
    document.refuse(path + "/" + key, "there is no element {} (UNRESOLVED_REFERENCE)", value->dump());
  return value->get<int>();
}

bool boolean(const Document& document, const Json& object, const char* key, bool otherwise, const std::string& path) {
  const Json* value = member(object, key);
  if (!value) return otherwise;
  if (!value->is_boolean()) document.refuse(path + "/" + key, "true or false is wanted (TYPE_MISMATCH)");
  return value->get<bool>();
}

std::string text(const Document& document, const Json& object, const char* key, const std::string& otherwise,
                 const std::string& path) {
  const Json* value = member(object, key);
  if (!value) return otherwise;
  if (!value->is_string()) document.refuse(path + "/" + key, "a string is wanted (TYPE_MISMATCH)");
  return value->get<std::string>();
}

std::vector<double> numbers(const Document& document, const Json& object, const char* key, size_t count,
                            const std::string& path) {
  const Json* value = member(object, key);
  if (!value) return {};
  bool right = value->is_array() && value->size() == count;
  std::vector<double> out;
  for (size_t i = 0; right && i < count; ++i) {
    right = (*value)[i].is_number();
    if (right) out.push_back((*value)[i].get<double>());
  }
  if (!right) document.refuse(path + "/" + key, "{} numbers are wanted (TYPE_MISMATCH)", count);
  return out;
}

}  // namespace candela::gltf
