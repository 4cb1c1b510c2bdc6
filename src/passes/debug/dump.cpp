#include "passes/debug/dump.h"

#include "base/check.h"
#include "graph/formats.h"
#include "shared/hash.h"

namespace candela {

Dump::Out Dump::declare(GraphBuilder& builder, const In& in) const {
  const ImageDesc desc = std::get<ImageDesc>(builder.resources()[size_t(in.image.resource)].desc);
  Out out;
  out.width_px = desc.width_px, out.height_px = desc.height_px, out.samples = desc.samples;
  const bool multisampled = desc.samples > 1;
  builder.clear_first(in.image);  // the dump may see what a later pass covers
  builder.read(in.image, multisampled ? Access::sampled_compute : Access::transfer_source, desc.name,
               ImageRange::layer(in.layer, in.mip));
  uint64_t bytes = uint64_t(mip_size(desc.width_px, in.mip)) * mip_size(desc.height_px, in.mip);
  if (multisampled) {
    const uint32_t channels = format_channels(desc.format);
    const bool is_unsigned = format_name(desc.format).ends_with("UINT") && !is_depth_format(desc.format);
    out.pipeline = builder.pipeline(ComputePipelineDesc{
        "hash_samples.comp", {{0, "SAMPLES", desc.samples}, {1, "CHANNELS", channels}, {2, "UNSIGNED", is_unsigned}}});
    bytes *= uint64_t(desc.samples) * channels * sizeof(uint32_t);
  } else {
    bytes *= uint64_t(mip_size(desc.depth_px, in.mip)) * copied_bytes(desc.format);
  }
  out.bytes = builder.write(builder.create(BufferDesc{"dump." + desc.name, bytes, BufferMemory::host_read}),
                            multisampled ? Access::compute_write : Access::transfer_destination);
  builder.sink(out.bytes);
  return out;
}

void Dump::record(CommandList& commands, const In& in, const Out& out) const {
  if (out.samples == 1) {
    commands.copy_to_buffer(in.image, out.bytes);
    return;
  }
  commands.bind(out.pipeline);
  CHECK(commands.sampled(in.image) == 0);  // where the shader reads
  commands.push(shared::HashSamplesPush{commands.address(out.bytes), {out.width_px, out.height_px}});
  commands.dispatch(out.width_px, out.height_px);
}

}  // namespace candela
