#include "passes/surfaces/put_samples.h"

namespace candela {

PutSamples::Out PutSamples::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.samples.buffer, Access::fragment_read, "the shaded samples");
  GraphicsPipelineDesc desc = samples_pipeline("put_samples.frag", in.scene.samples);
  desc.color_formats = {color_format};
  Out out;
  out.pipeline = builder.pipeline(desc);
  out.color = write_color(builder, in.scene, {});
  return out;
}

void PutSamples::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_picture({&color, 1}, {});
  shared::SamplesPush push{};
  push.source = commands.address(in.samples.buffer);
  push.size_px = {in.scene.width_px, in.scene.height_px};
  record_samples(commands, out.pipeline, push);
  commands.end_rendering();
}

}  // namespace candela
