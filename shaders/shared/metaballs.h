#ifndef CANDELA_SHARED_METABALLS_H
#define CANDELA_SHARED_METABALLS_H
#include "shared/scene.h"

SHARED_BEGIN

// A body of metaballs (src/scene/metaballs.h). Lengths are in cells of its lattice, places from the lattice's origin.
struct MetaballBody {
  uint first_block, block_count;
  uint first_ball, ball_count;
  float threshold;
  float cell_m;
  vec3 noise_origin;  // of the lattice's origin, in the noise's cells, which repeat after 256
  float noise_frequency, noise_amplitude;
  // In the deformed buffer, in words: positions of the first chunk, from a chunk to the next, and from its positions to
  // its normals; absent: it has none.
  uint positions, chunk_words, normals;
  uint chunk_count, first_item;  // of the frame's items in the order of drawing
  // Where motion is asked for: what vertices shift by from this lattice's space to that of the time before, metres.
  vec3 before_shift;
  float before_threshold;
};
struct LatticeBall {
  vec3 centre;
  float inverse_square_radius, strength;
};
// The same ball at the time before, from this lattice's origin.
struct LatticeBallBefore {
  LatticeBall ball;
  float shrunk;  // by which fraction of its radius now it was smaller
};
struct MetaballBlock {
  int first_x, first_y, first_z;  // its first cell
  uint first, count;              // of the lists: balls whose supports touch it, in their order
  uint body;
};
struct MetaballsPush {
  uint64_t bodies, balls, blocks, lists;
  uint64_t sums;   // of each block its triangles, then where its triangles begin among the body's
  uint64_t items;  // Item
  uint64_t deformed;
  uint64_t balls_before, deformed_before;  // 0: motion is not asked for
  uint block_count;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint metaball_threads = 64, metaball_scan_threads = 256;
inline constexpr uint rounded_words = 4;  // of each vertex, behind the normals (lib/rounded.glsl)
// Workgroups beyond what one dimension of a dispatch takes on every device go to the second.
inline uvec2 metaball_block_threads(uint blocks) {
  const uint row = blocks < 65535 ? blocks : 65535;
  return {row * metaball_threads, (blocks + 65534) / 65535};
}
static_assert(sizeof(MetaballBody) == 80 && sizeof(LatticeBall) == 20 && sizeof(MetaballsPush) == 80);
}  // namespace candela::shared
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MetaballBodiesRef { MetaballBody b[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LatticeBallsRef { LatticeBall b[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LatticeBallsBeforeRef {
  LatticeBallBefore b[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MetaballBlocksRef { MetaballBlock b[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MetaballSumsRef { uint n[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MetaballItemsRef { Item i[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer MetaballVerticesRef { float f[]; };
#endif

#endif
