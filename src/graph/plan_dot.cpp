#include <map>

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
  return fmt::format("{}x{} {}{}", desc.width_px, desc.height_px, format_name(desc.format),
                     desc.samples > 1 ? fmt::format(" {}x", desc.samples) : "");
}
std::string shape_text(const BufferDesc& desc) { return fmt::format("{} bytes", desc.size_bytes); }

}  // namespace

// An edge for each read, and for each write onto what an earlier pass left: from the pass that made the version to its
// user.
std::string plan_dot(const FramePlan& plan) {
  std::string out = "digraph plan {\n  rankdir=LR;\n  node [shape=box];\n";
  std::map<std::pair<int, int>, std::string> maker;  // resource and version to node
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    if (!plan.resources[i].imported || plan.resources[i].first_pass < 0) continue;
    maker[{int(i), 0}] = fmt::format("import{}", i);
    out += fmt::format("  import{} [label={}, shape=cylinder];\n", i, dot_string(plan.resources[i].name()));
  }
  for (size_t i = 0; i < plan.passes.size(); ++i) {
    const PlanPass& pass = plan.passes[i];
    out += fmt::format("  pass{} [label={}, style=bold];\n", i, dot_string(pass.name));
    for (const PlanUse& use : pass.uses) {
      const auto from = maker.find({use.resource, use.writes ? use.version - 1 : use.version});
      if (from == maker.end()) continue;
      const PlanResource& resource = plan.resources[use.resource];
      const std::string shape = std::visit([](const auto& desc) { return shape_text(desc); }, resource.desc);
      out += fmt::format("  {} -> pass{} [label={}, tooltip={}];\n", from->second, i, dot_string(resource.name()),
                         dot_string(shape));
    }
    for (const PlanUse& use : pass.uses)
      if (use.writes) maker[{use.resource, use.version}] = fmt::format("pass{}", i);
  }
  for (size_t i = 0; i < plan.left_out.size(); ++i)
    out += fmt::format("  left{} [label={}, tooltip={}, style=dashed, color=gray, fontcolor=gray];\n", i,
                       dot_string(plan.left_out[i].pass), dot_string(plan.left_out[i].reason));
  return out + "}\n";
}

}  // namespace candela
