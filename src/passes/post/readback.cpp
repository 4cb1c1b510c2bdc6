#include "passes/post/readback.h"

namespace candela {

Readback::Out Readback::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  for (const In::Source& source : in.sources) {
    builder.read(source.image, Access::transfer_source, source.layer);
    const BufferHandle buffer =
        builder.write(builder.create(BufferDesc{"readback." + source.layer, source.bytes, BufferMemory::host_read}),
                      Access::transfer_destination);
    builder.sink(buffer);
    out.buffers.push_back(buffer);
  }
  return out;
}

void Readback::record(CommandList& commands, const In& in, const Out& out) const {
  for (size_t i = 0; i < in.sources.size(); ++i)
    if (in.part)
      commands.copy_part_to_buffer(in.sources[i].image, out.buffers[i], *in.part);
    else
      commands.copy_to_buffer(in.sources[i].image, out.buffers[i]);
}

}  // namespace candela
