#version 460
// A picture as a file holds it, so that the host copies and compresses, and nothing else. Everything about the numbers
// is done on their bits: devices may take denormal floats for zero, and round halves as they like.
#include "shared/pack.h"
layout(push_constant, scalar) uniform Push { PackPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int FORM = PACK_NOTHING;
layout(constant_id = 1) const int COMPONENTS = 4;
layout(constant_id = 2) const int LOOK = 0;        // count pixels that are not finite
layout(constant_id = 3) const int BACKGROUND = 0;  // of depth: what is beyond 1e10 is 1e10, and infinity is no error
layout(constant_id = 4) const int COVER = 0;       // tell whether any alpha is not 0

const uint infinity = 0x7f800000u;
const uint background_depth_m = 0x501502f9u;  // 1e10

// Nearest half, to even on a tie. original: the bits before the scale, whose sign and kind of no number stay; a product
// is a quiet one.
uint half_of(uint original, float value, uint quiet, inout uint clamped) {
  const uint sign = (original >> 16) & 0x8000u;
  const uint whole = original & 0x7fffffffu;
  if (whole > infinity) {
    const uint kind = (whole >> 13) & 0x3ffu;
    return sign | 0x7c00u | max(kind | quiet, 1u);
  }
  const uint bits = floatBitsToUint(value) & 0x7fffffffu;
  if (bits >= infinity) return sign | 0x7c00u;
  if (bits > 0x477fe000u) {  // 65504
    ++clamped;
    return sign | 0x7bffu;
  }
  // Below the least normal half steps are 2^-24 apart.
  if (bits < 0x38800000u) return sign | uint(roundEven(abs(value) * 16777216.0));
  return sign | ((bits - 0x38000000u + 0xfffu + ((bits >> 13) & 1u)) >> 13);
}

uvec4 bits_at(uvec2 p) { return floatBitsToUint(texelFetch(pass_images[pc.source], ivec2(pc.corner_px + p), 0)); }

void look(uvec2 p, uvec4 bits) {
  if (LOOK != 0) {
    bool bad = false;
    for (int c = 0; c < COMPONENTS; ++c) {
      const uint whole = bits[c] & 0x7fffffffu;
      bad = bad || (BACKGROUND != 0 ? whole > infinity : whole >= infinity);
    }
    if (bad) {
      atomicAdd(PackCountsRef(pc.counts).l[pc.layer].nonfinite, 1u);
      atomicMax(PackCountsRef(pc.counts).l[pc.layer].first_from_end, ~(p.y * pc.size_px.x + p.x));
    }
  }
  if (COVER != 0 && bits.a != 0u && PackCountsRef(pc.counts).l[pc.layer].covered == 0u)
    atomicOr(PackCountsRef(pc.counts).l[pc.layer].covered, 1u);
}

void planes_of_halves(uvec2 p) {
  uvec4 words = uvec4(0u);
  uint clamped = 0u;
  for (uint i = 0u; i < 2u; ++i) {
    const uvec2 at = uvec2(p.x + i, p.y);
    if (at.x >= pc.size_px.x) continue;
    const uvec4 bits = bits_at(at);
    look(at, bits);
    precise const vec4 values = uintBitsToFloat(bits) * vec4(vec3(pc.scale), 1.0);
    for (int c = 0; c < COMPONENTS; ++c) 
      words[c] |= half_of(bits[c], values[c], c < 3 ? 0x200u : 0u, clamped) << (16u * i);
  }
  for (int c = 0; c < COMPONENTS; ++c)
    PackWordsRef(pc.target).w[uint(c) * pc.plane_words + p.y * pc.row_words + p.x / 2u] = words[c];
  if (clamped != 0u) atomicAdd(PackCountsRef(pc.counts).l[pc.layer].clamped, clamped);
}

// Bits as they are: what carries a scale is scaled by the host.
void planes_of_floats(uvec2 p) {
  uvec4 bits = bits_at(p);
  look(p, bits);
  if (BACKGROUND != 0 && bits.x > background_depth_m && bits.x <= infinity) bits.x = background_depth_m;
  for (int c = 0; c < COMPONENTS; ++c)
    PackWordsRef(pc.target).w[uint(c) * pc.plane_words + p.y * pc.row_words + p.x] = bits[c];
}

vec4 color_at(uvec2 p) {
  return p.x < pc.size_px.x ? texelFetch(pass_images[pc.source], ivec2(pc.corner_px + p), 0) : vec4(0.0);
}

void bytes(uvec2 p) {
  uint c[4];
  for (uint i = 0u; i < 4u; ++i) c[i] = packUnorm4x8(vec4(color_at(uvec2(p.x + i, p.y)).rgb, 0.0));
  const uint at = p.y * pc.row_words + p.x / 4u * 3u;
  PackWordsRef(pc.target).w[at] = c[0] | c[1] << 24;
  PackWordsRef(pc.target).w[at + 1u] = c[1] >> 8 | c[2] << 16;
  PackWordsRef(pc.target).w[at + 2u] = c[2] >> 16 | c[3] << 8;
}

void shorts(uvec2 p) {
  const vec3 a = color_at(p).rgb, b = color_at(uvec2(p.x + 1u, p.y)).rgb;
  const uint at = p.y * pc.row_words + p.x / 2u * 3u;
  PackWordsRef(pc.target).w[at] = packUnorm2x16(a.rg);
  PackWordsRef(pc.target).w[at + 1u] = packUnorm2x16(vec2(a.b, b.r));
  PackWordsRef(pc.target).w[at + 2u] = packUnorm2x16(b.gb);
}

void main() {
  const uint step = FORM == PACK_RGB8 ? 4u : FORM == PACK_HALF || FORM == PACK_RGB16 ? 2u : 1u;
  const uvec2 p = uvec2(gl_GlobalInvocationID.x * step, gl_GlobalInvocationID.y);
  if (any(greaterThanEqual(p, pc.size_px))) return;
  if (FORM == PACK_HALF) planes_of_halves(p);
  if (FORM == PACK_FLOAT) planes_of_floats(p);
  if (FORM == PACK_RGB8) bytes(p);
  if (FORM == PACK_RGB16) shorts(p);
  if (FORM == PACK_NOTHING) look(p, bits_at(p));
}
