// How much of a point or spot light's rays come through, from its depth maps: four by four texels about the point, each
// compared by itself and weighed by a tent of 1.5 texels (Reeves, Salesin, Cook, "Rendering Antialiased Shadows with
// Depth Maps", 1987). Part of lib/light_shadow.glsl; needs pc.lamps and pc.lamp_maps. Only where HAS_LAMP_SHADOWS is 1.
//
// A texel is compared with what the plane of the point's triangle has there (Isidoro, "Shadow Mapping: GPU-based Tips
// and Techniques", 2006), exactly: over a map reversed depth is linear on a plane, and the normal gives its gradient.
// Lifting the point instead, by as much as a plane's depth differs within the lookup, lets it see past what is near:
// from points so lifted rays are open at 8 % of what faces a lamp in Sponza and lies in shadow. Three limits:
// - Where the plane leads away from the light the point's own depth counts: at the inner edge of two walls the other
//   one is not taken for something in front of this one.
// - A texel on which the plane lies some texels nearer to the light than the point sees nothing of what lies between,
//   and counts less and less.
// - Curved surfaces are not planes: the plane is moved towards the light by a fraction of a texel, and the more the
//   farther from the point a texel lies, or a facet would darken the next one along their edge.

#include "lib/axes.glsl"
#include "lib/lamp_face.glsl"

const float PLANE_LIFT_TEXELS = 0.15, MOST_LIFT_TEXELS = 2.0;  // along the normal, and along the ray
const float ROUND_LIFT_TEXELS = 0.3;  // for each texel from the point, along the normal
const float BLIND_TEXELS = 4.0;
// Where a pixel covers more of the map than the tent does, texels are compared two by two about some places that have
// the variance of what the pixel covers (lib/pixel_span.glsl).
const float WIDE_PIXEL_TEXELS = 2.2, MOST_REACH_TEXELS = 6.0;
// How far a step moves what the map shows, in tangents.
vec2 on_lamp_map(LampFace side, vec2 tangent, vec3 step) {
  const float along = dot(side.forward, step);
  return vec2(dot(side.right, step) - tangent.x * along, -dot(side.up, step) - tangent.y * along) / side.z;
}

// Of a light with a size, as soft_sun_visibility says: directions from the light's middle into a disc about that to the
// point, each on the side of the cube that it meets.
const float SOFT_SEARCH = 3.0;  // blockers from a quarter of the way on
struct LampTap {
  float stored, own;  // reversed depths: of the map, and of the point's plane with the bias
};
LampTap lamp_tap(LampRef lamp, uint form, vec3 q, vec3 d, vec3 normal) {
  const LampFace side = lamp_face(lamp, form, d);
  const vec3 tile = side.tile;
  const float z = side.z;
  LampTap tap = LampTap(0.0, 1.0);  // nothing is in the way
  if (tile.z < 0.0 || !(z > 0.0)) return tap;
  const LampScale scale = lamp_scale(lamp);
  const float texel = scale.texel_tangent, most = scale.most_tangent;
  const vec2 tangent = clamp(vec2(dot(side.right, d), -dot(side.up, d)) / z, vec2(-most), vec2(most));
  tap.stored = textureLod(sampler2DArray(pass_array_images[pc.lamp_maps], graph_samplers[SAMPLER_NEAREST_CLAMP]),
      vec3((tile.xy + floor(tangent / texel) + 0.5) * scale.uv_per_texel, tile.z), 0.0).r;
  // Where the direction meets the plane, or as far off as the point where the plane leads away.
  const float towards = -dot(normal, d), here = -dot(normal, q), far = length(q) / length(d);
  const float at = towards > 1e-6 * length(d) ? min(here / towards, far) : far;
  const float point_z = at * z;
  const float away = max(towards / z, 1e-6);
  const float bias = min((PLANE_LIFT_TEXELS + 1.0) / away, MOST_LIFT_TEXELS + 4.0) * texel +
      scale.bias_m / point_z + 9.5367432e-7;
  tap.own = lamp_near_m / point_z * (1.0 + bias);
  return tap;
}
float soft_lamp_visibility(LampRef lamp, uint form, float radius_m, vec3 q, vec3 normal) {
  const uint count = max(RaySettingsRef(pc.rays).s.lamp_samples, 1u);
  const float distance_m = length(q), turn = shadow_turn();
  const mat3 axes = axes_about(q / distance_m);
  const float search = min(radius_m / distance_m * SOFT_SEARCH, 1.0);
  float blockers = 0.0, ratio = 0.0;  // ratio: distance of the point over that of the blocker
  for (uint i = 0u; i < count; ++i) {
    const vec3 d = axes * vec3(search * shadow_place(i, count, turn), 1.0);
    const LampTap tap = lamp_tap(lamp, form, q, d, normal);
    if (!(tap.stored > tap.own)) continue;
    blockers += 1.0;
    ratio += tap.stored / tap.own;
  }
  if (blockers == 0.0) return 1.0;
  const float least = 1.5 * lamp_scale(lamp).texel_tangent;
  const float radius = clamp(radius_m / distance_m * (ratio / blockers - 1.0), least, max(search, least));
  float lit = 0.0;
  for (uint i = 0u; i < count; ++i) {
    const vec3 d = axes * vec3(radius * shadow_place(i, count, turn + 1.2), 1.0);
    const LampTap tap = lamp_tap(lamp, form, q, d, normal);
    lit += tap.stored > tap.own ? 0.0 : 1.0;
  }
  return lit / float(count);
}

// The plane of a point's triangle as a map shows it. Depths in shares of the point's own.
struct LampPlane {
  float here;          // the point's reversed depth
  float bias, lift;    // of all texels, and more for each texel from the point
  vec2 slope;          // over a texel
  float blind;         // from there on a texel counts nothing
};
// Two by two texels, x and y from the point, of which each counts as much as `weight` says. lit, all: sums of weights.
void compare_texels(LampPlane plane, vec4 stored, vec4 x, vec4 y, vec4 weight, inout float lit, inout float all) {
  const vec4 nearer = max(plane.slope.x * x + plane.slope.y * y, vec4(0.0));
  const vec4 lift = plane.lift * min(abs(x) + abs(y), 2.0);
  const vec4 counts = weight * max(1.0 - nearer / plane.blind, 0.0);
  lit += dot(counts, vec4(greaterThanEqual(plane.here * (1.0 + plane.bias + nearer + lift), stored)));
  all += counts.x + counts.y + counts.z + counts.w;
}

// 1: lit, 0: in shadow. position: relative; normal: of the triangle.
float lamp_visibility(uint number, LightRef light, vec3 position, vec3 normal) {
  LampRef lamp = lamp_at(number);
  const LampPosition from = lamp_position(lamp);
  const vec3 q = position - from.position;
  const LampFace side = lamp_face(lamp, from.form, q);
  const float z = side.z;
  if (!(z > lamp_near_m)) return 1.0;
  if (!(dot(normal, q) < 0.0)) return 0.0;
  if (LAMPS_SOFT) {
    const float radius_m = light_word(light, 7u).x;
    if (radius_m > 0.0 && dot(q, q) > radius_m * radius_m) 
      return soft_lamp_visibility(lamp, from.form, radius_m, q, normal);
  }
  const vec3 tile = side.tile;
  if (tile.z < 0.0) return 1.0;
  const LampScale scale = lamp_scale(lamp);
  const float texel = scale.texel_tangent, most = scale.most_tangent;
  const float away = max(-dot(normal, q), 1e-6 * z) / z;  // of the light from the plane
  // All depths in shares of the point's own.
  const vec2 slope = vec2(-dot(side.right, normal), dot(side.up, normal)) * (texel / away);  // over a texel
  // The last two for rounding: of the position, and of triangles' corners on the map, which lie on its subpixels.
  const float bias = min(PLANE_LIFT_TEXELS / away, MOST_LIFT_TEXELS) * texel + scale.bias_m / z + 9.5367432e-7 +
      (abs(slope.x) + abs(slope.y)) * (1.0 / 64.0);
  const vec2 tangent = clamp(vec2(dot(side.right, q), -dot(side.up, q)) / z, vec2(-most), vec2(most));
  // From the tile's middle: where the tile is must not matter to the last bit.
  const vec2 place = tangent / texel - 0.5, whole = floor(place), f = place - whole;
  LampPlane plane = LampPlane(lamp_near_m / z, bias, min(ROUND_LIFT_TEXELS / away, MOST_LIFT_TEXELS) * texel,
      slope, BLIND_TEXELS * texel);
  const uint places = from.form >> 1u;
  const PixelSpan span = pixel_span(position, normal);
  const vec2 a = on_lamp_map(side, tangent, span.across) / texel, b = on_lamp_map(side, tangent, span.down) / texel;
  float lit = 0.0, all = 0.0;
  if (places > 0u && dot(a, a) + dot(b, b) > WIDE_PIXEL_TEXELS * WIDE_PIXEL_TEXELS) {
    const Ellipse reach = ellipse_of(0.0, a, b, MOST_REACH_TEXELS);
    const vec2 last = vec2(most / texel + 0.75);  // of the tile
    for (uint i = 0u; i < places; ++i) {
      const vec2 off = on_ellipse(reach, shadow_place(i, places, 0.0));
      const vec2 at = clamp(tangent / texel + off, -last, last) - 0.5, first = floor(at), part = at - first;
      const vec4 stored = textureGather(
          sampler2DArray(pass_array_images[pc.lamp_maps], graph_samplers[SAMPLER_NEAREST_CLAMP]),
          vec3((tile.xy + first + 1.0) * scale.uv_per_texel, tile.z));
      const vec2 from = first - place, weight = 1.0 - part;
      plane.bias = bias + PIXEL_CORNER_LIFT * texel * length(off);
      compare_texels(plane, stored, from.x + vec4(0.0, 1.0, 1.0, 0.0), from.y + vec4(1.0, 1.0, 0.0, 0.0),
          vec4(weight.x, part.x, part.x, weight.x) * vec4(part.y, part.y, weight.y, weight.y), lit, all);
    }
    return all > 0.0 ? min(lit / all, 1.0) : 1.0;
  }
  const vec4 weight_x = max(vec4(0.5 - f.x, 1.5 - f.x, 0.5 + f.x, f.x - 0.5), 0.0);
  const vec4 weight_y = max(vec4(0.5 - f.y, 1.5 - f.y, 0.5 + f.y, f.y - 0.5), 0.0);
  for (int j = 0; j < 4; j += 2) {
    for (int i = 0; i < 4; i += 2) {
      // From the corner that four texels share, in the order of textureGather.
      const vec2 corner = (tile.xy + whole + vec2(float(i), float(j))) * scale.uv_per_texel;
      const vec4 stored = textureGather(
          sampler2DArray(pass_array_images[pc.lamp_maps], graph_samplers[SAMPLER_NEAREST_CLAMP]), vec3(corner, tile.z));
      compare_texels(plane, stored, vec4(float(i), float(i + 1), float(i + 1), float(i)) - 1.0 - f.x,
          vec4(float(j + 1), float(j + 1), float(j), float(j)) - 1.0 - f.y,
          vec4(weight_x[i], weight_x[i + 1], weight_x[i + 1], weight_x[i]) *
              vec4(weight_y[j + 1], weight_y[j + 1], weight_y[j], weight_y[j]), lit, all);
    }
  }
  return min(lit / all, 1.0);  // never 0: one of the inner texels lies where the plane leads away
}
