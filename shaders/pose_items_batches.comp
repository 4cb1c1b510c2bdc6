#version 460
// One thread a batch of triangles that compute rasterizes: those of an instance stand together, section by section. Or
// a copy of what the host has made.
#include "lib/pose_items.glsl"

// The last span that begins at or before this batch.
uint span_of(uint batch) {
  uint low = 0u, high = pc.batch_span_count;
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (BatchSpansRef(pc.batch_spans).s[middle].first <= batch)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void main() {
  const uint place = thread();
  if (place >= pc.batch_count) return;
  const BatchSpan batches = BatchSpansRef(pc.batch_spans).s[span_of(place)];
  const uint i = place - batches.first;
  if (batches.per_instance == 0u) {
    BatchesOutRef(pc.batches).b[place] = BatchesRef(pc.posed_batches).b[batches.source + i];
    return;
  }
  const ItemSpan span = ItemSpansRef(pc.spans).s[batches.span];
  const uint instance = i / batches.per_instance;
  uint left = i % batches.per_instance, section = 0u;
  for (; section + 1u < span.section_count; ++section) {
    const uint triangles = ItemSectionsRef(pc.sections).s[span.source + section].index_count / 3u;
    const uint of_section = (triangles + triangle_batch_size - 1u) / triangle_batch_size;
    if (left < of_section) break;
    left -= of_section;
  }
  const uint item = instance * span.section_count + section;
  BatchesOutRef(pc.batches).b[place] =
      TriangleBatch(span.first + item, left * triangle_batch_size, batches.cull_bit + item, batches.flags);
}
