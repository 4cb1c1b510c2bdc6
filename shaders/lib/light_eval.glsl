// KHR_lights_punctual. Needs lib/scene.glsl and lib/brdf.glsl.

// Closer than this a point light's inverse square is held, the same in every path (TECHNIQUES 9.3).
const float MIN_LIGHT_DISTANCE_M = 0.01;

// Illuminance (times colour) that arrives perpendicular to the light's direction, and that direction. Exactly zero outside the
// range and the cone.
vec3 light_arriving(Light light, vec3 position, out vec3 l) {
  if (light.type == light_directional) {
    l = -light.direction;
    return light.intensity;
  }
  const vec3 to_light = light.position - position;
  const float d2 = dot(to_light, to_light);
  l = vec3(0.0, 1.0, 0.0);
  if (!(d2 < 3.0e38)) return vec3(0.0);  // farther than floats can say
  if (d2 > 0.0) l = to_light * inversesqrt(d2);
  const float x2 = d2 * light.inverse_range * light.inverse_range;
  const float window = max(1.0 - x2 * x2, 0.0);
  float factor = window / max(d2, MIN_LIGHT_DISTANCE_M * MIN_LIGHT_DISTANCE_M);
  if (light.type == light_spot) {
    const float a = clamp(dot(-l, light.direction) * light.spot_scale + light.spot_offset, 0.0, 1.0);
    factor *= a * a;
  }
  return light.intensity * factor;
}

vec3 light_contribution(uint index, Surface s, vec3 position, vec3 v) {
  const Light light = LightsRef(frame.lights).l[index];
  vec3 l;
  const vec3 arriving = light_arriving(light, position, l);
  // Also keeps an overflowing highlight from turning no light into 0 times infinity.
  if (arriving == vec3(0.0)) return vec3(0.0);
  return arriving * evaluate_brdf(s, l, v);
}
