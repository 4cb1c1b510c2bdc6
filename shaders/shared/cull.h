#ifndef CANDELA_SHARED_CULL_H
#define CANDELA_SHARED_CULL_H
#include "shared/types.h"

SHARED_BEGIN

// One workgroup's fraction of a draw batch: up to cull_group_size consecutive items of one run.
struct CullGroup {
  uint first_item, item_count;
  uint run;          // whose count this group adds to
  uint first_group;  // of the run: the groups from here to before this one give the offset
  uint is_last;      // of its run: writes the run's draw count
  uint hides;        // 1: opaque or masked triangles, which hide what is behind them and may be hidden
  uint is_blended;
};
// As VkDrawIndexedIndirectCommand.
struct DrawCommand {
  uint index_count, instance_count, first_index;
  int vertex_offset;
  uint first_instance;
};

// A view from which the scene's items are culled and their depth drawn: a cascade, a cube's face, a spot. Relative
// space; inside of a plane is dot(n, p) + w >= 0 with n of unit length; a plane of zeros holds everything.
struct View {
  mat4 clip_from_relative;
  vec4 planes[6];  // an item wholly outside one of them is not drawn
  vec4 served[4];  // an item wholly inside all of them is not drawn: a finer view serves what it can darken
  float least_px;  // orthographic views: an item narrower and lower than this, in texels, is not drawn; 0: none
  uint flags;      // view_*
  uvec2 origin_px, size_px;  // of the viewport in its layer
  uint layer;                // of the image that the view is drawn to
  // Of lamps' maps that are drawn apart (passes/shared/views.h): where the light is in the world, as a float and what
  // it leaves; the depth of its range, for what lies farther off is not in the map; and the tile of the image that is
  // read.
  vec3 origin, origin_rest;
  float least_depth;
  uvec2 tile_px;
  uint tile_layer;
  // With view_skips_standing: the tile of what stands, over a copy of which this view's is drawn.
  uvec2 under_px;
  uint under_layer;
};

struct CullPush {
  uint64_t groups;
  uint64_t masks;      // cull_mask_words words a view and group: a bit for each item that stays
  uint64_t survivors;  // a count for each view and group
  uint64_t commands;
  uint64_t counts;   // of commands, for each view and run
  uint64_t views;    // View; the first of the range
  uint64_t regions;  // the first command of each view and run, and where the last region ends
  uint64_t moving;   // a bit for each node of the scene: what it shows may move; only where views tell these apart
  uint group_count, run_count, view_count;
  uint culling;  // 0: everything is kept
};

// Occlusion culling (passes/geometry/occlusion_cull.h). Masks and survivors are as in CullPush.
struct OccludersPush {
  uint64_t groups;
  uint64_t kept;  // masks of culling by the view's planes
  uint64_t masks, survivors;
  vec2 subsample_ndc;  // as in DrawPush
  float first_phase_px;
  uint group_count;
};
struct OcclusionCullPush {
  uint64_t groups;
  uint64_t kept, occluders;             // masks
  uint64_t visible, visible_survivors;  // what the occluders' depth does not hide
  uint64_t rest, rest_survivors;        // of these, what is not among the occluders
  uint64_t report;                      // OcclusionReport; 0: it is not read
  vec2 subsample_ndc;
  uint pyramid;  // its place among the pass's images
  uint group_count;
};
struct OcclusionReport {
  uint kept, occluders, rest, hidden;  // items
};
// A level of the depth pyramid: of the frame's depth (lib/frame_depth.glsl), or of the finer level in its place.
struct DepthPyramidPush {
  uint64_t keys;
  uvec2 source_px, target_px;
  uint depth, target;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
// view_of_lamp: what glows all over casts no shadow in it (scene/glow.h).
// view_skips_*: what moves, or all else, is not drawn in it (FrameLamps::moving).
enum : uint {
  view_has_served = 1u,
  view_is_perspective = 2u,
  view_of_lamp = 4u,
  view_skips_moving = 8u,
  view_skips_standing = 16u,
};
inline constexpr uint cull_group_size = 256, cull_mask_words = cull_group_size / 32;
// Groups beyond what one dimension of a dispatch takes on every device (65535) go to the second.
inline uvec2 cull_threads(uint groups) {
  const uint row = groups < 65535 ? groups : 65535;
  return {row * cull_group_size, (groups + 65534) / 65535};
}
static_assert(sizeof(CullGroup) == 28 && sizeof(DrawCommand) == 20 && sizeof(CullPush) == 80);
static_assert(sizeof(View) == 304 && offsetof(View, planes) == 64 && offsetof(View, least_px) == 224);
}  // namespace candela::shared
#else
const uint view_has_served = 1u, view_is_perspective = 2u, view_of_lamp = 4u, view_skips_moving = 8u,
           view_skips_standing = 16u;
const uint cull_group_size = 256u, cull_mask_words = cull_group_size / 32u;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CullGroupsRef { CullGroup g[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ViewsRef { View v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RegionsRef { uint first[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DrawCommandsRef { DrawCommand d[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CountsRef { uint n[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MasksRef { uint m[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer OcclusionReportRef { OcclusionReport r; };
#endif

#endif
