#pragma once
// Linear premultiplied radiance to display values: exposure, tone curve, encoding, dither; alpha comes out
// straight, or is used up by what stands behind. Needs the push constants of TonemapPush and lib/bindless.glsl.
#include "lib/mean_of_samples.glsl"
#include "lib/tone_curves.glsl"
#include "shared/exposure.h"
layout(constant_id = 0) const int CURVE = 0;  // ToneCurve in passes/post/tonemap.h
layout(constant_id = 1) const int AUTOMATIC = 0;  // exposure by the frame's luminance
layout(constant_id = 2) const int COVERS = 0;  // the source has no alpha
layout(constant_id = 3) const int SAMPLES = 1;  // of the source: their mean is shown
layout(constant_id = 4) const uint BEHIND = 0u;  // 0x1rrggbb: the codes that it is laid over; 0: alpha stays

vec3 srgb_encode(vec3 c) {
  return mix(1.055 * pow(max(c, vec3(1e-7)), vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThan(c, vec3(0.0031308)));
}

// ITU-R BT.709-6, 1.2: what cameras apply. White stays white.
vec3 rec709_encode(vec3 c) {
  return mix(1.099 * pow(max(c, vec3(1e-7)), vec3(0.45)) - 0.099, 4.5 * c, lessThan(c, vec3(0.018)));
}

// PCG in three dimensions (Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020).
uvec3 pcg3d(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  return v;
}
vec3 unit(uvec3 v) { return vec3(v >> 8u) * (1.0 / 16777216.0); }

vec4 display_value(uvec2 p) {
  const vec4 source = SAMPLES > 1 ? mean_of_samples(pc.source, ivec2(p), SAMPLES)
                                  : texelFetch(pass_images[pc.source], ivec2(p), 0);
  const float alpha = COVERS != 0 ? 1.0 : clamp(source.a, 0.0, 1.0);
  vec3 c = max(source.rgb, vec3(0.0)) * pc.exposure;
  if (AUTOMATIC != 0) c *= ExposureResultRef(pc.automatic).r.factor;
  c = min(alpha > 0.0 ? c / alpha : c, vec3(1e30));
  if (CURVE == 1) c = agx(c, pc.agx_min_ev, pc.agx_max_ev);
  if (CURVE == 2) c = reinhard(c);
  if (CURVE == 3) c = aces_hill(c);
  if (CURVE == 4) c = khronos_neutral(c);
  if (CURVE == 5) c = reinhard_luminance(c);
  if (CURVE == 7) c = agx_2020(c, pc.agx_min_ev, pc.agx_max_ev);
  c = clamp(c, 0.0, 1.0);
  c = CURVE == 6 ? rec709_encode(c) : srgb_encode(c);
  if (pc.dither_levels > 0u) {
    // Triangular noise of two code values' width; within half a code value of black and white uniform noise of one,
    // which rounding takes without clipping and so without bias. Black and white themselves stay.
    const vec3 a = unit(pcg3d(uvec3(p, pc.seed))), b = unit(pcg3d(uvec3(p, pc.seed ^ 0x9e3779b9u)));
    const vec3 room = min(c, 1.0 - c) * float(pc.dither_levels);
    const vec3 noise = mix(a - b, a - 0.5, lessThan(room, vec3(0.5))) * vec3(greaterThan(room, vec3(0.0)));
    // Rounded here: an H200 stores the upper code from 0.56 of the way on, which would bias the mean by 1/16 of a code.
    c = floor((c + noise / float(pc.dither_levels)) * float(pc.dither_levels) + 0.5) / float(pc.dither_levels);
  }
  c = clamp(c, 0.0, 1.0);
  if (BEHIND == 0u) return vec4(c, alpha);
  return vec4(mix(vec3(uvec3(BEHIND >> 16u, BEHIND >> 8u, BEHIND) & 255u) / 255.0, c, alpha), 1.0);
}
