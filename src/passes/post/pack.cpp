#include "passes/post/pack.h"

#include "base/check.h"

namespace candela {
namespace {

uint32_t form_of(const Pack::In::Source& source) {
  if (!source.packing) return PACK_NOTHING;
  switch (*source.packing) {
    case Packing::half_planes:
      return PACK_HALF;
    case Packing::float_planes:
      return PACK_FLOAT;
    case Packing::rgb:
      return source.format == VK_FORMAT_R8G8B8A8_UNORM ? PACK_RGB8 : PACK_RGB16;
    case Packing::texels:
      break;
  }
  CHECK_MSG(false, "texels are copied, not packed");
}

uint32_t pixels_a_thread(uint32_t form) {
  return form == PACK_RGB8 ? 4 : form == PACK_HALF || form == PACK_RGB16 ? 2 : 1;
}

}  // namespace

PackLayout pack_layout(Packing packing, VkFormat format, uint32_t components, uint32_t width_px, uint32_t height_px) {
  const uint64_t width = width_px, height = height_px;
  PackLayout layout;
  uint64_t planes = 1;
  switch (packing) {
    case Packing::texels:
      layout.row_bytes = width * format_bytes(format);
      break;
    case Packing::half_planes:
      layout.row_bytes = (width + 1) / 2 * 4;
      planes = components;
      break;
    case Packing::float_planes:
      layout.row_bytes = width * 4;
      planes = components;
      break;
    case Packing::rgb:
      layout.row_bytes = format == VK_FORMAT_R8G8B8A8_UNORM ? (width + 3) / 4 * 12 : (width + 1) / 2 * 12;
      break;
  }
  layout.plane_bytes = layout.row_bytes * height;
  layout.bytes = layout.plane_bytes * planes;
  return layout;
}

Need Pack::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.for_files, "pictures are read back as they are");
}

Pack::Out Pack::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  const uint64_t counts_bytes = in.sources.size() * sizeof(shared::PackCounts);
  out.device_counts = builder.create(BufferDesc{.name = "pack.counts", .size_bytes = counts_bytes, .zeroed = true});
  for (const In::Source& source : in.sources) {
    builder.begin_step();
    builder.read(source.image, Access::sampled_compute, source.layer);
    out.device_counts = builder.write(out.device_counts, Access::compute_write);
    BufferHandle buffer;
    if (source.packing) {
      const PackLayout layout =
          pack_layout(*source.packing, source.format, source.components, in.width_px, in.height_px);
      buffer = builder.write(builder.create(BufferDesc{"pack." + source.layer, layout.bytes, BufferMemory::host_read}),
                             Access::compute_write);
      builder.sink(buffer);
    }
    out.buffers.push_back(buffer);
    std::vector<SpecConstant> constants = {{0, "FORM", form_of(source)}, {1, "COMPONENTS", source.components}};
    if (source.look) constants.push_back({2, "LOOK", 1});
    if (source.depth) constants.push_back({3, "BACKGROUND", 1});
    if (source.cover) constants.push_back({4, "COVER", 1});
    out.pipelines.push_back(builder.pipeline(ComputePipelineDesc{"pack.comp", std::move(constants)}));
  }
  // Counted in device memory: atomics on the host's cross the bus.
  builder.begin_step();
  builder.read(out.device_counts, Access::transfer_source, "counts");
  out.counts = builder.write(builder.create(BufferDesc{"pack.counts.host", counts_bytes, BufferMemory::host_read}),
                             Access::transfer_destination);
  builder.sink(out.counts);
  return out;
}

void Pack::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t step = commands.step();
  if (step == in.sources.size()) {
    commands.copy_buffer(out.device_counts, 0, out.counts, 0, in.sources.size() * sizeof(shared::PackCounts));
    return;
  }
  const In::Source& source = in.sources[step];
  commands.bind(out.pipelines[step]);
  shared::PackPush push{};
  if (source.packing) {
    const PackLayout layout = pack_layout(*source.packing, source.format, source.components, in.width_px, in.height_px);
    push.target = commands.address(out.buffers[step]);
    push.row_words = uint32_t(layout.row_bytes / 4);
    push.plane_words = uint32_t(layout.plane_bytes / 4);
  }
  push.counts = commands.address(out.device_counts);
  push.source = commands.sampled(source.image);
  push.layer = step;
  push.size_px = {in.width_px, in.height_px};
  push.corner_px = in.corner_px;
  push.scale = *source.scale;
  commands.push(push);
  const uint32_t pixels = pixels_a_thread(form_of(source));
  commands.dispatch((in.width_px + pixels - 1) / pixels, in.height_px);
}

}  // namespace candela
