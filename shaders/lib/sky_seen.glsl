#pragma once
// The sky behind everything: an equirectangular image. The level of detail follows the direction's step from pixel to
// pixel, which has no jump where longitude wraps. Needs lib/frame.glsl, IS_SUBSAMPLE and pc.subsample_ndc.
// ndc: of the picture, without the sample's own offset.
vec3 sky_direction(vec2 ndc) {
  if (IS_SUBSAMPLE != 0) ndc += pc.subsample_ndc;
  vec3 direction = -frame.camera_back;
  if (frame.perspective != 0u)
    direction += ndc.x * frame.tan_half.x * frame.camera_right - ndc.y * frame.tan_half.y * frame.camera_up;
  return normalize(direction);
}
// step: of the unit direction over a pixel.
vec3 sky_radiance(vec3 direction, float step) {
  direction = in_sky(direction);
  // The middle of the image is +X, and u grows towards +Z, as three.js places an environment (scene/environment.h
  // agrees).
  const float pi = 3.14159265358979323846;
  const vec2 uv = vec2(atan(direction.z, direction.x) / (2.0 * pi) + 0.5, acos(clamp(direction.y, -1.0, 1.0)) / pi);
  const float width = float(textureSize(sampler2D(textures[frame.sky_background], samplers[frame.sky_sampler]), 0).x);
  const float lod = log2(max(step * width / (2.0 * pi), 1e-6));
  return textureLod(sampler2D(textures[frame.sky_background], samplers[frame.sky_sampler]), uv, max(lod, 0.0)).rgb *
      (frame.sky_intensity * frame.pre_exposure);
}
