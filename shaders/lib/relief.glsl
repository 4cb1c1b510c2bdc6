#pragma once
// Reliefs (CANDELA_relief, docs/understanding/relief.md): below a triangle the surface lies where a height texture
// says, as a depth between the triangle's plane and a floor. A ray goes through that layer in even steps and then
// halves the step in which it met the surface (Policarpo, Oliveira, Comba, "Real-Time Relief Mapping on Arbitrary
// Polygonal Surfaces", 2005), or from texel to texel, where the bilinear height is a quadratic along the ray. Heights
// are sampled at one mip level, that of the flat surface: no level jumps where the surface steps. Needs
// lib/bindless.glsl and shared/scene.h.
layout(constant_id = 34) const int RELIEF_SEARCH = 0;
const int RELIEF_STEPS = RELIEF_SEARCH & 0x7ff, RELIEF_REFINEMENTS = RELIEF_SEARCH >> 22 & 0x1f;
const int RELIEF_LIGHT_STEPS = (RELIEF_SEARCH >> 11 & 0x7ff) - 1;  // lib/relief_light.glsl; below 0: none
const bool RELIEF_OF_SAMPLES = (RELIEF_SEARCH >> 27 & 1) != 0;  // each sample has its own depth and outline
const int RELIEF_MOST_TEXELS = 16384;  // of a ray
const float RELIEF_FARTHEST = 256.0;   // of triangles, along a relief without end

// A triangle's layer, in any space: corner + weights.x * e1 + weights.y * e2 + depth * below.
struct Relief {
  vec3 corner, e1, e2, below;
  vec2 uv, uv1, uv2;  // of the first corner, and what the edges add; not transformed
  vec2 least, most;   // where it ends
  bool ends;
  uint heights, sampler_index;
  uint wraps;  // of u, and of v above
  vec3 u_row, v_row;  // of the heights' transform
};
// A place in the layer: weights of the second and third corner, and depth.
struct ReliefMet {
  bool met;
  vec3 at;
};
const ReliefMet RELIEF_MISSED = ReliefMet(false, vec3(0.0));

// relief: of a material.
ReliefRecord relief_record(uint relief) {
  return ReliefRecordRef(frame.materials + 360ul * uint64_t(relief)).r;
}
void take_heights(ReliefRecord record, inout Relief r) {
  r.heights = record.heights.texture;
  r.sampler_index = record.heights.sampler_index;
  r.wraps = record.heights.wraps;
  r.u_row = record.heights.u_row;
  r.v_row = record.heights.v_row;
}

vec3 relief_place(Relief r, vec3 at) { return r.corner + at.x * r.e1 + at.y * r.e2 + at.z * r.below; }
vec2 relief_texture_uv(Relief r, vec2 weights) {
  const vec3 uv = vec3(r.uv + weights.x * r.uv1 + weights.y * r.uv2, 1.0);
  return vec2(dot(r.u_row, uv), dot(r.v_row, uv));
}
vec2 relief_size(Relief r) { return vec2(textureSize(textures[nonuniformEXT(r.heights)], 0)); }
#define RELIEF_TEXTURE(r) \
  nonuniformEXT(sampler2D(textures[nonuniformEXT((r).heights)], samplers[nonuniformEXT((r).sampler_index)]))

// Beyond the image as its sampler says (glTF's wrap modes).
float relief_wrapped(float texel, float size, uint wrap) {
  if (wrap == wrap_clamp) return clamp(texel, 0.0, size - 1.0);
  const float period = wrap == wrap_mirror ? 2.0 * size : size;
  // From the texel's middle: a quotient that is off by a last place must not fall below a whole number.
  const float i = clamp(texel - period * floor((texel + 0.5) / period), 0.0, period - 1.0);
  return i < size ? i : 2.0 * size - 1.0 - i;
}
// The four texels about a corner of texels, from the first one's number on: it, to its right, below it, below that. By
// fetches: filters of a device weigh in 1/256, and on llvmpipe 25.0.7 textureGather gave others here.
vec4 relief_cell(Relief r, vec2 low, vec2 size) {
  const uint u = r.wraps & 3u, v = r.wraps >> 2u;
  const ivec2 x = ivec2(relief_wrapped(low.x, size.x, u), relief_wrapped(low.x + 1.0, size.x, u));
  const ivec2 y = ivec2(relief_wrapped(low.y, size.y, v), relief_wrapped(low.y + 1.0, size.y, v));
  return vec4(texelFetch(textures[nonuniformEXT(r.heights)], ivec2(x.x, y.x), 0).r,
      texelFetch(textures[nonuniformEXT(r.heights)], ivec2(x.y, y.x), 0).r,
      texelFetch(textures[nonuniformEXT(r.heights)], ivec2(x.x, y.y), 0).r,
      texelFetch(textures[nonuniformEXT(r.heights)], ivec2(x.y, y.y), 0).r);
}
float relief_in_cell(vec4 cell, vec2 f) { return mix(mix(cell.x, cell.y, f.x), mix(cell.z, cell.w, f.x), f.y); }
float relief_height_at(Relief r, vec2 texel, vec2 size) {
  const vec2 low = floor(texel);
  return relief_in_cell(relief_cell(r, low, size), texel - low);
}

float relief_height(Relief r, vec2 weights) {
  const vec2 size = relief_size(r);
  return relief_height_at(r, relief_texture_uv(r, weights) * size - 0.5, size);
}

// Texel by texel. Places are those of relief_between; returned: the fraction of the way, or below 0.
float relief_by_texels(Relief r, vec3 from, vec3 to, bool above, bool to_floor) {
  const vec2 size = relief_size(r);
  const vec2 start = relief_texture_uv(r, from.xy) * size - 0.5;
  const vec2 way = relief_texture_uv(r, to.xy) * size - 0.5 - start;
  const float sinks = to.z - from.z;
  vec2 low = floor(start);
  for (int a = 0; a < 2; ++a)
    if (way[a] < 0.0 && low[a] == start[a]) low[a] -= 1.0;
  float t = 0.0;
  for (int i = 0; i < RELIEF_MOST_TEXELS; ++i) {
    vec2 next = vec2(2.0);
    for (int a = 0; a < 2; ++a)
      if (way[a] != 0.0) next[a] = (low[a] + (way[a] > 0.0 ? 1.0 : 0.0) - start[a]) / way[a];
    const float end = min(min(next.x, next.y), 1.0), length = end - t;
    if (length > 0.0) {
      const vec4 cell = relief_cell(r, low, size);
      const vec2 f = start + t * way - low;
      const float twist = cell.x - cell.y - cell.z + cell.w, hx = cell.y - cell.x, hy = cell.z - cell.x;
      const float a = from.z + t * sinks - (cell.x + hx * f.x + hy * f.y + twist * f.x * f.y);
      const float b = sinks - (hx * way.x + hy * way.y + twist * (f.x * way.y + f.y * way.x));
      const float c = -twist * way.x * way.y;
      // Depth less height is a + b s + c s^2 from here on: between its roots and the ends it keeps its sign.
      float cuts[4] = float[4](0.0, length, length, length);
      const float under = b * b - 4.0 * a * c;
      if (under >= 0.0) {
        const float q = -0.5 * (b + (b < 0.0 ? -sqrt(under) : sqrt(under)));
        const float r0 = c != 0.0 ? q / c : 2.0, r1 = q != 0.0 ? a / q : 2.0;
        cuts[1] = clamp(min(r0, r1), 0.0, length);
        cuts[2] = clamp(max(r0, r1), 0.0, length);
      }
      for (int k = 0; k < 3; ++k) {
        if (!(cuts[k + 1] > cuts[k])) continue;
        const float s = 0.5 * (cuts[k] + cuts[k + 1]);
        const bool below = a + s * (b + s * c) > 0.0;
        if (below && above) return t + cuts[k];
        if (!below) above = true;
      }
    }
    if (end >= 1.0) break;
    t = max(t, end);
    if (next.x <= next.y) low.x += way.x > 0.0 ? 1.0 : -1.0;
    if (next.y <= next.x) low.y += way.y > 0.0 ? 1.0 : -1.0;
  }
  return above && to_floor ? 1.0 : -1.0;
}

float relief_by_steps(Relief r, vec3 from, vec3 to, bool above, bool to_floor, float lod, int steps, int refinements) {
  const vec2 start = relief_texture_uv(r, from.xy), way = relief_texture_uv(r, to.xy) - start;
  const float sinks = to.z - from.z;
  float low = 0.0, high = -1.0;
  for (int i = above ? 1 : 0; i <= steps; ++i) {
    const float t = float(i) / float(steps);
    const bool below = from.z + t * sinks >= textureLod(RELIEF_TEXTURE(r), start + t * way, lod).r;
    if (below && above) {
      high = t;
      break;
    }
    if (!below) {
      above = true;
      low = t;
    }
  }
  if (high < 0.0) return above && to_floor ? 1.0 : -1.0;
  for (int i = 0; i < refinements; ++i) {
    const float t = 0.5 * (low + high);
    const bool below = from.z + t * sinks >= textureLod(RELIEF_TEXTURE(r), start + t * way, lod).r;
    low = below ? low : t;
    high = below ? t : high;
  }
  return high;
}

// The first place on the way between two at which it goes from above the surface to below. above: it begins there;
// else it has to come out first. steps, refinements: 0 steps: from texel to texel.
ReliefMet relief_between(Relief r, vec3 from, vec3 to, bool above, float lod, int steps, int refinements) {
  bool to_floor = to.z >= 1.0;
  if (r.ends) {
    const vec2 at = r.uv + from.x * r.uv1 + from.y * r.uv2;
    const vec2 way = r.uv + to.x * r.uv1 + to.y * r.uv2 - at;
    const vec2 slack = 1e-6 * (1.0 + abs(r.least) + abs(r.most));
    float first = 0.0, last = 1.0;
    for (int a = 0; a < 2; ++a) {
      const float low = r.least[a] - slack[a] - at[a], high = r.most[a] + slack[a] - at[a];
      if (abs(way[a]) < 1e-30) {
        if (!(low <= 0.0 && high >= 0.0)) return RELIEF_MISSED;
        continue;
      }
      first = max(first, min(low / way[a], high / way[a]));
      last = min(last, max(low / way[a], high / way[a]));
    }
    if (!(first <= last)) return RELIEF_MISSED;
    above = above || first > 0.0;
    to_floor = to_floor && last >= 1.0;
    const vec3 begin = from;
    from = mix(begin, to, first);
    to = mix(begin, to, last);
  }
  const float t = steps == 0 ? relief_by_texels(r, from, to, above, to_floor)
      : relief_by_steps(r, from, to, above, to_floor, lod, steps, refinements);
  if (t < 0.0) return RELIEF_MISSED;
  return ReliefMet(true, mix(from, to, t));
}
ReliefMet relief_between(Relief r, vec3 from, vec3 to, bool above, float lod) {
  return relief_between(r, from, to, above, lod, RELIEF_STEPS, RELIEF_REFINEMENTS);
}

// Rows of the matrix that gives a step's weights and depth; false: the layer has no inside.
bool relief_rows(Relief r, out vec3 row[3]) {
  const vec3 across = cross(r.e1, r.e2);
  const float volume = dot(across, r.below), inverse = 1.0 / volume;
  row[0] = cross(r.e2, r.below) * inverse;
  row[1] = cross(r.below, r.e1) * inverse;
  row[2] = across * inverse;
  return abs(volume) > 0.0 && !isinf(inverse);
}

// A ray that meets the triangle's plane at `entry` (weights) from the front, or from behind, where it meets the floor.
// as far as t, from the plane; back: it comes from behind.
ReliefMet relief_through(Relief r, vec2 entry, vec3 direction, float lod, out bool back) {
  vec3 row[3];
  back = false;
  if (!relief_rows(r, row)) return ReliefMet(true, vec3(entry, 0.0));
  const vec3 by = vec3(dot(row[0], direction), dot(row[1], direction), dot(row[2], direction));
  const vec2 slant = by.xy / by.z;
  if (by.z > 0.0 && !any(isinf(slant)))
    return relief_between(r, vec3(entry, 0.0), vec3(entry + slant, 1.0), true, lod);
  back = true;
  return ReliefMet(true, vec3(entry, 0.0) + (any(isinf(slant)) || by.z == 0.0 ? vec3(0.0) : vec3(slant, 1.0)));
}

// How the height grows with each of the weights. smooth_over: by places so many texels on either side; 0: of the cell.
vec2 relief_slope(Relief r, vec2 weights, float smooth_over, float lod) {
  const vec2 size = relief_size(r), origin = relief_texture_uv(r, vec2(0.0));
  const vec2 at = relief_texture_uv(r, weights) * size - 0.5;
  vec2 by_texel;
  if (smooth_over > 1.0 && RELIEF_STEPS != 0) {
    const vec2 uv = (at + 0.5) / size, off = smooth_over / size;
    by_texel = vec2(textureLod(RELIEF_TEXTURE(r), uv + vec2(off.x, 0.0), lod).r -
            textureLod(RELIEF_TEXTURE(r), uv - vec2(off.x, 0.0), lod).r,
        textureLod(RELIEF_TEXTURE(r), uv + vec2(0.0, off.y), lod).r -
            textureLod(RELIEF_TEXTURE(r), uv - vec2(0.0, off.y), lod).r) / (2.0 * smooth_over);
  } else if (smooth_over > 0.0) {
    by_texel = 0.5 * vec2(relief_height_at(r, at + vec2(1.0, 0.0), size) -
            relief_height_at(r, at - vec2(1.0, 0.0), size),
        relief_height_at(r, at + vec2(0.0, 1.0), size) - relief_height_at(r, at - vec2(0.0, 1.0), size));
  } else {
    const vec2 low = floor(at), f = at - low;
    const vec4 cell = relief_cell(r, low, size);
    by_texel = vec2(mix(cell.y - cell.x, cell.w - cell.z, f.y), mix(cell.z - cell.x, cell.w - cell.y, f.x));
  }
  return vec2(dot(by_texel, (relief_texture_uv(r, vec2(1.0, 0.0)) - origin) * size),
      dot(by_texel, (relief_texture_uv(r, vec2(0.0, 1.0)) - origin) * size));
}

// What leans a unit normal of the front over.
vec3 relief_lean(Relief r, vec2 slope) {
  const vec3 across = cross(r.e1, r.e2);
  const float area = length(across);
  if (!(area > 0.0)) return vec3(0.0);
  const vec3 lean = (slope.y * cross(r.e1, r.below) + slope.x * cross(r.below, r.e2)) / area;
  return dot(across, r.below) > 0.0 ? -lean : lean;
}

// The mip level of heights at which a pixel's shorter side is a texel; across, down: of the weights.
float relief_level(Relief r, vec3 across, vec3 down) {
  if (RELIEF_STEPS == 0) return 0.0;
  const vec2 size = relief_size(r), origin = relief_texture_uv(r, vec2(0.0));
  const vec2 a = (relief_texture_uv(r, across.yz) - origin) * size, b = (relief_texture_uv(r, down.yz) - origin) * size;
  const float shorter = min(dot(a, a), dot(b, b));
  return shorter > 1.0 && shorter < 1e12 ? 0.5 * log2(shorter) : 0.0;
}
