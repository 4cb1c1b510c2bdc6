#pragma once
// Of a fragment whose triangle has a relief: it takes the triangle itself, as compute passes do. RELIEF is 2 where a
// pre-pass has drawn the same: then the depth lies before that one by what roundings may make of it. Needs
// lib/scene.glsl with RELIEF, lib/surface.glsl and what lib/triangle.glsl does.
#include "lib/sample_places.glsl"
#include "lib/triangle.glsl"
TrianglePoint relief_at;  // what it shows

// The middle of the samples that its triangle covers. RELIEF_BY_SAMPLE: the sample.
vec2 relief_pixel() {
#ifdef RELIEF_BY_SAMPLE
  return floor(gl_FragCoord.xy) + sample_place_px(RELIEF_SAMPLES, uint(gl_SampleID));
#elif defined(RELIEF_SAMPLES)
  const uint all = (1u << RELIEF_SAMPLES) - 1u, covered = uint(gl_SampleMaskIn[0]) & all;
  if (covered != all && covered != 0u) {
    vec2 place = vec2(0.0);
    for (int s = 0; s < RELIEF_SAMPLES; ++s)
      if ((covered >> s & 1u) != 0u) place += sample_place_px(RELIEF_SAMPLES, uint(s));
    return floor(gl_FragCoord.xy) + place / float(bitCount(covered));
  }
#endif
  return floor(gl_FragCoord.xy) + 0.5;
}

void put_relief_depth(Corners c, vec3 position) {
  if (RELIEF == 2) {
    const vec3 most = max(max(abs(c.p[0]), abs(c.p[1])), max(abs(c.p[2]), abs(position)));
    const float off = 4e-6 * max(most.x, max(most.y, most.z));
    position += frame.perspective != 0u ? -position * min(off * inversesqrt(max(dot(position, position), 1e-30)), 0.5)
        : off * frame.camera_back;
  }
  const vec4 clip = clip_position(position);
  gl_FragDepth = clamp(clip.z / clip.w, 1e-37, 1.0);
}
// Its depth alone. False: the ray passes by.
bool put_relief(uint of_item) {
  const Item item = load_item(of_item);
  const Geometry g = load_geometry(item.geometry);
  const Corners corners = load_corners(frame.indices, item, g, uint(gl_PrimitiveID));
  const ViewRay ray = view_ray(relief_pixel());
  relief_at = meet_triangle(corners, ray);
  if (!meet_relief_depth(item, g, corners, load_material(item.material), ray, relief_at)) return false;
  put_relief_depth(corners, relief_at.position);
  return true;
}
