#version 460
// Equirectangular environment where nothing was drawn. The level of detail follows the direction's derivative, which
// has no jump where longitude wraps.
#include "lib/bindless.glsl"
#include "lib/frame.glsl"

#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { SkyPush pc; };
layout(constant_id = 14) const int IS_SUBSAMPLE = 0;
#ifdef FOG
#include "lib/fog.glsl"
#endif
layout(location = 0) in vec2 in_ndc;
layout(location = 0) out vec4 out_radiance;
const float PI = 3.14159265358979323846;

void main() {
  vec3 direction = -frame.camera_back;
  const vec2 ndc = IS_SUBSAMPLE != 0 ? in_ndc + pc.subsample_ndc : in_ndc;
  if (frame.perspective != 0u)
    direction += ndc.x * frame.tan_half.x * frame.camera_right - ndc.y * frame.tan_half.y * frame.camera_up;
  direction = normalize(direction);
  const float step = max(length(dFdx(direction)), length(dFdy(direction)));
  direction = in_sky(direction);
  // The middle of the image is +X, and u grows towards +Z, as three.js places an environment (scene/environment.h
  // agrees).
  const vec2 uv = vec2(atan(direction.z, direction.x) / (2.0 * PI) + 0.5, acos(clamp(direction.y, -1.0, 1.0)) / PI);
  const float width = float(textureSize(sampler2D(textures[frame.sky_background], samplers[frame.sky_sampler]), 0).x);
  const float lod = log2(max(step * width / (2.0 * PI), 1e-6));
  const vec3 radiance = textureLod(sampler2D(textures[frame.sky_background], samplers[frame.sky_sampler]), uv,
      max(lod, 0.0)).rgb;
#ifdef FOG
  const FogSeen fog = fog_before_sky(ndc);
  out_radiance = vec4(radiance * (frame.sky_intensity * frame.pre_exposure) * fog.through, 1.0);
#ifndef WITHOUT_FOG_LIGHT
  out_radiance.rgb += fog.light;
#endif
#else
  out_radiance = vec4(radiance * (frame.sky_intensity * frame.pre_exposure), 1.0);
#endif
}
