#ifndef CANDELA_SHARED_TRACE_H
#define CANDELA_SHARED_TRACE_H
#include "shared/types.h"

// Trees of the frame's triangles, for rays (bvh/wide_tree.h, reference/accel.h): one buffer, a TraceScene and then its
// tables. Numbers of nodes, blocks and instances count in the whole table, whichever tree they belong to.
SHARED_BEGIN

#ifdef __cplusplus
inline constexpr uint trace_table_align = 256;
inline constexpr uint no_trace = 0xffffffffu;
inline constexpr uint trace_leaf_bit = 0x80000000u, trace_leaf_shift = 26;
inline constexpr uint trace_asked = 0x80000000u, trace_block = 4;
inline constexpr uint trace_masked = 1, trace_blended = 2, trace_glows = 4, trace_mirrored = 8, trace_refracts = 16,
                      trace_single = 32, trace_relief_bit = 64, trace_rounded = 128;  // of TraceItem
#else
const uint trace_table_align = 256u;
const uint no_trace = 0xffffffffu;
const uint trace_leaf_bit = 0x80000000u, trace_leaf_shift = 26u;
const uint trace_asked = 0x80000000u, trace_block = 4u;
const uint trace_masked = 1u, trace_blended = 2u, trace_glows = 4u, trace_mirrored = 8u, trace_refracts = 16u,
           trace_single = 32u, trace_relief_bit = 64u, trace_rounded = 128u;
#endif

// Where the tables begin, in units of trace_table_align bytes.
struct TraceScene {
  uint64_t acceleration;  // of the top level of the device's acceleration structures; 0: there are none
  uint nodes, triangles, items, instances, corners;
  uint geometries, places;    // with acceleration structures; else empty
  uint end;                   // of the last table
  uint world_root, top_root;  // nodes; no_trace: nothing is there
};

// Eight children on a grid of 255 steps along each axis, whose step is a power of two, rounded outwards (Ylitie,
// Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017). A child stands at
// the place whose bits say on which sides of the node it lies (bit a: towards plus on axis a), as far as these are
// free, so that a ray meets children in an order that its direction alone gives. A child is a node, or a leaf:
// trace_leaf_bit, the number of blocks (of the top tree: instances) less one, the first; or no_trace.
struct TraceNode {
  vec3 low;
  uint steps;       // a byte an axis: the exponent of the step, biased as a float's; then a bit for each child there is
  uvec4 bounds[3];  // an axis: a byte a child, from low on; low sides, then high sides
  uvec4 child[2];
};

// Triangles come in blocks of four. `item` of the world tree: trace_asked where a ray must ask the item whether the
// triangle counts, and the item; trace_asked alone inside an instance; no_trace where there is none, which is the end
// of the block. `primitive` counts in the mesh section.
struct TraceTriangle {
  vec3 a;
  uint item;
  vec3 b;
  uint primitive;
  vec3 c;
  float error_m;  // of the world tree: how far off its plane a ray begins that is not to meet it
};

struct TraceItem {    // parallel to FrameData::items
  uint flags;         // trace_...; single: light passes it from behind; rounded: as geometry_rounded
  uint material;      // among the frame's
  uint first_corner;  // no_trace: coverage needs none
};

struct TraceInstance {
  vec4 local_row[3], local_rest[3];  // of local_from_relative: as floats, and what these leave
  vec4 relative_row[3];              // of relative_from_local
  uint item, root;                   // the item with trace_asked, as of a triangle
};

// What coverage is made of at a triangle's corners: the base colour texture's coordinates, transformed, and the
// vertices' alpha. Of reliefs: the height texture's coordinates, not transformed, and the way from the surface to the
// floor in the triangle's space; before a section's triangles stand the least and the largest coordinates.
struct TraceCorners {
  vec2 uv[3];
  vec3 alpha;
};

// Triangles that acceleration structures hold: one for each geometry, by its number in its bottom level and that of the
// instance. The places (four times the block, plus which of it) of its triangles follow each other in their table.
struct TraceGeometry {
  uint item, first_place;
  uint instance;  // among those of the trees; no_trace: corners are in relative space
};

// How shading sends rays, and what it knows of lights with a size. Counts are of one picture of a supersampled frame.
struct RaySettings {
  float occlusion_radius_m, occlusion_fade_m, occlusion_strength;  // hidden by saturate((radius - distance) / fade)
  uint occlusion_rays, sun_samples, lamp_samples;
  uint seed;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(RaySettings) == 28);
static_assert(sizeof(TraceScene) == 48 && sizeof(TraceGeometry) == 12 && sizeof(TraceNode) == 96 &&
              sizeof(TraceTriangle) == 48);
static_assert(sizeof(TraceItem) == 12 && sizeof(TraceInstance) == 152 && sizeof(TraceCorners) == 36);
}  // namespace candela::shared
#else
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TraceSceneRef { TraceScene s; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TraceFloatRef { float f; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TraceUintRef { uint u; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TraceVec4Ref { vec4 v; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TraceUvec4Ref { uvec4 v; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TraceTriangleRef { TraceTriangle t; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TraceItemRef { TraceItem i; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TraceInstanceRef { TraceInstance i; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TraceCornersRef { TraceCorners c; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TraceGeometryRef { TraceGeometry g; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RaySettingsRef { RaySettings s; };
#endif

#endif
