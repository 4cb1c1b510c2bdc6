#include "gltf/used_parts.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

namespace candela::gltf {
namespace {

using Json = nlohmann::json;

const Json& value_of(const Json& object, std::string_view key) {
  static const Json none;
  if (!object.is_object()) return none;
  const auto found = object.find(key);
  return found == object.end() ? none : *found;
}
const Json& item_of(const Json& list, int64_t index) {
  static const Json none;
  return list.is_array() && index >= 0 && uint64_t(index) < list.size() ? list[size_t(index)] : none;
}
int64_t whole_number(const Json& value) { return value.is_number_integer() ? value.get<int64_t>() : -1; }

// "/materials/3/name" -> {"materials", 3}; lights are "lights".
std::optional<std::pair<std::string_view, int64_t>> part_of(std::string_view path) {
  std::string_view kind = "lights";
  if (path.starts_with(lights_path)) {
    path.remove_prefix(lights_path.size());
  } else {
    if (!path.starts_with('/')) return std::nullopt;
    const size_t end = path.find('/', 1);
    if (end == std::string_view::npos) return std::nullopt;
    kind = path.substr(1, end - 1), path.remove_prefix(end);
  }
  if (!path.starts_with('/')) return std::nullopt;
  int64_t index = -1;
  const auto [at, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
  if (error != std::errc() || index < 0 || (at != path.data() + path.size() && *at != '/')) return std::nullopt;
  return std::pair(kind, index);
}

// Indices of texture infos, in the core and in every extension of materials.
void add_textures(const Json& object, std::set<int64_t>& textures) {
  if (!object.is_object()) return;
  for (const auto& [key, value] : object.items()) {
    if (!value.is_object()) continue;
    if (key.ends_with("Texture")) textures.insert(whole_number(value_of(value, "index")));
    add_textures(value, textures);
  }
}

}  // namespace

void UsedParts::add_node(const Json& document, int64_t first) {
  const Json& nodes = value_of(document, "nodes");
  std::vector<int64_t> open = {first};
  while (!open.empty()) {
    const int64_t n = open.back();
    open.pop_back();
    if (!parts_["nodes"].insert(n).second) continue;
    const Json& node = item_of(nodes, n);
    if (const Json& children = value_of(node, "children"); children.is_array())
      for (const Json& child : children) open.push_back(whole_number(child));
    for (const auto& [key, kind] : {std::pair("mesh", "meshes"), {"camera", "cameras"}, {"skin", "skins"}})
      parts_[kind].insert(whole_number(value_of(node, key)));
    const Json& extensions = value_of(node, "extensions");
    for (const char* name : {"KHR_lights_punctual", "CANDELA_light_instances"})
      parts_["lights"].insert(whole_number(value_of(value_of(extensions, name), "light")));
    const Json& skin = item_of(value_of(document, "skins"), whole_number(value_of(node, "skin")));
    if (const Json& joints = value_of(skin, "joints"); joints.is_array())
      for (const Json& joint : joints) open.push_back(whole_number(joint));
    open.push_back(whole_number(value_of(skin, "skeleton")));
  }
}

UsedParts::UsedParts(const Json& document) {
  const Json& scenes = value_of(document, "scenes");
  const Json& chosen = value_of(document, "scene");
  const Json& roots = value_of(item_of(scenes, chosen.is_null() ? 0 : whole_number(chosen)), "nodes");
  all_ = !roots.is_array();
  if (all_) return;
  for (const Json& root : roots) add_node(document, whole_number(root));
  // Joints hang from nodes that the scene need not hold.
  const Json& nodes = value_of(document, "nodes");
  for (bool more = true; more && nodes.is_array();) {
    more = false;
    for (size_t n = 0; n < nodes.size(); ++n) {
      if (parts_["nodes"].contains(int64_t(n))) continue;
      const Json& children = value_of(nodes[n], "children");
      if (!children.is_array()) continue;
      for (const Json& child : children)
        if (parts_["nodes"].contains(whole_number(child))) {
          parts_["nodes"].insert(int64_t(n)), more = true;
          break;
        }
    }
  }
  for (const int64_t mesh : parts_["meshes"]) {
    const Json& primitives = value_of(item_of(value_of(document, "meshes"), mesh), "primitives");
    if (!primitives.is_array()) continue;
    for (const Json& primitive : primitives) {
      parts_["materials"].insert(whole_number(value_of(primitive, "material")));
      const Json& mappings =
          value_of(value_of(value_of(primitive, "extensions"), "KHR_materials_variants"), "mappings");
      if (!mappings.is_array()) continue;
      for (const Json& mapping : mappings) parts_["materials"].insert(whole_number(value_of(mapping, "material")));
    }
  }
  for (const int64_t material : parts_["materials"])
    add_textures(item_of(value_of(document, "materials"), material), parts_["textures"]);
}

bool UsedParts::uses(std::string_view path) const {
  const auto part = part_of(path);
  if (all_ || !part) return true;
  constexpr std::string_view kinds[] = {"nodes", "meshes", "materials", "textures", "cameras", "skins", "lights"};
  if (std::ranges::find(kinds, part->first) == std::end(kinds)) return true;
  const auto found = parts_.find(part->first);
  return found != parts_.end() && found->second.contains(part->second);
}

void blank_part(Json& document, std::string_view path) {
  const auto part = part_of(path);
  if (!part) return;
  Json& list = part->first == "lights" ? document["extensions"]["KHR_lights_punctual"]["lights"]
                                       : document[std::string(part->first)];
  Json& blank = list.at(size_t(part->second));
  if (part->first == "meshes")
    blank = {{"primitives", {{{"attributes", Json::object()}}}}};
  else if (part->first == "lights")
    blank = {{"type", "point"}};
  else if (part->first == "cameras")
    blank = {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}};
  else if (part->first == "skins")
    blank = {{"joints", {0}}};
  else
    blank = Json::object();
}

}  // namespace candela::gltf
