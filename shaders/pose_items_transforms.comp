#version 460
// One thread a transform: an instance's, rounded once, or a copy of what the host has posed.
#include "lib/pose_items.glsl"

// The last group whose transforms begin at or before this one.
uint group_of(uint transform) {
  uint low = 0u, high = pc.group_count;
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (ItemGroupsRef(pc.groups).g[middle].first_transform <= transform)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void main() {
  const uint place = thread();
  if (place >= pc.transform_count) return;
  const ItemGroup group = ItemGroupsRef(pc.groups).g[group_of(place)];
  if (group.posed != 0u) {
    TransformsOutRef(pc.transforms).t[place] = TransformsRef(pc.posed_transforms).t[place];
    return;
  }
  const WideTransform m = relative_from_instance(group, place - group.first_transform);
  TransformsOutRef(pc.transforms).t[place] = Transform(vec4(m.x_axis.x, m.y_axis.x, m.z_axis.x, m.origin.x),
      vec4(m.x_axis.y, m.y_axis.y, m.z_axis.y, m.origin.y), vec4(m.x_axis.z, m.y_axis.z, m.z_axis.z, m.origin.z));
}
