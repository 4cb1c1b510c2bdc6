#include <set>

#include "graph/builder.h"

namespace candela {

// Reference counting from the sinks. Declaration order is topological, so one walk backwards meets every reader of a
// version before its producer. A write keeps what the versions before it left in the resource, so it also wants those.
std::vector<bool> prune(const GraphBuilder& builder, std::vector<LeftOut>& left_out) {
  const auto& passes = builder.passes();
  const auto& resources = builder.resources();
  std::set<std::pair<int, int>> wanted;  // resource, version
  for (const int sink : builder.sinks()) wanted.emplace(sink, resources[sink].version);

  std::vector<bool> kept(passes.size(), false);
  for (size_t i = passes.size(); i-- > 0;) {
    for (const PlanUse& use : passes[i].uses)
      if (use.writes && wanted.contains({use.resource, use.version})) kept[i] = true;
    if (!kept[i]) continue;
    for (const PlanUse& use : passes[i].uses) wanted.emplace(use.resource, use.writes ? use.version - 1 : use.version);
  }

  for (size_t i = 0; i < passes.size(); ++i) {
    if (kept[i]) continue;
    std::string made;
    for (const PlanUse& use : passes[i].uses) {
      if (!use.writes) continue;
      if (!made.empty()) made += ", ";
      made += resources[use.resource].name();
    }
    left_out.push_back({passes[i].name, made.empty() ? "it writes nothing" : "nobody reads " + made});
  }
  return kept;
}

}  // namespace candela
