#pragma once
// What see-through surfaces leave of a light's rays at a point among them, by channel, from the texels of
// passes/transparency/deep_shadows.h. Needs pc.shadow_colors, and of suns pc.suns and lib/sun_cascades.glsl, of lamps
// pc.lamps and lib/lamp_face.glsl.
#include "lib/deep_shadows.glsl"
#include "lib/image_kinds.glsl"

// Bits: 1 suns have such images, 2 lamps; of blended surfaces, and of the air.
#if !defined(FOG_DEEP_SHADOWS)
#define DEEP_LIGHT DEEP_SHADOWS
#elif !defined(DEEP_SHADOWS)
#define DEEP_LIGHT FOG_DEEP_SHADOWS
#else
#define DEEP_LIGHT (DEEP_SHADOWS | FOG_DEEP_SHADOWS)
#endif

// texel: with the maps' layer. own: what the point's own surface absorbs, which lies there too.
vec3 deep_left(uint image, ivec3 texel, int layers, bool parallel, float distance, float own) {
  const ivec3 size = textureSize(pass_array_images[image], 0);
  texel.xy = clamp(texel.xy, ivec2(0), size.xy - 1);
  const DeepRange range = deep_range(texelFetch(pass_array_images[image], texel, 0), parallel);
  if (distance > range.solid + range.least) return vec3(0.0);
  if (!(range.width > 0.0) || distance < range.nearest - range.least) return vec3(1.0);  // nothing lies before it
  const int groups = size.z / layers - 2, slices = 4 * groups;
  const float place = deep_place(range, distance, slices);
  const float own_place = clamp(place, 0.0, float(slices - 1));
  float before = 0.0, all = 0.0;
  for (int i = 0; i < groups; ++i) {
    const vec4 slice = texelFetch(pass_array_images[image], ivec3(texel.xy, texel.z + layers * (2 + i)), 0);
    const vec4 others = max(slice - own * deep_weights(own_place, 4 * i), vec4(0.0));
    // A slice's absorbance is spread over its width.
    const vec4 passed = clamp(place + 0.5 - (vec4(float(4 * i)) + vec4(0.0, 1.0, 2.0, 3.0)), vec4(0.0), vec4(1.0));
    before += dot(others, passed);
    all += dot(slice, vec4(1.0));
  }
  if (!(before > 0.0)) return vec3(1.0);
  const vec3 absorbed = texelFetch(pass_array_images[image], ivec3(texel.xy, texel.z + layers), 0).rgb;
  return exp(-absorbed * min(before / all, 1.0));
}

// place: in texels. Over four texels, each compared where the point's plane is at its middle: slope.xy is how the
// distance changes over a texel.
vec3 deep_left_about(uint image, vec2 place, float layer, int layers, bool parallel, float distance, vec2 slope,
                     float own) {
  const vec2 corner = floor(place - 0.5), f = place - 0.5 - corner;
  vec3 left = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    const vec2 at = vec2(float(i & 1), float(i >> 1)), weight = mix(1.0 - f, f, at);
    left += weight.x * weight.y *
        deep_left(image, ivec3(ivec2(corner + at), int(layer)), layers, parallel, distance + dot(slope, at - f), own);
  }
  return left;
}
vec2 deep_slope(vec2 slope, float texel) {  // no steeper than this
  const float steep = length(slope);
  return steep > 8.0 * texel ? slope * (8.0 * texel / steep) : slope;
}

#if (DEEP_LIGHT & 1) != 0
// normal: of the point's plane; 0: it has none.
vec3 deep_sun(uint sun, vec3 position, vec3 normal, float own) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  const CascadePlace at = find_cascade(sun, position);
  if (at.number == max_sun_cascades) return vec3(1.0);
  const uint image = pc.shadow_colors >> 8u & 0xffu;
  const int layers = textureSize(pass_array_images[pc.sun_maps], 0).z;
  const float texels = float(textureSize(pass_array_images[image], 0).x);
  const vec2 across = vec2(dot(suns.s[sun].right, position), dot(suns.s[sun].up, position)) - at.cascade.centre_m;
  const vec2 place = (vec2(0.5) + vec2(across.x, -across.y) * (0.5 / at.cascade.half_m)) * texels;
  const vec4 depth_row = suns.s[sun].depth;
  const float distance = 1.0 - dot(depth_row, vec4(position, 1.0)), layer = float(suns.s[sun].first_layer + at.number);
  if (normal == vec3(0.0))
    return deep_left(image, ivec3(ivec2(place), int(layer)), layers, true, distance, own);
  const float texel_m = 2.0 * at.cascade.half_m / texels, texel = texel_m * length(depth_row.xyz);
  const float facing = dot(normal, suns.s[sun].to_light);
  const vec2 slope = vec2(dot(normal, suns.s[sun].right), -dot(normal, suns.s[sun].up)) *
      (texel / (abs(facing) < 1e-3 ? 1e-3 : facing));
  return deep_left_about(image, place, layer, layers, true, distance, deep_slope(slope, texel), own);
}
#endif

#if (DEEP_LIGHT & 2) != 0
vec3 deep_lamp(uint number, vec3 position, vec3 normal, float own) {
  LampRef lamp = lamp_at(number);
  const LampPosition from = lamp_position(lamp);
  const vec3 q = position - from.position;
  const LampFace side = lamp_face(lamp, from.form, q);
  const float z = side.z;
  if (!(z > lamp_near_m) || side.tile.z < 0.0) return vec3(1.0);
  const uint image = pc.shadow_colors >> 24u;
  const ivec3 size = textureSize(pass_array_images[pc.lamp_maps], 0);
  const float scale = float(textureSize(pass_array_images[image], 0).x) / float(size.x);
  const LampScale map = lamp_scale(lamp);
  const float texel_tangent = map.texel_tangent / scale;
  // Not into the next tile.
  const float most = max(map.most_tangent - texel_tangent, 0.0);
  const vec2 tangent = clamp(vec2(dot(side.right, q), -dot(side.up, q)) / z, vec2(-most), vec2(most));
  const vec2 place = (side.tile.xy + tangent / map.texel_tangent) * scale;
  if (normal == vec3(0.0))
    return deep_left(image, ivec3(ivec2(place), int(side.tile.z)), size.z, false, z, own);
  // Along the plane z changes by -z (n.right) / (n.q) for each metre of tangent at a metre.
  const float towards = dot(normal, q) / z;
  const vec2 slope = vec2(-dot(normal, side.right), dot(normal, side.up)) *
      (z * texel_tangent / (abs(towards) < 1e-3 ? 1e-3 : towards));
  return deep_left_about(image, place, side.tile.z, size.z, false, z, deep_slope(slope, z * texel_tangent), own);
}
#endif
