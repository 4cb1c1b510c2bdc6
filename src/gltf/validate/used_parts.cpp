#include "gltf/validate/used_parts.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "gltf/validate/internal.h"

namespace candela {
namespace {

using namespace validation;

const Json& item_of(const Json& list, int64_t index) {
  static const Json none;
  return index >= 0 && uint64_t(index) < list.size() ? list[size_t(index)] : none;
}
// An index that stands alone in an array.
int64_t index_in(const Json& value) { return is_whole(value) ? whole(value) : -1; }

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
    if (key.ends_with("Texture")) textures.insert(integer(value, "index", -1));
    add_textures(value, textures);
  }
}

}  // namespace

// A node and everything below it, with what they carry; joints of their skins likewise.
void UsedParts::add_node(const Json& document, int64_t first) {
  std::vector<int64_t> open = {first};
  while (!open.empty()) {
    const int64_t n = open.back();
    open.pop_back();
    if (!parts_["nodes"].insert(n).second) continue;
    const Json& node = item_of(elements(document, "nodes"), n);
    for (const Json& child : elements(node, "children")) open.push_back(index_in(child));
    for (const auto& [key, kind] : {std::pair("mesh", "meshes"), {"camera", "cameras"}, {"skin", "skins"}})
      parts_[kind].insert(integer(node, key, -1));
    for (const char* name : {"KHR_lights_punctual", "CANDELA_light_instances"})
      parts_["lights"].insert(integer(extension(node, name), "light", -1));
    const Json& skin = item_of(elements(document, "skins"), integer(node, "skin", -1));
    for (const Json& joint : elements(skin, "joints")) open.push_back(index_in(joint));
    open.push_back(integer(skin, "skeleton", -1));
  }
}

// Joints hang from nodes that the scene need not hold.
void UsedParts::add_ancestors(const Json& document) {
  std::map<int64_t, int64_t> parents;
  const Json& nodes = elements(document, "nodes");
  for (size_t n = 0; n < nodes.size(); ++n)
    for (const Json& child : elements(nodes[n], "children")) parents[index_in(child)] = int64_t(n);
  std::set<int64_t>& used = parts_["nodes"];
  const std::vector<int64_t> below(used.begin(), used.end());
  for (int64_t n : below)
    for (auto parent = parents.find(n); parent != parents.end(); parent = parents.find(n))
      if (n = parent->second; !used.insert(n).second) break;
}

UsedParts::UsedParts(const Json& document, bool animated) : animated_(animated) {
  const Json& scene = item_of(elements(document, "scenes"), integer(document, "scene", 0));
  const Json& roots = elements(scene, "nodes");
  all_ = !scene.is_object();
  for (const Json& root : roots) add_node(document, index_in(root));
  add_ancestors(document);
  for (const int64_t mesh : parts_["meshes"])
    for (const Json& primitive : elements(item_of(elements(document, "meshes"), mesh), "primitives")) {
      parts_["materials"].insert(integer(primitive, "material", -1));
      for (const Json& mapping : elements(extension(primitive, "KHR_materials_variants"), "mappings"))
        parts_["materials"].insert(integer(mapping, "material", -1));
    }
  for (const int64_t node : parts_["nodes"])
    parts_["materials"].insert(
        integer(extension(item_of(elements(document, "nodes"), node), "CANDELA_metaballs"), "material", -1));
  for (const int64_t material : parts_["materials"])
    add_textures(item_of(elements(document, "materials"), material), parts_["textures"]);
}

bool UsedParts::uses(std::string_view path) const {
  const auto part = part_of(path);
  if (!part) return true;
  if (part->first == "animations") return animated_;
  if (all_) return true;
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
  else if (part->first == "animations")
    blank = {{"channels", Json::array()}, {"samplers", Json::array()}};
  else
    blank = Json::object();
}

}  // namespace candela
