#version 460
// One thread an item in the order of drawing: what it shows and its box in relative space, or a copy of what the host
// has posed. The box is that of scene/deformation_bounds.cpp (Arvo, "Transforming Axis-Aligned Bounding Boxes",
// Graphics Gems, 1990), widened by what float arithmetic may be off.
#include "lib/pose_items.glsl"

const double RIGID_ROUNDINGS = 16.0lf / 16777216.0lf;
const double LEAST_FLOAT = 1.1754943508222875e-38lf;

// The last span that begins at or before this item.
uint span_of(uint item) {
  uint low = 0u, high = pc.span_count;
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (ItemSpansRef(pc.spans).s[middle].first <= item)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void box_of(WideTransform m, ItemSection section, out vec3 box_min, out vec3 box_max) {
  const dvec3 low = dvec3(section.box_min), high = dvec3(section.box_max);
  precise dvec3 centre = low + high;
  centre = centre * 0.5lf;
  precise dvec3 half_size = high - low;
  half_size = half_size * 0.5lf;
  precise dvec3 middle = m.x_axis * centre.x + m.y_axis * centre.y;
  precise dvec3 rest = m.z_axis * centre.z + m.origin;
  middle = middle + rest;
  precise dvec3 r = abs(m.x_axis) * half_size.x;
  r = r + abs(m.y_axis) * half_size.y;
  r = r + abs(m.z_axis) * half_size.z;
  const dvec3 reach = max(abs(low), abs(high));
  precise dvec3 magnitude = abs(m.origin);
  magnitude = magnitude + abs(m.x_axis) * reach.x;
  magnitude = magnitude + abs(m.y_axis) * reach.y;
  magnitude = magnitude + abs(m.z_axis) * reach.z;
  precise dvec3 pad = magnitude * RIGID_ROUNDINGS;
  pad = pad + LEAST_FLOAT;
  precise dvec3 least = middle - r;
  least = least - pad;
  precise dvec3 most = middle + r;
  most = most + pad;
  box_min = vec3(least), box_max = vec3(most);
}

void main() {
  const uint place = thread();
  if (place >= pc.item_count) return;
  const ItemSpan span = ItemSpansRef(pc.spans).s[span_of(place)];
  const uint i = place - span.first;
  if (span.section_count == 0u) {
    ItemsOutRef(pc.items).i[place] = ItemsRef(pc.posed_items).i[span.source + i];
    return;
  }
  const ItemGroup group = ItemGroupsRef(pc.groups).g[span.group];
  const uint instance = i / span.section_count;
  const ItemSection section = ItemSectionsRef(pc.sections).s[span.source + i % span.section_count];
  vec3 box_min, box_max;
  box_of(relative_from_instance(group, instance), section, box_min, box_max);
  precise vec3 centre = box_min + box_max;
  centre = centre * 0.5;
  precise vec3 extent = box_max - box_min;
  extent = extent * 0.5;
  ItemsOutRef(pc.items).i[place] = Item(centre, group.first_transform + instance, extent, section.geometry,
      section.first_index, section.index_count, section.material, section.object_id);
}
