#version 460
// One round of the filter of texels by rays: the mean over 5 by 5 texels, `stride` apart, whose outer rows count half,
// so that the first round takes each texel of the squares that share a sequence alike (occlusion_rays.comp). Texels off
// the tangent plane and those that face elsewhere count less (Dammertz, Sewtz, Hanika, Lensch, "Edge-Avoiding A-Trous
// Wavelet Transform for fast Global Illumination Filtering", 2010). Later rounds, whose texels are means of all
// directions, also know contacts: a texel that is more or less open than noise explains counts less.
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionFilterPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/occlusion_points.glsl"
#include "lib/openness.glsl"
layout(local_size_x = occlusion_filter_x, local_size_y = occlusion_filter_y) in;
layout(constant_id = 0) const int SHAPE = 257;
// Side of the square of texels, `stride` apart, that a thread makes: 2 where strides are 1 or 4. They share their taps,
// each of which is fetched and unpacked once.
layout(constant_id = 1) const int BLOCK = 2;

// Variance of fractions within which a texel counts as alike, before it is divided by the noise's fall.
const float LEAST_VARIANCE = 0.1;

struct Target {
  vec4 middle;
  vec3 p, n;
  float own, unlike;
  vec2 open;    // sums: of the fraction, and of the mirror direction
  vec2 bright;  // of all the sky, and of what is open
  float weights;
};
// Of a texel's last two numbers.
vec2 bright_of(vec4 texel) {
  return sky_has_lights() ? vec2(texel.z, texel.z * unpack_open(texel.w).x) : texel.zw;
}
Target targets[4];
ivec2 first;

// What a texel x, y strides from a target counts for it.
struct Tap {
  vec3 q, facing;
  vec2 there, bright;
};
void add(inout Target target, Tap tap, int x, int y) {
  const int across = abs(x), down = abs(y);
  if (across > 2 || down > 2) return;
  const float off = tap.there.x - target.own;
  const float w = (across == 2 ? 0.5 : 1.0) * (down == 2 ? 0.5 : 1.0) * occlusion_likeness(tap.q, target.p, target.n) *
      exp2(OCCLUSION_TURN * (dot(target.n, tap.facing) - 1.0) - target.unlike * off * off);
  if (!(w > 0.0)) return;
  target.open += w * tap.there;
  target.bright += w * tap.bright;
  target.weights += w;
}

// x, y: strides from the first target.
void take(int x, int y) {
  const ivec2 other = first + pc.stride * ivec2(x, y);
  if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(pc.texels)))) return;
  const vec4 o = texelFetch(pass_images[pc.open], other, 0);
  if (!(o.y > 0.0)) return;
  const Tap tap = Tap(occlusion_point(other, o.y, SHAPE, pc.subsample_ndc),
      unpack_normal(texelFetch(pass_uint_images[pc.normals], other, 0).r), unpack_open(o.x), bright_of(o));
  add(targets[0], tap, x, y);
  if (BLOCK == 1) return;
  add(targets[1], tap, x - 1, y);
  add(targets[2], tap, x, y - 1);
  add(targets[3], tap, x - 1, y - 1);
}

void main() {
  const ivec2 thread = ivec2(gl_GlobalInvocationID.xy);
  first = BLOCK == 1 ? thread : pc.stride == 1 ? 2 * thread : 8 * (thread >> 2) + (thread & 3);
  bool any_surface = false;
  for (int i = 0; i < 4; ++i) {
    const ivec2 texel = min(first + pc.stride * ivec2(i & 1, i >> 1), ivec2(pc.texels) - 1);
    targets[i] = Target(vec4(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0, vec2(0.0), vec2(0.0), 0.0);
    if (i >= BLOCK * BLOCK) continue;
    targets[i].middle = texelFetch(pass_images[pc.open], texel, 0);
    targets[i].p = occlusion_point(texel, targets[i].middle.y, SHAPE, pc.subsample_ndc);
    targets[i].n = unpack_normal(texelFetch(pass_uint_images[pc.normals], texel, 0).r);
    targets[i].own = unpack_open(targets[i].middle.x).x;
    targets[i].unlike = pc.sharpness / max(targets[i].own * (1.0 - targets[i].own), LEAST_VARIANCE);
    any_surface = any_surface || targets[i].middle.y > 0.0;
  }
  if (any_surface)
    for (int y = -2; y < BLOCK + 2; ++y) {
      take(-2, y);
      take(-1, y);
      take(0, y);
      take(1, y);
      take(2, y);
      if (BLOCK == 2) take(3, y);
    }
  for (int i = 0; i < BLOCK * BLOCK; ++i) {
    const ivec2 texel = first + pc.stride * ivec2(i & 1, i >> 1);
    if (any(greaterThanEqual(texel, ivec2(pc.texels)))) continue;
    const vec4 middle = targets[i].middle;
    const float weights = targets[i].weights;
    if (!(middle.y > 0.0 && weights > 0.0)) {
      imageStore(storage_images[pc.smooth_open], texel, middle);
      continue;
    }
    const vec2 open = targets[i].open / weights;
    vec2 bright = targets[i].bright / weights;
    // Whether reflected bright spots are open is not averaged: at edges, where they would leak, it changes at once.
    if (sky_has_lights())
      bright.y = pack_open(open_diffuse(open.x, bright.x, bright.y), unpack_open(middle.w).y);
    imageStore(storage_images[pc.smooth_open], texel, vec4(pack_open(open.x, open.y), middle.y, bright));
  }
}
