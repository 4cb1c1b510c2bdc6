#include <map>
#include <set>

#include "graph/formats.h"
#include "graph/plan.h"

namespace candela {
namespace {

std::string dot_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string shape_text(const ImageDesc& desc) {
  return fmt::format("{} {}{}", image_size_text(desc), format_name(desc.format),
                     desc.samples > 1 ? fmt::format(" {}x", desc.samples) : "");
}
std::string shape_text(const BufferDesc& desc) { return fmt::format("{} bytes", desc.size_bytes); }

}  // namespace

// An edge for each read, and for each write onto what an earlier pass left: from the pass that wrote the subresource
// last to its user.
std::string plan_dot(const FramePlan& plan) {
  std::string out = "digraph plan {\n  rankdir=LR;\n  node [shape=box];\n";
  std::map<std::pair<int, size_t>, std::string> maker;  // resource and subresource to node
  const auto layers_of = [&](int resource) {
    const auto* image = std::get_if<ImageDesc>(&plan.resources[resource].desc);
    return image ? image->layers : 1;
  };
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    if (!plan.resources[i].imported || plan.resources[i].first_pass < 0) continue;
    maker[{int(i), 0}] = fmt::format("import{}", i);
    out += fmt::format("  import{} [label={}, shape=cylinder];\n", i, dot_string(plan.resources[i].name()));
  }
  for (size_t i = 0; i < plan.passes.size(); ++i) {
    const PlanPass& pass = plan.passes[i];
    out += fmt::format("  pass{} [label={}, style=bold];\n", i, dot_string(pass.name));
    std::set<std::pair<std::string, int>> drawn;  // from node, resource
    const std::string self = fmt::format("pass{}", i);
    for (const PlanUse& use : pass.uses) {
      const PlanResource& resource = plan.resources[use.resource];
      const std::string shape = std::visit([](const auto& desc) { return shape_text(desc); }, resource.desc);
      std::set<std::string> nodes;
      for_subresources(use.range, layers_of(use.resource), [&](size_t subresource) {
        const auto from = maker.find({use.resource, subresource});
        if (from != maker.end() && from->second != self) nodes.insert(from->second);
        if (use.writes) maker[{use.resource, subresource}] = self;
      });
      for (const std::string& node : nodes)
        if (pass.steps() == 1 || drawn.emplace(node, use.resource).second)
          out += fmt::format("  {} -> {} [label={}, tooltip={}];\n", node, self, dot_string(resource.name()),
                             dot_string(shape));
    }
  }
  for (size_t i = 0; i < plan.left_out.size(); ++i)
    out += fmt::format("  left{} [label={}, tooltip={}, style=dashed, color=gray, fontcolor=gray];\n", i,
                       dot_string(plan.left_out[i].pass), dot_string(plan.left_out[i].reason));
  return out + "}\n";
}

}  // namespace candela
