#include "passes/geometry/trace_keys.h"

#include "passes/geometry/features.h"
#include "shared/visibility.h"

namespace candela {

Need TraceKeys::needed(const SceneFacts& facts, const FrameRequest&) const { return needed_for_solid_surfaces(facts); }

TraceKeys::Out TraceKeys::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read(s.trees, Access::compute_read, "the trees for rays");
  for (const BufferHandle b : {s.triangle_numbers, s.materials}) builder.read(b, Access::compute_read, "the scene");
  ComputePipelineDesc desc{"trace_keys.comp", ray_constants(s.rays.stack, false)};
  desc.constants.push_back({30, "SAMPLES", s.samples});
  for (const SpecConstant& c : s.features)
    if (Feature(c.id) == Feature::subsample) desc.constants.push_back(c);
  Out out;
  out.keys = builder.write(
      builder.create(BufferDesc{"keys", uint64_t(s.width_px) * s.height_px * s.samples * sizeof(uint64_t)}),
      Access::compute_write);
  out.pipeline = builder.pipeline(desc);
  return out;
}

void TraceKeys::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  commands.bind(out.pipeline);
  commands.push(shared::TraceKeysPush{commands.address(s.trees), commands.address(out.keys),
                                      commands.address(s.triangle_numbers), s.subsample_ndc});
  commands.dispatch(s.width_px, s.height_px);
}

}  // namespace candela
