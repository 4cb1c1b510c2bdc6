#pragma once
// What fog leaves of a light on its way to a point. Needs lib/light_data.glsl and lib/fog_medium.glsl.
vec3 fog_light_through(LightRef light, vec3 position) {
  const vec2 xy = light_word(light, 0u), z_type = light_word(light, 3u);
  if (floatBitsToUint(z_type.y) == light_directional)
    return fog_through(position, -vec3(light_word(light, 2u), z_type.x), FOG_FAR);
  const vec3 to_light = vec3(xy, light_word(light, 1u).x) - position;
  const float d2 = dot(to_light, to_light);
  if (!(d2 < 3.0e38) || d2 == 0.0) return vec3(d2 == 0.0 ? 1.0 : 0.0);
  const float d = sqrt(d2);
  return fog_through(position, to_light / d, d);
}
