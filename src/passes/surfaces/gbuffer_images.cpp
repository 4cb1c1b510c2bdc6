#include "passes/surfaces/gbuffer_images.h"

namespace candela {

void read_gbuffer(GraphBuilder& builder, const GBufferImages& gbuffer, Access access) {
  builder.read(gbuffer.images[0], access, "the G-buffer");
  for (uint32_t i = 1; i < gbuffer.count; ++i) builder.read(gbuffer.images[i], access, "the G-buffer");
}

uint64_t gbuffer_places(CommandList& commands, const GBufferImages& gbuffer) {
  uint64_t places = 0;
  for (uint32_t i = 0; i < gbuffer.count; ++i) places |= uint64_t(commands.sampled(gbuffer.images[i])) << (4 * i);
  return places;
}

void read_gbuffer_reliefs(GraphBuilder& builder, const GBufferImages& gbuffer, const SceneInputs& s,
                          BufferHandle deformed, Access access) {
  if (!gbuffer.reliefs) return;
  for (const BufferHandle b : {s.vertices, s.indices, s.items, s.transforms, s.geometries, s.materials})
    builder.read(b, access, "the triangles of reliefs");
  builder.read_optional(deformed, access);
}

}  // namespace candela
