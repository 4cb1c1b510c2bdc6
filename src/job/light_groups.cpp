#include "job/light_groups.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "scene/light_layers.h"

namespace candela {
namespace {

bool is_lit(const Node& node) { return node.light >= 0 || node.light_instances; }

std::string names_of_lights(const Scene& scene) {
  std::vector<std::string> names;
  size_t unnamed = 0;
  for (const int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    if (!is_lit(node)) continue;
    if (node.name.empty())
      ++unnamed;
    else if (std::ranges::find(names, node.name) == names.end())
      names.push_back(node.name);
  }
  constexpr size_t most_named = 12;
  const size_t more = names.size() > most_named ? names.size() - most_named : 0;
  names.resize(names.size() - more);
  std::string text = names.empty() ? "no node with a light has a name" : "nodes with lights are: " + joined(names);
  if (more > 0) text += fmt::format(" and {} more", more);
  if (unnamed > 0 && !names.empty()) text += fmt::format("; {} have no name", unnamed);
  return text;
}

}  // namespace

std::vector<std::string> light_group_layers(const Job& job) {
  std::vector<std::string> layers;
  if (job.light_groups.empty()) return layers;
  for (const LightGroupRequest& group : job.light_groups) layers.push_back(group.layer());
  layers.push_back(LightGroupRequest{std::string(other_lights), {}}.layer());
  return layers;
}

Expected<void> check_light_groups(const std::vector<LightGroupRequest>& groups) {
  constexpr const char* option = "--light-groups";
  if (groups.size() + 1 > most_light_groups)
    return fail(ErrorKind::usage, option, "{} groups are given; there may be at most {}", groups.size(),
                most_light_groups - 1);
  std::set<std::string> names;
  for (const LightGroupRequest& group : groups) {
    const bool fine =
        std::ranges::all_of(group.name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
    if (!fine || group.name.empty())
      return fail(ErrorKind::usage, option, "'{}' cannot be part of a layer's name; use letters, digits, _ and -",
                  group.name);
    if (group.name == other_lights)
      return fail(ErrorKind::usage, option, "'{}' is the name of the group of all other lights; choose another",
                  group.name);
    if (!names.insert(group.name).second) return fail(ErrorKind::usage, option, "'{}' is given twice", group.name);
  }
  return {};
}

Expected<std::vector<uint32_t>> light_group_of(const Job& job, const Scene& scene,
                                               const std::vector<LightItem>& lights) {
  const uint32_t rest = uint32_t(job.light_groups.size());
  std::vector<uint32_t> of_node(scene.nodes.size(), rest);
  for (uint32_t g = 0; g < rest; ++g)
    for (const std::string& pattern : job.light_groups[g].nodes) {
      bool found = false;
      for (const int n : scene.order) {
        const Node& node = scene.nodes[size_t(n)];
        if (!is_lit(node) || !matches(node.name, pattern)) continue;
        found = true;
        uint32_t& group = of_node[size_t(n)];
        if (group != rest && group != g)
          return fail(ErrorKind::usage, "--light-groups",
                      "the light of node '{}' is in two groups, {} and {}; it may be in one", node.name,
                      job.light_groups[group].name, job.light_groups[g].name);
        group = g;
      }
      if (!found)
        return fail(ErrorKind::usage, "--light-groups", "{}: no node with a light is called '{}'; {}",
                    job.light_groups[g].name, pattern, names_of_lights(scene));
    }
  std::vector<uint32_t> groups;
  for (const LightItem& light : lights) groups.push_back(of_node[light.node]);
  return groups;
}

}  // namespace candela
