#include "gltf/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

namespace candela::gltf {
namespace {

using Json = nlohmann::json;

Json* member(Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}
// The elements of the array of that name; none where there is no array. Good until the array grows.
std::span<Json> elements(Json& object, const char* key) {
  Json* found = member(object, key);
  auto* array = found ? found->get_ptr<Json::array_t*>() : nullptr;
  return array ? std::span<Json>(*array) : std::span<Json>();
}
int64_t index_in(const Json& value, size_t count) {
  if (!value.is_number_integer()) return -1;
  const int64_t index = value.get<int64_t>();
  return index >= 0 && uint64_t(index) < count ? index : -1;
}
double number_in(Json& object, const char* key, double otherwise) {
  const Json* found = member(object, key);
  return found && found->is_number() ? found->get<double>() : otherwise;
}

class Repairer {
 public:
  explicit Repairer(Json& json) : json_(json), nodes_(elements(json, "nodes").size()) {}

  std::vector<Finding> run() {
    if (!json_.is_object()) return {};
    hierarchy();
    transforms();
    lights();
    primitives();
    textures();
    return std::move(findings_);
  }

 private:
  template <class... A>
  void note(std::string_view code, std::string path, fmt::format_string<A...> format, A&&... args) {
    constexpr size_t most = 10000;
    if (findings_.size() < most)
      findings_.push_back({false, std::string(code), std::move(path), fmt::format(format, std::forward<A>(args)...)});
  }

  // A node stays under the first parent that lists it; roots of the shown scene have none.
  void hierarchy() {
    const std::span<Json> nodes = elements(json_, "nodes");
    std::vector<int64_t> parent(nodes_, -1);
    for (size_t n = 0; n < nodes_; ++n) {
      Json* listed = member(nodes[n], "children");
      if (!listed || !listed->is_array()) continue;
      Json kept = Json::array();
      for (size_t i = 0; i < listed->size(); ++i) {
        const int64_t child = index_in((*listed)[i], nodes_);
        if (child >= 0 && parent[size_t(child)] >= 0) {
          note("NODE_PARENT_OVERRIDE", fmt::format("/nodes/{}/children/{}", n, i),
               "node {} already has the parent {}; it stays there", child, parent[size_t(child)]);
          continue;
        }
        if (child >= 0) parent[size_t(child)] = int64_t(n);
        kept.push_back((*listed)[i]);
      }
      if (kept.size() == listed->size()) continue;
      if (kept.empty())
        nodes[n].erase("children");
      else
        *listed = std::move(kept);
    }
    const std::span<Json> scenes = elements(json_, "scenes");
    const Json* chosen = member(json_, "scene");
    const int64_t shown = chosen ? index_in(*chosen, scenes.size()) : scenes.empty() ? -1 : 0;
    for (size_t s = 0; s < scenes.size(); ++s) {
      Json* roots = member(scenes[s], "nodes");
      if (!roots || !roots->is_array()) continue;
      Json kept = Json::array();
      std::set<int64_t> seen;
      for (size_t i = 0; i < roots->size(); ++i) {
        const int64_t root = index_in((*roots)[i], nodes_);
        const std::string path = fmt::format("/scenes/{}/nodes/{}", s, i);
        if (root >= 0 && !seen.insert(root).second) {
          note("DUPLICATE_ELEMENTS", path, "node {} is listed twice; it is drawn once", root);
          continue;
        }
        if (root >= 0 && parent[size_t(root)] >= 0) {
          if (int64_t(s) != shown) continue;  // of a scene that is not drawn
          if (!is_on_loop(parent, root)) {
            note("SCENE_NON_ROOT_NODE", path, "node {} is a child of node {}; it is taken as a root", root,
                 parent[size_t(root)]);
            drop_child(nodes[size_t(parent[size_t(root)])], root);
            parent[size_t(root)] = -1;
          }
        }
        kept.push_back((*roots)[i]);
      }
      if (kept.size() != roots->size() && !kept.empty()) *roots = std::move(kept);
    }
  }
  static bool is_on_loop(const std::vector<int64_t>& parent, int64_t node) {
    int64_t at = parent[size_t(node)];
    for (size_t steps = 0; at >= 0; ++steps) {
      if (at == node || steps > parent.size()) return true;
      at = parent[size_t(at)];
    }
    return false;
  }
  static void drop_child(Json& node, int64_t child) {
    Json kept = Json::array();
    for (const Json& c : elements(node, "children"))
      if (!(c.is_number_integer() && c.get<int64_t>() == child)) kept.push_back(c);
    if (kept.empty())
      node.erase("children");
    else
      node["children"] = std::move(kept);
  }

  void transforms() {
    const std::span<Json> nodes = elements(json_, "nodes");
    for (size_t n = 0; n < nodes.size(); ++n) {
      Json& node = nodes[n];
      if (const Json* matrix = member(node, "matrix"); matrix && matrix->is_array() && matrix->size() == 16) {
        bool beside = false;
        for (const char* key : {"translation", "rotation", "scale"}) beside |= node.erase(key) > 0;
        if (beside)
          note("NODE_MATRIX_TRS", fmt::format("/nodes/{}/matrix", n),
               "the node has translation, rotation or scale, too; the matrix is taken");
      }
      const Json* rotation = member(node, "rotation");
      if (!rotation || !rotation->is_array() || rotation->size() != 4) continue;
      bool zero = true;
      for (const Json& value : *rotation) zero &= value.is_number() && value.get<double>() == 0;
      if (!zero) continue;
      node.erase("rotation");
      note("ROTATION_NON_UNIT", fmt::format("/nodes/{}/rotation", n),
           "the quaternion is zero; the node is not rotated");
    }
  }

  void lights() {
    Json* extensions = member(json_, "extensions");
    Json* punctual = extensions ? member(*extensions, "KHR_lights_punctual") : nullptr;
    if (!punctual) return;
    const std::span<Json> lights = elements(*punctual, "lights");
    for (size_t i = 0; i < lights.size(); ++i) {
      Json& light = lights[i];
      const std::string path = fmt::format("/extensions/KHR_lights_punctual/lights/{}", i);
      if (const Json* range = member(light, "range"); range && range->is_number() && range->get<double>() == 0) {
        light.erase("range");
        note("VALUE_NOT_IN_RANGE", path + "/range", "0 is no range; the light has none");
      }
      const Json* type = member(light, "type");
      if (!type || !type->is_string() || *type != "spot") continue;
      if (!light.contains("spot")) {
        light["spot"] = Json::object();
        note("UNDEFINED_PROPERTY", path,
             "a spot light without 'spot'; its cone is that of the specification's defaults");
        continue;
      }
      Json& spot = light["spot"];
      if (!spot.is_object()) continue;
      const double outer = number_in(spot, "outerConeAngle", 0.7853981633974483),
                   inner = number_in(spot, "innerConeAngle", 0);
      if (!(inner > outer) || !(outer > 0)) continue;
      spot["innerConeAngle"] = outer;
      note("KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES", path + "/spot",
           "innerConeAngle {} is beyond outerConeAngle {}, which is taken for both", inner, outer);
    }
  }

  void primitives() {
    const std::span<Json> meshes = elements(json_, "meshes");
    const auto used = elements(json_, "extensionsUsed");
    const bool quantized = std::ranges::find(used, "KHR_mesh_quantization") != used.end();
    for (size_t m = 0; m < meshes.size(); ++m) {
      const std::span<Json> all = elements(meshes[m], "primitives");
      for (size_t p = 0; p < all.size(); ++p) {
        const std::string path = fmt::format("/meshes/{}/primitives/{}", m, p);
        Json* attributes = member(all[p], "attributes");
        if (!attributes || !attributes->is_object()) continue;
        if (has_no_elements(all[p], "indices") || has_no_elements(*attributes, "POSITION")) {
          const bool of_indices = has_no_elements(all[p], "indices");
          note("ACCESSOR_COUNT_ZERO", path + (of_indices ? "/indices" : "/attributes/POSITION"),
               "there are no elements; the primitive is left out");
          // In its place, so that the places of others stay; so do accessors that may have no elements.
          const Json& empty = of_indices ? all[p]["indices"] : (*attributes)["POSITION"];
          elements(json_, "accessors")[empty.get<size_t>()] = {
              {"componentType", 5126}, {"type", "SCALAR"}, {"count", 1}};
          all[p] = Json{{"attributes", Json::object()}};
          continue;
        }
        for (auto& [name, value] : attributes->items())
          if (name.starts_with("COLOR_") || (name.starts_with("TEXCOORD_") && !quantized))
            normalize(value, fmt::format("{}/attributes/{}", path, name));
      }
    }
  }
  bool has_no_elements(Json& object, const char* key) {
    const Json* value = member(object, key);
    const std::span<Json> accessors = elements(json_, "accessors");
    const int64_t index = value ? index_in(*value, accessors.size()) : -1;
    if (index < 0) return false;
    const Json* count = member(accessors[size_t(index)], "count");
    return count && count->is_number_integer() && count->get<int64_t>() == 0;
  }
  // In a copy of the accessor: others may mean plain numbers.
  void normalize(Json& value, const std::string& path) {
    const std::span<Json> accessors = elements(json_, "accessors");
    const int64_t index = index_in(value, accessors.size());
    if (index < 0 || !accessors[size_t(index)].is_object()) return;
    const Json& accessor = accessors[size_t(index)];
    const Json component =
        accessor.value("componentType", Json(0));  // where the file says none, that is an error later
    const int64_t type = component.is_number_integer() ? component.get<int64_t>() : 0;
    const bool is_unsigned = type == 5121 || type == 5123;
    if (!is_unsigned || accessor.value("normalized", Json(false)) == true) return;
    const auto [copy, is_new] = normalized_.try_emplace(index, int64_t(accessors.size()));
    if (is_new) {
      Json made = accessor;
      made["normalized"] = true;
      json_["accessors"].push_back(std::move(made));
    }
    note("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", path,
         "whole numbers that are not normalized; they are read as normalized");
    value = copy->second;
  }

  void textures() {
    const size_t images = elements(json_, "images").size(), samplers = elements(json_, "samplers").size();
    const std::span<Json> all = elements(json_, "textures");
    const size_t count = all.size();
    for (size_t t = 0; t < count; ++t) {
      if (!all[t].is_object()) continue;
      const std::string path = fmt::format("/textures/{}", t);
      if (const Json* sampler = member(all[t], "sampler");
          sampler && sampler->is_number_integer() && index_in(*sampler, samplers) < 0) {
        note("UNRESOLVED_REFERENCE", path + "/sampler",
             "unresolved reference: {} (there are {} samplers); the default is "
             "taken",
             sampler->get<int64_t>(), samplers);
        all[t].erase("sampler");
      }
      mend_source(all[t], path, images);
      Json* extensions = member(all[t], "extensions");
      if (!extensions || !extensions->is_object()) continue;
      for (auto& [name, value] : extensions->items())
        mend_source(value, fmt::format("{}/extensions/{}", path, name), images);
    }
    const std::span<Json> materials = elements(json_, "materials");
    for (size_t m = 0; m < materials.size(); ++m) slots(materials[m], fmt::format("/materials/{}", m), count);
  }
  void mend_source(Json& object, const std::string& path, size_t images) {
    Json* source = member(object, "source");
    if (!source || !source->is_number_integer() || index_in(*source, images) >= 0) return;
    note("UNRESOLVED_REFERENCE", path + "/source", "unresolved reference: {} (there are {} images); {}",
         source->get<int64_t>(), images, checker);
    *source = absent_image();
  }
  // Members whose names end in "Texture" are texture infos, in the core and in every extension of materials.
  void slots(Json& object, const std::string& path, size_t count) {
    if (!object.is_object()) return;
    for (auto& [key, value] : object.items()) {
      if (!value.is_object() || key == "extras") continue;
      const std::string at = fmt::format("{}/{}", path, key);
      const Json* index = member(value, "index");
      if (key.ends_with("Texture") && index && index->is_number_integer() && index_in(*index, count) < 0) {
        note("UNRESOLVED_REFERENCE", at + "/index", "unresolved reference: {} (there are {} textures); {}",
             index->get<int64_t>(), count, checker);
        value["index"] = absent_texture();
      } else {
        slots(value, at, count);
      }
    }
  }
  // An image without bytes is drawn as the checker.
  int64_t absent_image() {
    if (absent_image_ >= 0) return absent_image_;
    if (!json_.contains("images") || !json_["images"].is_array()) json_["images"] = Json::array();
    absent_image_ = int64_t(json_["images"].size());
    json_["images"].push_back({{"name", "absent"}, {"uri", "data:image/png;base64,"}});
    return absent_image_;
  }
  int64_t absent_texture() {
    if (absent_texture_ >= 0) return absent_texture_;
    const int64_t image = absent_image();
    if (!json_.contains("textures") || !json_["textures"].is_array()) json_["textures"] = Json::array();
    absent_texture_ = int64_t(json_["textures"].size());
    json_["textures"].push_back({{"source", image}});
    return absent_texture_;
  }

  static constexpr const char* checker = "a magenta and black checker is drawn instead";
  Json& json_;
  size_t nodes_;
  std::map<int64_t, int64_t> normalized_;
  int64_t absent_image_ = -1, absent_texture_ = -1;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> repair_gltf(nlohmann::json& document) { return Repairer(document).run(); }

}  // namespace candela::gltf
