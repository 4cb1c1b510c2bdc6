#ifndef CANDELA_SHARED_POSE_ITEMS_H
#define CANDELA_SHARED_POSE_ITEMS_H
#include "shared/scene.h"
#include "shared/visibility.h"

SHARED_BEGIN

// Columns of an affine matrix in double: an instance's, to its node's space, or a node's, to relative space.
struct WideTransform {
  dvec3 x_axis, y_axis, z_axis, origin;
};

// The instances of a node, or, in the first row, what the host has posed.
struct ItemGroup {
  WideTransform relative_from_node;
  uint first_transform, transform_count;
  uint first_instance;  // among all of the scene
  uint posed;           // 1: by the host
  dvec3 world_origin;   // of the node
};

// Consecutive items in the order of drawing: instance by instance the sections of a group, or the host's.
struct ItemSpan {
  uint first, count;
  uint group;
  uint source;         // the first section, or posed item
  uint section_count;  // of each instance; 0: the host's
};

struct ItemSection {
  vec3 box_min, box_max;  // local space
  uint geometry, first_index, index_count;
  uint material, object_id;
};

// Batches of consecutive items (shared/visibility.h): of the items of a span that a run draws.
struct BatchSpan {
  uint first, count;
  uint span;
  uint per_instance;  // 0: the host's
  uint source;        // posed batch
  uint cull_bit;      // of the span's first item
  uint flags;
};

struct PoseItemsPush {
  uint64_t groups, spans, sections, instances, batch_spans;
  uint64_t posed_transforms, posed_items, posed_batches;
  uint64_t transforms, items, batches;
  uint64_t posed_places, places;  // Place (shared/scene.h), one for each transform; 0: nothing reads them
  uint transform_count, item_count, batch_count;
  uint group_count, span_count, batch_span_count;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(WideTransform) == 96 && sizeof(ItemGroup) == 136 && sizeof(ItemSpan) == 20);
static_assert(sizeof(ItemSection) == 44 && sizeof(BatchSpan) == 28 && sizeof(PoseItemsPush) == 128);
}  // namespace candela::shared
#else
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer WideTransformsRef { WideTransform t[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ItemGroupsRef { ItemGroup g[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ItemSpansRef { ItemSpan s[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ItemSectionsRef { ItemSection s[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer BatchSpansRef { BatchSpan s[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer TransformsOutRef { Transform t[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer WorldPlacesOutRef { Place p[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer ItemsOutRef { Item i[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer BatchesOutRef { TriangleBatch b[]; };
#endif
#endif
