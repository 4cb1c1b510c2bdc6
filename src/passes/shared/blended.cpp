#include "passes/shared/blended.h"

#include "shared/transparency.h"

namespace candela {

Need needs_method(const SceneFacts& facts, const FrameRequest& request, std::string_view method) {
  if (facts.blend_items == 0) return {false, "the scene has no blended surface"};
  return needed_if(request.transparency == method,
                   fmt::format("blended surfaces are drawn by the method {}", request.transparency));
}

void test_depth(GraphicsPipelineDesc& desc, bool tested) {
  desc.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  desc.depth_test = tested;
  desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
}

BatchPipelines declare_blended(GraphBuilder& builder, const BlendedIn& in, GraphicsPipelineDesc desc,
                               const std::string& define) {
  const bool tested = builder.read_optional(in.depth, Access::depth_test);
  declare_lights(builder, in.scene, in.lists);
  declare_fog(builder, in.scene, in.lists, true);
  BatchPipelineChoice choice{std::move(desc), {}};
  if (choice.desc.vertex_shader.empty()) choice.desc.vertex_shader = "draw.vert";
  choice.desc.samples = in.scene.samples;
  test_depth(choice.desc, tested);
  const std::string part = choice.desc.fragment_shader;
  const auto shader = [&](const char* whole) { return with_fog((part.empty() ? whole : part) + define, in.lists); };
  const auto lit = [&](const char* whole) { return with_deep_shadows(shader(whole), in.lists); };
  choice.desc.fragment_shader = lit("shade_forward.frag");
  choice.desc.constants = light_constants(in.lists);
  BatchPipelines all = declare_batches(
      builder, in.scene, in.draws, in.deformed,
      [](const DrawBatch& r) { return r.alpha == AlphaMode::blend && !r.unlit; }, choice);
  choice.desc.fragment_shader = shader("shade_unlit.frag");
  choice.desc.constants = {};
  const BatchPipelines unlit = declare_batches(
      builder, in.scene, in.draws, in.deformed,
      [](const DrawBatch& r) { return r.alpha == AlphaMode::blend && r.unlit; }, choice);
  // Lit and unlit runs interleave by depth, so they go out in one walk.
  for (size_t r = 0; r < all.by_run.size(); ++r)
    if (unlit.by_run[r]) all.by_run[r] = unlit.by_run[r];
  return all;
}

PipelineHandle declare_sums_over(GraphBuilder& builder, const SceneInputs& scene, ImageHandle sum,
                                 ImageHandle absorbed) {
  builder.read(sum, Access::sampled_fragment, "sums");
  builder.read(absorbed, Access::sampled_fragment, "absorbance");
  GraphicsPipelineDesc over;
  over.vertex_shader = "background.vert", over.fragment_shader = "weighted_over.frag";
  over.constants = {{0, "SAMPLES", scene.samples}};
  over.color_formats = {color_format};
  over.samples = scene.samples;
  over.blend = Blend::premultiplied_over;
  return builder.pipeline(over);
}

void record_sums_over(CommandList& commands, const SceneInputs& scene, PipelineHandle over, ImageHandle sum,
                      ImageHandle absorbed, ImageHandle color) {
  const CommandList::Attachment drawn{color};
  commands.begin_picture({&drawn, 1}, {});
  commands.bind(over);
  draw_samples(commands, scene.samples, shared::SumsPush{commands.sampled(sum), commands.sampled(absorbed), 0});
  commands.end_rendering();
}

}  // namespace candela
