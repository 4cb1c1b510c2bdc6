// Items of groups, as scene/frame_data.cpp poses them: in double, in the order in which the host adds and multiplies.
#include "shared/pose_items.h"
layout(push_constant, scalar) uniform Push { PoseItemsPush pc; };
layout(local_size_x = 64) in;

uint thread() { return (gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex; }

// By the columns of the matrix; w of the vector is 0 or 1.
dvec3 transform(WideTransform m, dvec3 v, double w) {
  precise dvec3 sum = m.x_axis * v.x;
  sum = sum + m.y_axis * v.y;
  sum = sum + m.z_axis * v.z;
  sum = sum + m.origin * w;
  return sum;
}

WideTransform relative_from_instance(ItemGroup group, uint i) {
  const WideTransform m = WideTransformsRef(pc.instances).t[group.first_instance + i];
  return WideTransform(transform(group.relative_from_node, m.x_axis, 0.0lf),
      transform(group.relative_from_node, m.y_axis, 0.0lf), transform(group.relative_from_node, m.z_axis, 0.0lf),
      transform(group.relative_from_node, m.origin, 1.0lf));
}
