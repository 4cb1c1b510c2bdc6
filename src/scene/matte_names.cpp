#include "scene/matte_names.h"

#include <fmt/format.h>

#include <set>

#include "base/hash.h"

namespace candela {

std::vector<std::string> unique_names(const std::vector<std::string>& given, const std::string& kind) {
  std::set<std::string> used;
  std::set<uint32_t> used_ids;
  const auto take = [&](const std::string& name) {
    if (used.contains(name) || !used_ids.insert(matte_id(name)).second) return false;
    return used.insert(name).second;
  };
  std::vector<std::string> names;
  for (size_t i = 0; i < given.size(); ++i) {
    const std::string base = fmt::format("{} #{}", given[i].empty() ? kind : given[i], i);
    std::string name = given[i].empty() ? base : given[i];
    for (int more = 1; !take(name); ++more) name = more == 1 ? base : fmt::format("{}.{}", base, more);
    names.push_back(std::move(name));
  }
  return names;
}

std::vector<std::string> node_names(const Scene& scene) {
  std::vector<std::string> given;
  for (const Node& node : scene.nodes) given.push_back(node.name);
  return unique_names(given, "node");
}

std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> given;
  for (const Material& material : scene.materials) given.push_back(material.name);
  given.push_back("default material");
  return unique_names(given, "material");
}

uint32_t matte_id(std::string_view name) {
  const uint32_t hash = hash32(name), exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::vector<uint32_t> matte_ids(const std::vector<std::string>& names) {
  std::vector<uint32_t> ids;
  for (const std::string& name : names) ids.push_back(matte_id(name));
  return ids;
}

}  // namespace candela
