#version 460
// The integral over slices (src/passes/occlusion/occlusion.h). All in camera space and metres.
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/occlusion_points.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SHAPE = 257;

layout(constant_id = 1) const int KEEPS_NORMALS = 0;

#include "lib/pi.glsl"
#include "lib/occlusion_depth.glsl"
#include "lib/occlusion_texel.glsl"
const bool BENT = OCCLUSION_BENT(SHAPE) != 0;

float texel_point(ivec2 texel) {
  for (int i = 0; i < TEXEL_PX * TEXEL_PX; ++i) {
    const ivec2 pixel = texel_pixel(texel, i);
    if (any(greaterThanEqual(uvec2(pixel), frame.size_px))) continue;
    const float point = point_of_texel(texelFetch(pass_images[pc.points], pixel, 0).r, i);
    if (point > 0.0) return point;
  }
  return 0.0;
}

// The difference of the positions at p and beside it along one axis, from the side whose surface goes on through p.
// On a plane depth is linear over the picture: the side is taken whose two next depths, prolonged, miss p's less. Where
// there is none the surface is taken to be as far off as at p.
vec3 difference(ivec2 p, ivec2 axis, int s, float depth, float metres, vec3 at, vec2 place_px) {
  vec3 best = occlusion_position(place_px + vec2(axis), metres, pc.subsample_ndc) - at;
  float least = 3e38;
  for (int side = -1; side <= 1; side += 2) {
    const float d1 = depth_beside(p + side * axis, s), d2 = depth_beside(p + 2 * side * axis, s);
    if (!(d1 > 0.0)) continue;
    const float miss = abs((d2 > 0.0 ? 2.0 * d1 - d2 : d1) - depth);
    if (!(miss < least)) continue;
    least = miss;
    best = float(side) * (occlusion_position(place_px + vec2(side * axis), depth_m(d1), pc.subsample_ndc) - at);
  }
  return best;
}

// Of the surface at a depth sample, towards the viewer.
vec3 surface_normal(ivec2 p, int s, vec2 place_px, float metres, vec3 at) {
  const float depth = sample_depth(p, s);
  // Scaled: the square of a difference may underflow or overflow.
  const vec3 dx = difference(p, ivec2(1, 0), s, depth, metres, at, place_px) / metres,
             dy = difference(p, ivec2(0, 1), s, depth, metres, at, place_px) / metres;
  const vec3 to_eye = frame.perspective != 0u ? -normalize(at / metres) : vec3(0.0, 0.0, 1.0);
  const vec3 n = cross(dx, dy);
  const float size = length(n);
  if (!(size > 0.0)) return to_eye;
  return dot(n, to_eye) < 0.0 ? -n / size : n / size;
}

// Abramowitz and Stegun, 4.4.45: off by 6.7e-5 rad at most.
float fast_acos(float x) {
  const float a = abs(x);
  const float r = sqrt(max(1.0 - a, 0.0)) * (1.5707288 + a * (-0.2121144 + a * (0.0742610 - 0.0187293 * a)));
  return x < 0.0 ? PI - r : r;
}

// The integral of cos(t - g) |sin t| dt from 0 to the horizon at angle h, whose cosine is c and whose sign is side; g
// is the normal's angle.
float arc(float c, float side, float cos_g, float sin_g) {
  const float s2 = max(1.0 - c * c, 0.0);
  return 0.5 * (s2 * cos_g + side * sin_g * (fast_acos(c) - c * sqrt(s2)));
}

// Sixteen different values over 4 by 4 texels, so that what every texel does not see, the 16 about it do.
vec2 noise(uvec2 texel) {
  const uvec2 p = (texel + pc.pattern) & 3u;
  const uint x = p.x, y = p.x ^ p.y;
  const uint i = (y & 1u) << 3 | (x & 1u) << 2 | (y & 2u) | (x & 2u) >> 1;
  return vec2(float(i) + 0.5, float(bitfieldReverse(i) >> 28) + 0.5) / 16.0;
}

// Over the same arc, of the directions themselves: along the view vector and along the slice.
vec2 arc_direction(float c, float side, float cos_g, float sin_g) {
  const float s = sqrt(max(1.0 - c * c, 0.0)), s3 = s * s * s;
  return vec2(cos_g * (1.0 - c * c * c) + side * sin_g * s3, side * cos_g * s3 + sin_g * (2.0 - 3.0 * c + c * c * c)) /
      3.0;
}

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  const float point = texel_point(texel);
  float open = 1.0;
  vec3 n = vec3(0.0, 0.0, 1.0), bent = n;
  if (point > 0.0) {
    const vec2 place_px = occlusion_place_px(texel, point, SHAPE);
    const vec3 p = occlusion_position(place_px, point, pc.subsample_ndc);
    const bool perspective = frame.perspective != 0u;
    const float distance = perspective ? length(p) : point;
    const vec3 v = perspective ? -p / distance : vec3(0.0, 0.0, 1.0);
    const ivec2 pixel = ivec2(place_px);
    n = surface_normal(pixel, int(floatBitsToUint(point) & occlusion_name_mask(SHAPE)) % SAMPLES, place_px, point, p);
    n = normalize(n + max(1e-4 - dot(n, v), 0.0) * v);
    // Axes across the view vector, which slices are even about.
    const vec3 right = normalize(vec3(v.z, 0.0, -v.x)), up = cross(v, right);
    const vec2 half_px = 0.5 * vec2(frame.size_px);
    const vec2 slope = perspective ? p.xy / point : vec2(0.0);
    // The sphere of the radius looks larger than at its middle's distance; about the eye it is everywhere.
    const float unit_m = pc.by_distance != 0u ? distance : 1.0;
    const float radius_m = pc.radius_m * unit_m, fade_m = pc.fade_m * unit_m;
    float reach_m = radius_m;
    if (perspective) reach_m *= inversesqrt(max(1.0 - reach_m / distance * (reach_m / distance), 1e-4));
    const vec2 offset = noise(uvec2(texel));
    float lost = 0.0, whole = 0.0;
    bent = vec3(0.0);
    for (int k = 0; k < pc.slices; ++k) {
      const float phi = PI * (float(k) + fract(offset.x + pc.turn)) / float(pc.slices);
      const vec3 d = cos(phi) * right + sin(phi) * up;
      const vec3 axis = cross(v, d);
      const float along = dot(n, d), towards = dot(n, v), aside = dot(n, axis);
      const float size2 = along * along + towards * towards;
      const float size = sqrt(size2);
      const float cos_g = towards / size, sin_g = along / size;
      // Moves a point of the tangent plane beside the slice into it, in the plane: the next texel never lies in the
      // slice exactly, and a slope across it would look like a horizon.
      const vec3 into = axis - (aside / size2) * (along * d + towards * v);
      // On the picture, in pixels a metre.
      vec2 step_px = (d.xy + slope * d.z) * half_px / frame.tan_half;
      step_px.y = -step_px.y;
      if (perspective) step_px /= point;
      const float px_per_m = max(length(step_px), 1e-20);
      const vec2 way = step_px / px_per_m;
      float reach_px = min(reach_m * px_per_m, 2.0 * (half_px.x + half_px.y));
      for (int side = -1; side <= 1; side += 2) {
        const vec2 to = float(side) * way;
        // As far as the picture.
        const vec2 edge = mix(place_px, vec2(frame.size_px) - place_px, greaterThan(to, vec2(0.0))) /
            max(abs(to), 1e-6);
        const float end_px = min(reach_px, min(edge.x, edge.y));
        float horizon = float(-side) * sin_g;  // cosine of the tangent plane's angle
        float area = size * arc(horizon, float(side), cos_g, sin_g);
        whole += area;
        vec2 open_arc = vec2(0.0), arc_left = vec2(0.0);
        if (BENT) open_arc = arc_left = arc_direction(horizon, float(side), cos_g, sin_g);
        for (int j = 0; j < pc.samples; ++j) {
          const float u = (float(j) + offset.y) / float(pc.samples);
          // Denser towards the point; the first in the next pixel.
          const float at_px = max(end_px * u * u, 1.0 + float(j) / float(pc.samples));
          if (at_px > end_px) continue;
          const ivec2 other = ivec2(floor(place_px + to * at_px));
          if (other == pixel || any(lessThan(other, ivec2(0))) || any(greaterThanEqual(uvec2(other), frame.size_px)))
            continue;
          const float z = texelFetch(pass_images[pc.points], other, 0).r;
          if (!(z > 0.0)) continue;
          const vec3 s = occlusion_point(other, z, PIXELS, pc.subsample_ndc) - p;
          const float hidden = clamp((radius_m - length(s)) / fade_m, 0.0, 1.0);
          const vec3 in_slice = s - dot(s, axis) * into;
          const float c = dot(in_slice, v) * inversesqrt(max(dot(in_slice, in_slice), 1e-30));
          // At grazing angles it may have been moved to the other side.
          if (!(hidden > 0.0) || !(c > horizon) || !(float(side) * dot(in_slice, d) > 0.0)) continue;
          horizon = min(c, 1.0);
          const float left = size * arc(horizon, float(side), cos_g, sin_g);
          lost += hidden * (area - left);
          area = left;
          if (!BENT) continue;
          const vec2 next = arc_direction(horizon, float(side), cos_g, sin_g);
          open_arc -= hidden * (arc_left - next);
          arc_left = next;
        }
        if (BENT) bent += size * (open_arc.x * v + open_arc.y * d);
      }
    }
    open = whole > 0.0 ? clamp(1.0 - pc.strength * lost / whole, 0.0, 1.0) : 1.0;
    bent = length(bent) > 1e-4 ? normalize(bent) : n;
  }
  if (KEEPS_NORMALS != 0) imageStore(storage_uint_images[pc.normals], texel, uvec4(pack_normal(n)));
  imageStore(storage_images[pc.open], texel, vec4(open, point, BENT ? place_of_normal(bent) : vec2(0.0)));
}
