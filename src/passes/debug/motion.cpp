#include "passes/debug/motion.h"

#include "shared/motion.h"

namespace candela {

Need MotionLayer::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.wants_motion(), "nobody asks how far surfaces move (--layers motion, subframes.gather)");
}

MotionLayer::Out MotionLayer::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  if (builder.read_optional(in.scene.motion, Access::vertex_read)) {
    if (in.deformed_before) builder.read(in.deformed_before, Access::vertex_read, "deformed vertices before");
    out.drawn = declare_nearest_surface(builder, in.scene, in.draws, in.deformed, name, "motion.frag",
                                        {VK_FORMAT_R32G32_SFLOAT}, {}, "draw.vert#MOTION=1");
  }
  const ImageDesc desc{"motion", VK_FORMAT_R32G32_SFLOAT, in.scene.width_px, in.scene.height_px};
  out.motion = builder.write(builder.create(desc), Access::color_attachment);
  builder.publish("motion", out.motion);
  return out;
}

void MotionLayer::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment motion{out.motion};
  commands.begin_picture(std::span(&motion, 1), out.drawn.depth);
  if (in.scene.motion)
    record_batches(commands, in.scene, in.draws, in.deformed, out.drawn.pipelines, nullptr, nullptr,
                   {in.scene.motion, in.deformed_before});
  commands.end_rendering();
}

}  // namespace candela
