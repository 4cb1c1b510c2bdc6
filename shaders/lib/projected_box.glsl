#pragma once
// What an item's box covers of the picture at most, and how near it comes: rounding only makes it larger and nearer.
// Needs lib/frame.glsl.
struct ProjectedBox {
  bool bounded;             // false: it reaches the eye's plane or is not finite, and the rest means nothing
  ivec2 first_px, last_px;  // of what lies in the picture
  float nearest;            // reversed depth; above 1: before the near plane
};

// 16 roundings of a sum of what is added up; the corners' own are within it.
const float projection_rounding = 16.0 * 1.1920929e-7;
// Of depths that hardware interpolates, against those of the corners.
const float depth_rounding = 1.0 / 4096.0;
// Beyond a box's bounds: rasterization snaps corners to a grid finer than this.
const float border_px = 1.0;

ProjectedBox project_box(Item item, vec2 subsample_ndc) {
  const mat4 m = frame.clip_from_relative;
  const vec3 reach = abs(item.bounds_centre) + item.bounds_extent;
  const vec4 rounding =
      projection_rounding * (abs(m[0]) * reach.x + abs(m[1]) * reach.y + abs(m[2]) * reach.z + abs(m[3]));
  ProjectedBox box;
  box.bounded = true;
  box.nearest = 0.0;
  vec2 low = vec2(1.0), high = vec2(-1.0);
  for (uint i = 0u; i < 8u; ++i) {
    const vec3 side = vec3(i & 1u, (i >> 1) & 1u, i >> 2) * 2.0 - 1.0;
    const vec4 clip = m * vec4(item.bounds_centre + side * item.bounds_extent, 1.0);
    const float w = clip.w - rounding.w, z = clip.z + rounding.z;
    box.bounded = box.bounded && w > 0.0;
    box.nearest = max(box.nearest, z / w);
    const vec2 ndc = clip.xy / clip.w - subsample_ndc;
    const vec2 error = (rounding.xy + abs(clip.xy) / clip.w * rounding.w) / w;
    low = min(low, ndc - error);
    high = max(high, ndc + error);
  }
  box.nearest *= 1.0 + depth_rounding;
  const vec2 size = vec2(frame.size_px), last = size - 1.0;
  box.first_px = ivec2(clamp((0.5 * low + 0.5) * size - border_px, vec2(0.0), last));
  box.last_px = ivec2(clamp((0.5 * high + 0.5) * size + border_px, vec2(0.0), last));
  return box;
}
