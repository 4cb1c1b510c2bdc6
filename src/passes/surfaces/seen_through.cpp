#include "passes/surfaces/seen_through.h"

#include "shared/refraction.h"

namespace candela {

void declare_seen_through(GraphBuilder& builder, const SceneInputs& scene, const SeenThrough& seen,
                          RunPipelineChoice& choice) {
  builder.read(seen.picture, Access::sampled_fragment, "the picture behind");
  builder.read(seen.pyramid, Access::sampled_fragment, "the picture's levels");
  builder.read_optional(seen.behind, Access::sampled_fragment);
  choice.desc.vertex_shader += "#REFRACTION=1";
  choice.desc.fragment_shader += seen.behind ? "#REFRACTION=2" : "#REFRACTION=1";
  if (seen.lobe_samples > 0) choice.desc.constants.push_back({40, "REFRACTION_SAMPLES", seen.lobe_samples});
  if (scene.samples > 1) choice.desc.constants.push_back({41, "REFRACTION_DEPTH_SAMPLES", scene.samples});
}

OwnInputs own_inputs(CommandList& commands, const SeenThrough& seen) {
  OwnInputs own;
  own.word = REFRACTION_IMAGES(commands.sampled(seen.picture), commands.sampled(seen.pyramid),
                               seen.behind ? commands.sampled(seen.behind) : 0u);
  return own;
}

}  // namespace candela
