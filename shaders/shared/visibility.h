#ifndef CANDELA_SHARED_VISIBILITY_H
#define CANDELA_SHARED_VISIBILITY_H
#include "shared/types.h"
SHARED_BEGIN
// Up to triangle_batch_size consecutive triangles of one item, which one workgroup rasterizes. Batches stand in the
// order of drawing.
struct TriangleBatch {
  uint item;
  uint first_triangle;
  uint cull_bit;  // of the item among the masks of culling (shared/cull.h)
  uint flags;     // batch_*
};
// A triangle over many pixels, or a piece of one that was clipped (lib/rasterize.glsl, Piece), and where its tiles
// begin among those of all.
struct LargeTriangle {
  uint64_t first_tile;
  uint triangle;  // its number among all of the frame: 64 for each batch
  uint view;
  vec3 depth;
  uvec2 p[3];  // signed
};
// Of how many workgroups rasterize_large.comp is, a chunk of tiles each.
struct TileGroups {
  uint x, y, z;
};
struct RasterizePush {
  uint64_t deformed, indices, batches, masks;
  // One for each sample: bits of its depth, and 1 + the triangle's number below them. Of views: the bits of each
  // texel's depth, layer by layer.
  uint64_t keys;
  uint64_t large;   // a word that counts triangles, and their tiles below, then LargeTriangles
  uint64_t groups;  // TileGroups
  uint64_t views;   // View (shared/cull.h); only of views
  uint64_t places;  // Place (shared/scene.h); only of lamps' views that are drawn apart
  vec2 subsample_ndc;
  float subsample_footprint;
  uint batch_count;
  uint most_large;             // room among them
  uint small_px;               // bounds up to this side are one thread's
  uint view_masks;             // bits of culling's masks for each view
  uint image_px;               // side of the views' image
  uvec2 part_first, part_end;  // pixels that are wanted; only of the camera
};
struct ViewTexelsPush {
  uint64_t texels;
  uint image_px, image;
};
struct ViewTilesPush {
  uint64_t texels, views;    // View (shared/cull.h)
  uint first_view, size_px;  // of the views, all of them as large
  uint image_px;             // side of the layers of texels
  uint image;
};
struct TraceKeysPush {
  uint64_t trees, keys;
  uint64_t numbers;  // of the first triangle of each item of the trees, or absent: not drawn opaque
  vec2 subsample_ndc;
};
struct TraversalHeatPush {
  uint64_t trees;
  vec2 subsample_ndc;  // as in TraceKeysPush; 0
  uint target;
};
struct TreeBoxesPush {
  uint64_t trees;
  uint first_node, nodes;  // of the tree that is drawn
  uint instance;           // that shows it; no_trace: none, it is of relative space
  uint holds_instances;    // its leaves hold those
  uint leaves;             // 1: these are drawn, 0: inner nodes
};
struct SamplesPush {  // of passes that put a buffer's samples into images
  uint64_t source;
  uint64_t tiles;  // TilesRef; only where tiles are drawn
  uvec2 size_px;
};
struct BlendedTilesPush {
  uint64_t groups;  // CullGroup
  uint64_t kept;    // masks of culling
  uint64_t tiles;
  vec2 subsample_ndc;
  uint group_count;
};
SHARED_END

#ifdef __cplusplus
namespace candela::shared {
enum : uint { batch_cull_back = 1u, batch_mirrored = 2u, batch_masked = 4u, batch_unlit = 8u, batch_relief = 16u };
inline constexpr uint triangle_batch_size = 64, raster_tile_px = 16, raster_chunk = 8;
// Batches that a workgroup looks at, of one of many views, most of which hold little; of few views, one.
inline constexpr uint raster_view_batches = 8, raster_many_views = 64;
inline constexpr int raster_most_small_px = 64;  // a side of what 32-bit edge functions hold
inline constexpr uint depth_tile_px = 16;
static_assert(sizeof(TriangleBatch) == 16 && sizeof(LargeTriangle) == 56 && sizeof(RasterizePush) == 120);
}  // namespace candela::shared
#else
const uint batch_cull_back = 1u, batch_mirrored = 2u, batch_masked = 4u, batch_unlit = 8u, batch_relief = 16u;
const uint triangle_batch_size = 64u, raster_tile_px = 16u, raster_chunk = 8u;
const uint raster_view_batches = 8u, raster_many_views = 64u;
const int raster_most_small_px = 64;
const uint depth_tile_px = 16u;
const uint large_tile_bits = 40u;
const uint64_t large_tile_mask = (1ul << large_tile_bits) - 1ul;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BatchesRef { TriangleBatch b[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer KeysRef { uint64_t k[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DepthsRef { uint d[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer LargeRef {
  uint64_t ends;
  LargeTriangle t[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TileGroupsRef { TileGroups g; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer SamplesRef { vec4 s[]; };
// A word for each tile of depth_tile_px; not 0: something blended may be there.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TilesRef { uint t[]; };
#endif
#endif
