// What of a texel blooms: all of it, or what lies above a threshold with a soft knee below it (quadratic over 2 knee).
float bloom_luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Negative light and what is no number have no glow.
vec3 bloom_clean(vec3 c) {
  const bvec3 bad = bvec3(isnan(c.x) || isinf(c.x), isnan(c.y) || isinf(c.y), isnan(c.z) || isinf(c.z));
  return max(mix(c, vec3(0.0), bad), vec3(0.0));
}

vec3 bloom_bright(vec3 c, float threshold, float knee) {
  c = bloom_clean(c);
  if (threshold <= 0.0) return c;
  const float brightest = max(c.r, max(c.g, c.b));
  const float soft = clamp(brightest - threshold + knee, 0.0, 2.0 * knee);
  const float above = max(brightest - threshold, knee > 0.0 ? soft * soft / (4.0 * knee) : 0.0);
  return c * (above / max(brightest, 1e-20));
}
