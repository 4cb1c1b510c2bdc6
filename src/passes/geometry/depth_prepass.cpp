#include "passes/geometry/depth_prepass.h"

namespace candela {

std::span<const Knob> MaskKnobs::table() {
  static const Knob table[] = {
      {.name = "by_sample",
       .member = &MaskKnobs::by_sample,
       .lowest = 0,
       .highest = 1,
       .levels = {0, 0, 0, 1},
       .description =
           "1: a mask keeps the samples of a pixel whose alpha reaches the cutoff, so that edges of masks are as "
           "smooth as those of meshes; 0: it keeps all samples or none; the exact end is supersampling"},
  };
  return table;
}

Need DepthPrepass::needed(const SceneFacts& facts, const FrameRequest&) const {
  if (refracting) return needed_if(facts.refracting_items > 0, "the scene has no surface that refracts");
  return needed_for_solid_surfaces(facts);
}

DepthPrepass::Out DepthPrepass::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "depth_prepass.vert";
  choice.desc.depth_format = depth_format;
  choice.desc.samples = in.scene.samples;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.masked_fragment = "depth_prepass.frag";
  if (knobs.by_sample != 0 && in.scene.samples > 1)
    choice.masked_fragment += fmt::format("#BY_SAMPLE={}", in.scene.samples);
  choice.relief_fragment = "relief_depth.frag";
  out.pipelines = declare_batches(
      builder, in.scene, in.draws, in.deformed,
      [&](const DrawBatch& r) {
        return (refracting ? r.alpha != AlphaMode::blend : r.solid()) && (!in.lines_alone || r.is_lines());
      },
      choice);
  ImageDesc desc{"depth", depth_format, in.scene.width_px, in.scene.height_px, in.scene.samples};
  out.depth = builder.write(in.depth ? in.depth : builder.create(desc), Access::depth_attachment);
  return out;
}

void DepthPrepass::record(CommandList& commands, const In& in, const Out& out) const {
  commands.begin_picture({}, out.depth, PicturePart::seen);
  record_batches(commands, in.scene, in.draws, in.deformed, out.pipelines);
  commands.end_rendering();
}

}  // namespace candela
