#include "graph/builder.h"

namespace candela {

// Reference counting from the sinks. Declaration order is topological, so one walk backwards meets every reader of a
// subresource before its producer. A write keeps what was in the subresource before, so it also wants that.
std::vector<bool> prune(const GraphBuilder& builder, std::vector<LeftOut>& left_out, const KeptKeys& keys) {
  const auto& passes = builder.passes();
  const auto& resources = builder.resources();
  const auto layers_of = [&](int resource) {
    const auto* image = std::get_if<ImageDesc>(&resources[resource].desc);
    return image ? image->layers : 1;
  };
  const auto is_filled = [&](size_t r) { return resources[r].key && keys.filled.contains(*resources[r].key); };
  const auto is_to_fill = [&](size_t r) { return resources[r].key && keys.seen.contains(*resources[r].key); };

  // Which passes stay, where images of earlier frames are taken or not.
  const auto needed = [&](bool takes_kept) {
    std::vector<std::vector<bool>> wanted(resources.size());  // by subresource; a buffer is one
    for (size_t i = 0; i < resources.size(); ++i) {
      const auto* image = std::get_if<ImageDesc>(&resources[i].desc);
      wanted[i].resize(image ? size_t(image->mips) * image->layers : 1, false);
    }
    for (const int sink : builder.sinks()) wanted[sink].assign(wanted[sink].size(), true);
    std::vector<bool> kept(passes.size(), false);
    const auto walk = [&] {
      for (size_t i = passes.size(); i-- > 0;) {
        for (const PlanUse& use : passes[i].uses)
          if (use.writes && !(takes_kept && is_filled(size_t(use.resource))))
            for_subresources(use.range, layers_of(use.resource), [&](size_t s) {
              if (wanted[use.resource][s]) kept[i] = true;
            });
        if (!kept[i]) continue;
        for (const PlanUse& use : passes[i].uses)
          for_subresources(use.range, layers_of(use.resource), [&](size_t s) { wanted[use.resource][s] = true; });
      }
    };
    walk();
    // An image that later frames find filled is filled whole, where anything is done with it.
    for (size_t r = 0; r < resources.size(); ++r) {
      const auto is_true = [](bool part) { return part; };
      if (!is_to_fill(r) || std::ranges::none_of(wanted[r], is_true) || std::ranges::all_of(wanted[r], is_true))
        continue;
      wanted[r].assign(wanted[r].size(), true);
      walk();
      r = size_t(-1);  // what that keeps may use another
    }
    return kept;
  };
  const std::vector<bool> kept = needed(true);
  for (size_t i = 0; i < passes.size(); ++i)
    for (const PlanUse& use : passes[i].uses)
      if (kept[i] && use.writes && is_filled(size_t(use.resource)))
        throw GraphError(fmt::format("pass '{}' makes more than '{}', which is kept from an earlier frame",
                                     passes[i].name, resources[size_t(use.resource)].name()));
  std::string kept_reason;
  for (size_t r = 0; r < resources.size() && kept_reason.empty(); ++r)
    if (is_filled(r)) kept_reason = resources[r].kept_reason;
  const std::vector<bool> alone = kept_reason.empty() ? kept : needed(false);

  for (size_t i = 0; i < passes.size(); ++i) {
    if (kept[i]) continue;
    if (alone[i]) {
      left_out.push_back({passes[i].name, kept_reason});
      continue;
    }
    std::vector<std::string> made;
    for (const PlanUse& use : passes[i].uses)
      if (use.writes && std::find(made.begin(), made.end(), resources[use.resource].name()) == made.end())
        made.push_back(resources[use.resource].name());
    left_out.push_back(
        {passes[i].name, made.empty() ? "it writes nothing" : fmt::format("nothing reads {}", fmt::join(made, ", "))});
  }
  return kept;
}

}  // namespace candela
