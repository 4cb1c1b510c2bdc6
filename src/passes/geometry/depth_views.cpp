#include "passes/geometry/depth_views.h"

#include "shared/draw.h"

namespace candela {

// Maps in which nothing opaque stands too: of what is seen through there are images beside them.
Need DepthViews::needed(const SceneFacts& facts, const FrameRequest&) const {
  if (facts.blend_items + facts.refracting_items > 0) return {};
  return needed_for_solid_surfaces(facts);
}

DepthViews::Out DepthViews::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "depth_view.vert";
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.masked_fragment = "depth_prepass.frag";
  out.pipelines = declare_batches(
      builder, in.scene, in.draws, in.deformed,
      [](const DrawBatch& r) { return r.solid() && r.topology == Topology::triangles; }, choice);
  out.depth = builder.create(image_desc(*in.image, depth_format));
  for (uint32_t layer = 0; layer < in.image->layers; ++layer)
    out.depth = builder.write(out.depth, Access::depth_attachment, ImageRange::layer(layer));
  return out;
}

void DepthViews::record(CommandList& commands, const In& in, const Out& out) const {
  const std::vector<shared::View>& views = in.image->views;
  for (uint32_t v = 0; v < views.size(); ++v) {
    const shared::View& view = views[v];
    if (v == 0 || views[v - 1].layer != view.layer)
      commands.begin_rendering({}, out.depth, ImageRange::layer(view.layer));
    if (view.size_px != glm::uvec2(in.image->size_px)) {
      commands.set_viewport(view.origin_px, view.size_px);
      commands.set_scissor(view.origin_px, view.size_px);
    }
    record_view_depth(commands, in.scene, in.draws, in.deformed, out.pipelines, v, view);
    if (v + 1 == views.size() || views[v + 1].layer != view.layer) commands.end_rendering();
  }
}

}  // namespace candela
