#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>

namespace candela {

inline constexpr std::string_view lights_path = "/extensions/KHR_lights_punctual/lights";

// Which parts of a file the scene that is shown can reach: its nodes and, from there, meshes, skins, cameras, lights,
// materials (of all variants) and their textures. What is wrong with others cannot show.
class UsedParts {
 public:
  // animated: animations are used, too.
  UsedParts(const nlohmann::json& document, bool animated);
  // Of a JSON pointer into the document. Parts of other kinds (accessors, animations, ...) are always used.
  bool uses(std::string_view path) const;

 private:
  void add_node(const nlohmann::json& document, int64_t node);
  void add_ancestors(const nlohmann::json& document);
  std::map<std::string, std::set<int64_t>, std::less<>> parts_;
  bool all_ = false, animated_;
};

// Puts something harmless in the place of an unused part, so that the indices of others stay.
void blank_part(nlohmann::json& document, std::string_view path);

}  // namespace candela
