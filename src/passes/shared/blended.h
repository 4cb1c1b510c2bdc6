#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/knob_tables.h"
#include "passes/shared/pass.h"

namespace candela {

// What the methods of transparency share (FrameRequest::transparency): all draw the same blended surfaces, shaded by
// the same shaders, and differ in how they come over each other. Not a pass.
using BlendedKnobs = std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs>;
struct BlendedIn {
  using MadeBy = Lighting::MadeBy;
  SceneInputs scene;
  Draws draws;
  BufferHandle deformed;   // optional
  Lighting lists;          // empty: every light for every pixel
  ImageHandle depth;       // optional: nothing opaque lies in front without it
  ImageHandle color;       // what lies behind them, premultiplied; `sorted` makes it where there is none
  ImageHandle glass = {};  // optional, of `sorted`: depth of surfaces that refract; what is not behind them is left out
};
// The method that draws surfaces which refract together with blended ones, in the place of the pass refraction.
inline constexpr std::string_view method_with_glass = "phenomenological";
Need needs_method(const SceneFacts& facts, const FrameRequest& request, std::string_view method);

// Pipelines of all blended runs with shade_forward.frag and shade_unlit.frag under `define` ("#WEIGHTED=1"; empty:
// they put out premultiplied radiance), tested against the opaque depth. desc: attachments and blending, and, where it
// names a fragment shader, that one for both.
BatchPipelines declare_blended(GraphBuilder& builder, const BlendedIn& in, GraphicsPipelineDesc desc,
                               const std::string& define = {});
// The depth test that draws blended surfaces behind nothing opaque.
void test_depth(GraphicsPipelineDesc& desc, bool tested);

// The last step of methods that sum surfaces: the mean of their own light (`sum`), over what all hide together of the
// picture (`absorbed`, an absorbance in red).
PipelineHandle declare_sums_over(GraphBuilder& builder, const SceneInputs& scene, ImageHandle sum,
                                 ImageHandle absorbed);
void record_sums_over(CommandList& commands, const SceneInputs& scene, PipelineHandle over, ImageHandle sum,
                      ImageHandle absorbed, ImageHandle color);

// Draws a triangle over the whole picture, sample by sample, with `push` and the sample's number in
// `push.sample_number`: a shader that reads a sample of an image and covers that one alone needs no feature of the
// device.
template <class Push>
void draw_samples(CommandList& commands, uint32_t samples, Push push) {
  commands.set_cull(false, false);
  for (push.sample_number = 0; push.sample_number < samples; ++push.sample_number) {
    commands.push(push);
    commands.draw(3);
  }
}

}  // namespace candela
