#version 460
// One thread a transform: an instance's, rounded once, and where its origin lies in the world; or a copy of what the
// host has posed.
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
    if (pc.places != 0ul) WorldPlacesOutRef(pc.places).p[place] = WorldPlacesRef(pc.posed_places).p[place];
    return;
  }
  const WideTransform m = relative_from_instance(group, place - group.first_transform);
  TransformsOutRef(pc.transforms).t[place] = Transform(vec4(m.x_axis.x, m.y_axis.x, m.z_axis.x, m.origin.x),
      vec4(m.x_axis.y, m.y_axis.y, m.z_axis.y, m.origin.y), vec4(m.x_axis.z, m.y_axis.z, m.z_axis.z, m.origin.z));
  if (pc.places == 0ul) return;
  const uint instance = group.first_instance + place - group.first_transform;
  const WideTransform turned = group.relative_from_node;
  const dvec3 origin = transform(WideTransform(turned.x_axis, turned.y_axis, turned.z_axis, group.world_origin),
      WideTransformsRef(pc.instances).t[instance].origin, 1.0lf);
  const vec3 nearest = vec3(origin);
  WorldPlacesOutRef(pc.places).p[place] = Place(nearest, vec3(origin - dvec3(nearest)));
}
