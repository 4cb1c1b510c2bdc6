#include "passes/geometry/trace_keys.h"

#include "passes/shared/features.h"
#include "passes/shared/keys_buffer.h"
#include "shared/visibility.h"

namespace candela {

Need TraceKeys::needed(const SceneFacts& facts, const FrameRequest&) const { return needed_for_solid_surfaces(facts); }

TraceKeys::Out TraceKeys::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const int traversal = s.rays.tree.traversal;
  const bool by_pipeline = traversal == BvhKnobs::by_pipeline;
  const Access read = by_pipeline ? Access::rays_read : Access::compute_read;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read(s.trees, read, "the trees for rays");
  for (const BufferHandle b : {s.triangle_numbers, s.materials}) builder.read(b, read, "the scene");
  std::vector<SpecConstant> constants = ray_constants(s.rays.stack, false, traversal == BvhKnobs::by_query);
  constants.push_back({30, "SAMPLES", s.samples});
  for (const SpecConstant& c : s.features)
    if (Feature(c.id) == Feature::subsample || Feature(c.id) == Feature::relief) constants.push_back(c);
  Out out;
  out.keys = builder.write(builder.create(keys_buffer(s)), by_pipeline ? Access::rays_write : Access::compute_write);
  if (by_pipeline)
    out.pipeline = builder.pipeline(
        RayPipelineDesc{"trace_keys.rgen", "trace_keys.rmiss", "trace_keys.rchit", "trace_keys.rahit", constants});
  else
    out.pipeline = builder.pipeline(ComputePipelineDesc{std::string("trace_keys.comp") +
                                                            (traversal == BvhKnobs::by_query ? "#TRACE_QUERY=1" : "") +
                                                            (meets_reliefs(constants) ? "#RELIEFS=1" : ""),
                                                        constants});
  return out;
}

void TraceKeys::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  commands.bind(out.pipeline);
  commands.push(shared::TraceKeysPush{commands.address(s.trees), commands.address(out.keys),
                                      commands.address(s.triangle_numbers), s.subsample_ndc()});
  if (s.rays.tree.traversal == BvhKnobs::by_pipeline)
    commands.trace_rays(s.width_px, s.height_px);
  else
    commands.dispatch_picture(s.width_px, s.height_px, PicturePart::seen);
}

}  // namespace candela
