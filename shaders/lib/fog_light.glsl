#pragma once
// Light that fog scatters once into a ray of the camera, slice by slice. In each slice the medium's part is exact: the
// integral of density and transmittance. What light arrives there is taken at one point, but for two things: the maps
// of suns are asked at several points (fog_sun_over), and the inverse square of lamps is its mean over the slice, which
// has a closed form (the integral of 1/d2 along a line is an angle over the line's distance from the lamp); the point
// is the one in the middle of that angle (Kulla and Fajardo, "Importance Sampling Techniques for Path Tracing in
// Participating Media", 2012). So a lamp's glow is right in slices far thicker than it. Where a slice is opaque the
// mean is over as much of it as is seen.
//
// Needs lib/frame.glsl, lib/fog_ray.glsl, and pc.lights, pc.light_cells, pc.light_entries, pc.light_tiles. With FOG_SUN
// (points of a slice at which a sun's maps are asked; with FOG_JITTER one) pc.suns and pc.sun_maps as well, with
// FOG_LAMP_SHADOWS (points of a slice, at least, at which a lamp's maps are asked) pc.lamps and pc.lamp_maps.
#include "lib/light_cells.glsl"
#include "lib/light_data.glsl"
#include "lib/light_list.glsl"
#ifdef FOG_SUN
#include "lib/sun_cascades.glsl"
#endif
#ifdef FOG_AMBIENT
#include "lib/ambient_sh.glsl"
#endif
#ifdef FOG_LAMP_SHADOWS
#include "lib/fog_lamp_shadow.glsl"
#endif
#ifdef FOG_DEEP_SHADOWS
#include "lib/deep_light.glsl"
#endif

// Slices that one walk through the lists serves: a light's words are loaded once for all of them.
#ifndef FOG_RUN
#define FOG_RUN 4
#endif
// Where a lamp sees a slice under more than this angle, it is taken at several points: near lamps a slice crosses cones
// and phases. Fewer would do for most of the air, and more cost little, for few lamps are as near to a ray.
const float FOG_ANGLE = 0.25;
const int FOG_POINTS = 6;
// A run can lie in several slices of the lights' grid; in more than these it walks every light.
#ifndef FOG_CELLS
#define FOG_CELLS 8u
#endif
// Where in a slice light is taken: in the middle, or, with FOG_JITTER, where fog_jitter says, which the shader sets.
#ifdef FOG_JITTER
float fog_jitter[FOG_RUN];
#define FOG_PLACE(j) fog_jitter[j]
#else
#define FOG_PLACE(j) 0.5
#endif
// A ray stands for its neighbourhood, so a lamp's glow is blurred across rays: by this much of the distance between
// neighbouring rays (standard deviation in each direction). Less leaves single pixels a thousand times too bright on a
// street of 1,024 lamps, more dulls the glow.
const float FOG_SPREAD = 1.5;

#if defined(FOG_SUN) && !defined(FOG_JITTER)
// A point of a slice at which the maps of a sun are asked: across, in distances between rays, and along. The edge of a
// shadow that runs along rays goes through few slices and many rays: asked at one point of each slice, haze behind
// roofs at low sun ends in blotches the size of the grid's cells. A net in base 2 of three dimensions, centred
// (Niederreiter, "Point Sets and Sequences with Small Discrepancy", 1987): each nth part of a slice each way has one of
// n points, n a power of two. Four, the usual number, are another such set.
vec3 fog_sun_point(uint i) {
  if (FOG_SUN == 4) {
    const vec2 fourths[4] = vec2[](vec2(-0.125, -0.375), vec2(0.125, 0.375), vec2(0.375, -0.125), vec2(-0.375, 0.125));
    return vec3(fourths[i & 3u], 0.25 * float(i) + 0.125);
  }
  uint x = 0u;
  for (uint bits = i, column = 0x80000000u; bits != 0u; bits >>= 1, column ^= column >> 1)
    if ((bits & 1u) != 0u) x ^= column;
  const vec2 across = vec2(uvec2(x, bitfieldReverse(i)) >> 8) * (1.0 / 16777216.0);
  return vec3(across - 0.5, float(i) / float(FOG_SUN)) + 0.5 / float(FOG_SUN);
}
#endif

// Integral of a lamp's inverse square over a stretch of a ray, from a to b metres beyond where the ray passes the lamp
// at distance h, blurred by s < h across the ray: 1/(t^2 + h^2) + 2 s^2/(t^2 + h^2)^2, where h^2 holds s^2. The first
// term alone would lose 2 pi^2 s of each lamp's light across the rays; the second has just that, within a few s.
float blurred_inverse_square(float a, float wide, float h, float h2, float s2) {
  const float b = a + wide, angle = atan(wide * h, h2 + a * b), fraction = s2 / h2;
  if (fraction < 1e-6) return angle / h;
  return angle / h * (1.0 + fraction) + fraction * (wide / (h2 + a * a)) * ((h2 - a * b) / (h2 + b * b));
}

#ifdef FOG_STEEP
// Of each slice's light the part of lamps so near that it does not grow evenly over the slice, the largest channel.
float fog_steep[FOG_RUN];
#endif

struct FogWalk {
  uint light;
  uint first, stride, cells;  // the cells that the ray passes, one behind the other; 0: every light
  uint cursor[FOG_CELLS], end[FOG_CELLS], mine[FOG_CELLS];  // compact: as in LightWalk, of each cell
  uint word, bits;                                          // bitmask
  uint global;
};

// Lights of the cells that the ray passes between two distances, in ascending order, all lanes together, with a cap
// each lane its own.
FogWalk begin_fog_lights(FogRay ray, float begin_m, float end_m) {
  FogWalk w;
  w.light = no_light;
  w.word = w.bits = w.global = 0u;
  w.first = w.stride = w.cells = 0u;
  for (uint c = 0u; c < FOG_CELLS; ++c) {
    w.cursor[c] = w.end[c] = 0u;
    w.mine[c] = no_light;
  }
  uvec2 tile;
  const vec3 a = view_position(ray.origin + ray.direction * begin_m);
  const vec3 b = view_position(ray.origin + ray.direction * end_m);
  if (frame.grid.mode != light_mode_all && light_tile(b, tile)) {
    if (frame.grid.tiled != 0u) {
      const uvec2 column = tile / column_tiles;
      w.first = frame.grid.tiles.x * frame.grid.tiles.y + column.x + frame.grid.columns.x * column.y;
      w.cells = 1u;
    } else {
      const uint first = light_slice(a.z), last = light_slice(b.z);
      if (last - first < FOG_CELLS) {
        w.stride = frame.grid.tiles.x * frame.grid.tiles.y;
        w.first = tile.x + frame.grid.tiles.x * tile.y + w.stride * first;
        w.cells = last - first + 1u;
      }
    }
  }
  if (frame.grid.mode == light_mode_bitmask) return w;
  if (w.cells == 0u) {
    w.end[0] = frame.light_count;
    w.mine[0] = 0u < w.end[0] ? 0u : no_light;
  }
  for (uint c = 0u; c < FOG_CELLS; ++c) {
    if (c >= w.cells) continue;
    const uint cell = w.first + c * w.stride;
    w.cursor[c] = ConstUintsRef(pc.light_cells).u[cell];
    w.end[c] = ConstUintsRef(pc.light_cells).u[cell + 1u];
    if (frame.grid.cap != 0u) w.end[c] = min(w.end[c], w.cursor[c] + frame.grid.cap);
    if (w.cursor[c] < w.end[c]) w.mine[c] = ConstUintsRef(pc.light_entries).u[w.cursor[c]];
  }
  return w;
}

uint fog_global(uint place) {
  return ConstUintsRef(frame.grid.globals).u[min(place, max(frame.grid.global_count, 1u) - 1u)];
}

bool next_fog_light(inout FogWalk w) {
  if (frame.grid.mode == light_mode_bitmask) {
    while (w.bits == 0u) {
      if (w.word == frame.grid.words) return false;
      uint bits = w.cells == 0u ? 0xffffffffu : 0u;
      for (uint c = 0u; c < w.cells; ++c)
        bits |= ConstUintsRef(pc.light_cells).u[(w.first + c * w.stride) * frame.grid.words + w.word];
      w.bits = subgroupOr(bits);
      if (frame.grid.global_count != 0u) w.bits |= fog_global(w.word);
      const uint left = frame.light_count - 32u * w.word;
      if (left < 32u) w.bits &= (1u << left) - 1u;
      ++w.word;
    }
    w.light = 32u * (w.word - 1u) + uint(max(findLSB(w.bits), 0));  // as in next_light
    w.bits &= w.bits - 1u;
    return true;
  }
  uint global = no_light;
  if (w.global < frame.grid.global_count) global = fog_global(w.global);
  uint mine = w.mine[0];
  for (uint c = 1u; c < FOG_CELLS; ++c) mine = min(mine, w.mine[c]);
  w.light = min(frame.grid.cap != 0u ? mine : subgroupMin(mine), global);  // as in next_light
  if (w.light == no_light) return false;
  if (w.light == global) ++w.global;
  for (uint c = 0u; c < FOG_CELLS; ++c) {
    if (w.mine[c] != w.light) continue;
    ++w.cursor[c];
    w.mine[c] = no_light;
    if (w.cursor[c] < w.end[c])
      w.mine[c] = w.cells == 0u ? w.cursor[c] : ConstUintsRef(pc.light_entries).u[w.cursor[c]];
  }
  return true;
}

#ifdef FOG_SUN
// Of a point in the air: no surface has to be cleared, and what lies between slices is smoothed by the grid.
vec3 fog_sun_visibility(LightRef light, vec3 position) {
  const uint named = floatBitsToUint(light_word(light, 6u).y);
  if (named == 0u) return vec3(1.0);
  // Valid in all lanes, also those of lamps: light_visibility in lib/light_shadow.glsl.
  const uint sun = (named & lamp_shadow_bit) != 0u ? 0u : max(named, 1u) - 1u;
  const CascadePlace place = find_cascade(sun, position);
  if (place.number == max_sun_cascades) return vec3(1.0);
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  const vec2 across = vec2(dot(suns.s[sun].right, position), dot(suns.s[sun].up, position)) - place.cascade.centre_m;
  const float depth = dot(suns.s[sun].depth, vec4(position, 1.0)) + suns.s[sun].bias;
  const vec2 uv = vec2(0.5) + vec2(across.x, -across.y) * (0.5 / place.cascade.half_m);
  vec3 left = vec3(textureGrad(
      sampler2DArrayShadow(pass_array_images[pc.sun_maps], graph_shadow_samplers[SAMPLER_SHADOW_LINEAR]),
      vec4(uv, float(suns.s[sun].first_layer + place.number), depth), vec2(0.0), vec2(0.0)));
#if defined(FOG_DEEP_SHADOWS) && (FOG_DEEP_SHADOWS & 1) != 0
  if (left.x > 0.0) left *= deep_sun(sun, position, vec3(0.0), 0.0);
#endif
  return left;
}
#endif

// A slice of a ray as the camera sees it.
struct FogSlice {
  float begin_m, wide_m;  // what of it is seen, evenly
#ifdef FOG_MEDIA
  vec3 scattering[FOG_MEDIA];  // of each medium, times its metres, each by its transmittance to the camera
#else
  vec3 metres;            // of medium, each by its transmittance to the camera
#endif
};
#ifdef FOG_MEDIA
// Of light that comes under this angle, what the slice turns towards the camera.
vec3 fog_phase(FogSlice slice, float cosine) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < FOG_MEDIA; ++i)
    sum += slice.scattering[i] * henyey_greenstein(cosine, frame.fog.media[i].anisotropy);
  return sum;
}
vec3 fog_metres(FogSlice slice) { return vec3(1.0); }  // fog_phase has them
#else
float fog_phase(FogSlice slice, float cosine) { return henyey_greenstein(cosine); }
vec3 fog_metres(FogSlice slice) { return slice.metres; }
#endif

#ifdef FOG_SUN
// Of a sun's light, the mean over a slice. at: where the slice's light is taken.
vec3 fog_sun_over(LightRef light, FogRay ray, FogSlice slice, vec3 at, float cell) {
#ifdef FOG_JITTER
  return fog_sun_visibility(light, at);
#else
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < uint(FOG_SUN); ++i) {
    const vec3 place = fog_sun_point(i);
    const float along_m = slice.begin_m + place.z * slice.wide_m;
    const float wide_m = cell * (frame.perspective != 0u ? along_m / ray.along : 1.0);
    const vec3 across = place.x * frame.camera_right + place.y * frame.camera_up;
    sum += fog_sun_visibility(light, ray.origin + ray.direction * along_m + wide_m * across);
  }
  return sum / float(FOG_SUN);
#endif
}
#endif

// Of a lamp's intensity, what fog scatters into the ray at a point `y` beyond where the ray passes it, but for the
// inverse square. Exactly 0 outside range and cone. maps: fog_lamp_maps().
vec3 fog_lamp(FogSlice slice, uint maps, uint type, FogRay ray, float nearest, vec3 off, float y, vec3 shines,
              vec2 cone, float inverse_range2) {
  const float d2 = dot(off, off) + y * y, x2 = d2 * inverse_range2;
  if (x2 >= 1.0) return vec3(0.0);
  const vec3 towards = off - ray.direction * y;
  const float d = sqrt(d2);
  const vec3 l = d > 0.0 ? towards / d : vec3(0.0, 1.0, 0.0);
  float factor = max(1.0 - x2 * x2, 0.0);
  if (type == light_stand_in) {  // as in light_arriving()
    const float y2 = d2 * cone.x * cone.x;
    factor = min(y2 * y2, 1.0) - x2 * x2;
  }
  if (type == light_spot) {
    const vec3 e = l + shines;
    const float c = clamp(cone.y - dot(e, e) * cone.x, 0.0, 1.0);
    factor *= c * c;
  }
  if (factor == 0.0) return vec3(0.0);
  const vec3 at = ray.origin + ray.direction * (nearest + y);
#ifdef FOG_LAMP_SHADOWS
  factor *= fog_lamp_visibility(maps, at);
  if (factor == 0.0) return vec3(0.0);
#endif
#if defined(FOG_DEEP_SHADOWS) && (FOG_DEEP_SHADOWS & 2) != 0
  vec3 left = vec3(factor);
  if (maps != no_light) left *= deep_lamp(maps, at, vec3(0.0), 0.0);
  return left * fog_phase(slice, dot(l, ray.direction)) * fog_through(at, l, d);
#endif
  return factor * fog_phase(slice, dot(l, ray.direction)) * fog_through(at, l, d);
}

// The light of the slices between neighbouring distances, unexposed, as it arrives at the camera. cell: distance
// between neighbouring rays for a metre of depth, or in metres (orthographic).
void fog_run(FogRay ray, float node_m[FOG_RUN + 1], float cell, out vec3 gained[FOG_RUN]) {
  const vec2 inside = fog_inside(ray.origin, ray.direction, vec2(0.0, FOG_FAR));
  FogSlice slices[FOG_RUN];
#ifdef FOG_MEDIA
  vec3 before = fog_length(ray.origin, ray.direction, 0.0, node_m[0]);
  vec3 glow[FOG_RUN];
#else
  float before = fog_length(ray.origin, ray.direction, inside.x, clamp(node_m[0], inside.x, max(inside.x, inside.y)));
  const float mean_extinction = dot(frame.fog.extinction, vec3(1.0 / 3.0));
#endif
  for (int j = 0; j < FOG_RUN; ++j) {
    const float a = clamp(node_m[j], inside.x, max(inside.x, inside.y));
    const float b = clamp(node_m[j + 1], inside.x, max(inside.x, inside.y));
#ifdef FOG_MEDIA
    // Mixed evenly over the slice; transmittance is exact.
    vec3 depths[FOG_MEDIA];
    vec3 depth = vec3(0.0);
    for (int i = 0; i < FOG_MEDIA; ++i) {
      depths[i] = fog_length_of(i, ray.origin, ray.direction, a, b);
      depth += depths[i];
    }
    const vec3 fraction = fog_through(before) * one_minus_exp_over(depth);
    glow[j] = vec3(0.0);
    for (int i = 0; i < FOG_MEDIA; ++i) {
      slices[j].scattering[i] = frame.fog.media[i].albedo * depths[i] * fraction;
      glow[j] += frame.fog.media[i].glow * depths[i] * fraction;
    }
    before = min(before + depth, vec3(FOG_MOST_DEPTH));
    const float metres = dot(depth, vec3(1.0)), x = metres * (1.0 / 3.0);
#else
    const float metres = fog_length(ray.origin, ray.direction, a, b);
    // As wide as an even stretch whose middle is the mean place of the transmittance.
    const float x = min(mean_extinction * metres, 1e30);
#endif
    slices[j].begin_m = a;
    slices[j].wide_m = (b - a) * (x < 1e-2 ? 1.0 - x * (1.0 / 6.0) : 2.0 * (1.0 / x - 1.0 / (exp(min(x, 80.0)) - 1.0)));
    if (metres > 0.0) slices[j].wide_m = max(slices[j].wide_m, 1e-30);  // else an angle of 0 is divided by a width of 0
#ifndef FOG_MEDIA
    slices[j].metres = fog_through(before) * fog_held(metres) * frame.fog.scattering;
    before = min(before + metres, 3e38);
#endif
  }
#ifdef FOG_STEEP
  for (int j = 0; j < FOG_RUN; ++j) fog_steep[j] = 0.0;
#endif
  precise vec3 sums[FOG_RUN];
#ifdef FOG_MEDIA
  for (int j = 0; j < FOG_RUN; ++j) sums[j] = glow[j];
#else
  for (int j = 0; j < FOG_RUN; ++j) sums[j] = vec3(0.0);
#endif
  for (FogWalk walk = begin_fog_lights(ray, node_m[0], node_m[FOG_RUN]); next_fog_light(walk);) {
    LightRef light = light_at(pc.lights, walk.light);
    const vec2 z_type = light_word(light, 3u);
    const uint type = floatBitsToUint(z_type.y);
    const vec3 shines = vec3(light_word(light, 2u), z_type.x);
    const vec3 intensity = light_intensity(light);
    if (type == light_directional) {
      for (int j = 0; j < FOG_RUN; ++j) {
        const vec3 at = ray.origin + ray.direction * (slices[j].begin_m + FOG_PLACE(j) * slices[j].wide_m);
        vec3 arriving =
            intensity * fog_phase(slices[j], -dot(shines, ray.direction)) * fog_through(at, -shines, FOG_FAR);
#ifdef FOG_SUN
        arriving *= fog_sun_over(light, ray, slices[j], at, cell);
#endif
        sums[j] += fog_metres(slices[j]) * arriving;
      }
      continue;
    }
    const vec2 xy = light_word(light, 0u), z_range = light_word(light, 1u);
    const vec3 to_light = vec3(xy, z_range.x) - ray.origin;
    const float nearest = dot(to_light, ray.direction);  // where the ray passes the lamp
    const vec3 off = to_light - ray.direction * nearest;
    const float off2 = dot(off, off), inverse_range2 = z_range.y * z_range.y;
    if (!(off2 * inverse_range2 < 1.0) || !(off2 < 3.0e36)) continue;
    const float spread = FOG_SPREAD * cell * (frame.perspective != 0u ? max(nearest / ray.along, 0.0) : 1.0);
    const float spread2 = spread * spread;
    const float h2 = max(off2 + spread2, frame.least_light_distance2), h = sqrt(h2);
    const vec2 cone = light_word(light, 4u);
    uint maps = no_light;
    int least_points = 1;
#ifdef FOG_LAMP_SHADOWS
    maps = fog_lamp_maps(light);
    if (maps != no_light) least_points = FOG_LAMP_SHADOWS;
#endif
    for (int j = 0; j < FOG_RUN; ++j) {
      const float wide = slices[j].wide_m, a = slices[j].begin_m - nearest, b = a + wide;
      if (!(wide > 0.0)) continue;
      const float angle = atan(wide * h, h2 + a * b), mean = blurred_inverse_square(a, wide, h, h2, spread2) / wide;
      const int points = max(angle > FOG_ANGLE ? FOG_POINTS : 1, least_points);
      vec3 arriving = vec3(0.0);
      for (int i = 0; i < points; ++i) {
        float y;
#ifndef FOG_JITTER
        if (points == 1) {
          const float to_a = sqrt(h2 + a * a), to_b = sqrt(h2 + b * b);
          y = (a * to_b + b * to_a) / (to_a + to_b);  // in the middle of the angle
        } else
#endif
          y = clamp(h * tan(atan(a / h) + angle * (float(i) + FOG_PLACE(j)) / float(points)), a, b);
        arriving += fog_lamp(slices[j], maps, type, ray, nearest, off, y, shines, cone, inverse_range2);
      }
      if (arriving == vec3(0.0)) continue;
      const vec3 gain = fog_metres(slices[j]) * intensity * (arriving * (mean / float(points)));
      sums[j] += gain;
#ifdef FOG_STEEP
      if (angle > FOG_ANGLE) fog_steep[j] += max(gain.r, max(gain.g, gain.b));
#endif
    }
  }
#ifdef FOG_AMBIENT
  // A harmonic of degree n keeps g^n of itself.
#ifdef FOG_MEDIA
  for (int i = 0; i < FOG_MEDIA; ++i) {
    const float g = frame.fog.media[i].anisotropy;
    const vec3 sky = ambient_radiance(ray.direction, vec3(1.0, 1.5 * g, 4.0 * g * g));
    for (int j = 0; j < FOG_RUN; ++j) {
      const vec3 at = ray.origin + ray.direction * (slices[j].begin_m + FOG_PLACE(j) * slices[j].wide_m);
      if (slices[j].scattering[i] != vec3(0.0))
        sums[j] += slices[j].scattering[i] * sky * fog_sky_through(at, ray.direction, true, g);
    }
  }
#else
  const float g = frame.fog.anisotropy;
  const vec3 sky = ambient_radiance(ray.direction, vec3(1.0, 1.5 * g, 4.0 * g * g));
  for (int j = 0; j < FOG_RUN; ++j) {
    const vec3 at = ray.origin + ray.direction * (slices[j].begin_m + FOG_PLACE(j) * slices[j].wide_m);
    if (slices[j].metres != vec3(0.0)) sums[j] += slices[j].metres * sky * fog_sky_through(at, ray.direction, true, g);
  }
#endif
#endif
  gained = sums;
}
