#include "passes/shared/reflected.h"

#include "gpu/command_list.h"

namespace candela {

shared::ReflectedSurfaces surfaces_of(CommandList& commands, const Reflected& r) {
  return {commands.sampled(r.z), commands.sampled(r.surface), commands.sampled(r.reflectance), commands.sampled(r.sky)};
}

PipelineHandle declare_reflected(GraphBuilder& builder, const SceneInputs& scene, const Reflected& reflected,
                                 ImageHandle depth, const std::vector<VkFormat>& formats, bool is_tested,
                                 const std::string& terms) {
  builder.read(scene.constants, Access::uniform_read, "the frame's constants");
  for (const ImageHandle image :
       {reflected.light, reflected.z, reflected.surface, reflected.reflectance, reflected.sky, depth})
    builder.read(image, Access::sampled_fragment, "reflections");
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "background.vert";
  desc.fragment_shader = "reflections_over.frag";
  if (!terms.empty()) desc.fragment_shader += fmt::format("#TERMS={}", formats.size()) + terms;
  desc.color_formats = formats;
  desc.depth_format = is_tested ? depth_format : VK_FORMAT_UNDEFINED;
  desc.samples = scene.samples;
  desc.blend = Blend::additive;
  if (reflected.texel_px != 1) desc.constants.push_back({0, "SIDE", reflected.texel_px});
  if (scene.samples != 1) desc.constants.push_back({1, "SAMPLES", scene.samples});
  return builder.pipeline(desc);
}

void record_reflected(CommandList& commands, const SceneInputs& scene, const Reflected& reflected, ImageHandle depth,
                      PipelineHandle pipeline) {
  shared::ReflectionsOverPush push{};
  push.at = surfaces_of(commands, reflected);
  push.light = commands.sampled(reflected.light);
  push.depth = commands.sampled(depth);
  push.texels = commands.size(reflected.light);
  push.subsample_ndc = scene.subsample_ndc();
  commands.bind(pipeline);
  commands.push(push);
  commands.set_cull(false, false);
  commands.draw(3);
}

}  // namespace candela
