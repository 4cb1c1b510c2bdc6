#pragma once
// Depth along the view axis, in [-1, 1] between the nearest and the farthest surface that is seen through: by its
// logarithm, or evenly where the view is parallel. Needs lib/frame.glsl and, as pc.table, those two depths, floats.
float warped_depth(vec3 relative_position) {
  const vec2 ends = uintBitsToFloat(unpackUint2x32(pc.table));
  float z = -dot(relative_position, frame.camera_back);
  float first = ends.x, last = ends.y;
  if (frame.perspective != 0u) {
    z = log2(max(z, ends.x));
    first = log2(first);
    last = log2(last);
  }
  return clamp(2.0 * (z - first) / max(last - first, 1e-3 * max(abs(first), 1.0)) - 1.0, -1.0, 1.0);
}
