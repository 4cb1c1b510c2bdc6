#include "passes/debug/light_volume_layer.h"

#include "passes/shared/draw_batches.h"
#include "shared/light_volumes.h"

namespace candela {

Need LightVolumeLayer::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name), "no count of light volumes is wanted (--view, --layers)");
}

LightVolumeLayer::Out LightVolumeLayer::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read_optional(s.lights, Access::vertex_read);
  builder.read_optional(in.volumes.lists, Access::vertex_read);
  builder.read_optional(in.volumes.draws, Access::indirect_read);
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "light_volume.vert#LIST=0#ORDERED=1";
  desc.fragment_shader = "light_volume_layer.frag";
  desc.color_formats = {VK_FORMAT_R32_SFLOAT};
  desc.blend = Blend::additive;
  Out out;
  out.pipeline = builder.pipeline(desc);
  const std::string layer(layers[0].name);
  out.count = builder.write(builder.create(ImageDesc{layer, desc.color_formats[0], s.width_px, s.height_px}),
                            Access::color_attachment);
  builder.publish(layer, out.count);
  return out;
}

void LightVolumeLayer::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment target{out.count};
  commands.begin_picture({&target, 1}, {});
  if (in.volumes.draws) {
    OwnInputs own;
    own.deformed_before = in.volumes.lists;
    shared::DrawPush push = draw_push(commands, in.scene, {}, nullptr, nullptr, own);
    push.lights = commands.address(in.scene.lights);
    commands.bind(out.pipeline);
    commands.push(push);
    commands.set_cull(true, false);
    commands.draw_indirect_count(in.volumes.draws, 0, in.volumes.draws, offsetof(shared::VolumeDraws, count), 1);
  }
  commands.end_rendering();
}

}  // namespace candela
