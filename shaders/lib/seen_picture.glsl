#pragma once
// The picture behind surfaces that let light through, and how far off it is. Needs lib/frame.glsl,
// lib/image_kinds.glsl, REFRACTION (2: something is opaque) and a function refraction_image that gives the images'
// places: 0 the picture, 1 its pyramid, 2 the depth.
layout(constant_id = 41) const int REFRACTION_DEPTH_SAMPLES = 1;  // of the depth image, a pixel

float refraction_depth(ivec2 p) {
  const uint image = refraction_image(2u);
  return REFRACTION_DEPTH_SAMPLES > 1 ? texelFetch(pass_multisampled_images[image], p, 0).r
      : texelFetch(pass_images[image], p, 0).r;
}
// Metres before the camera; infinite where there is nothing.
float refraction_depth_m(ivec2 p) {
  if (REFRACTION == 1) return 3.0e38;  // nothing is opaque
  const float d = refraction_depth(clamp(p, ivec2(0), ivec2(frame.size_px) - 1));
  if (!(d > 0.0)) return 3.0e38;
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / d;
  return (m[3][2] - d) / length(vec3(m[0][2], m[1][2], m[2][2]));
}

vec4 refraction_level(vec2 uv, int level) {
  return textureLod(sampler2D(pass_images[refraction_image(1u)], graph_samplers[SAMPLER_LINEAR_CLAMP]), uv,
      float(level));
}
// The mean over about 2^lod pixels about a place in pixels.
vec4 refraction_picture(vec2 place_px, float lod) {
  const vec2 uv = place_px / vec2(frame.size_px);
  const vec2 pyramid_px = vec2(textureSize(pass_images[refraction_image(1u)], 0));
  const float first = log2(float(frame.size_px.x) / pyramid_px.x);  // the level 0, of the picture's texels
  const float last = float(textureQueryLevels(pass_images[refraction_image(1u)]) - 1);
  if (lod <= 0.0)
    return textureLod(sampler2D(pass_images[refraction_image(0u)], graph_samplers[SAMPLER_LINEAR_CLAMP]), uv, 0.0);
  if (lod < first) {
    const vec4 sharp =
        textureLod(sampler2D(pass_images[refraction_image(0u)], graph_samplers[SAMPLER_LINEAR_CLAMP]), uv, 0.0);
    return mix(sharp, refraction_level(uv, 0), lod / first);
  }
  const float level = clamp(lod - first, 0.0, last), whole = floor(level);
  return mix(refraction_level(uv, int(whole)), refraction_level(uv, int(min(whole + 1.0, last))), level - whole);
}
