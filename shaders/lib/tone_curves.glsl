// Tone curves: exposed linear Rec.709 in, linear display Rec.709 in [0,1] out.

vec3 reinhard(vec3 c) { return c / (1.0 + c); }

// Reinhard on Rec.709 luminance: keeps hue, and saturated channels may clip.
vec3 reinhard_luminance(vec3 c) { return c / (1.0 + dot(c, vec3(0.2126, 0.7152, 0.0722))); }

// ACES RRT and ODT, fit by Stephen Hill, with the exposure convention of three.js (input over 0.6).
vec3 aces_hill(vec3 c) {
  const mat3 into = transpose(mat3(0.59719, 0.35458, 0.04823, 0.07600, 0.90834, 0.01566, 0.02840, 0.13383, 0.83777));
  const mat3 out_of = transpose(mat3(1.60475, -0.53108, -0.07367, -0.10208, 1.10813, -0.00605, -0.00327, -0.07276,
      1.07602));
  const vec3 v = into * (c / 0.6);
  // Above this the quotient has reached its limit; larger values would overflow to infinity over infinity.
  const vec3 x = min(v, vec3(1e6));
  return out_of * ((x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081));
}

// Khronos PBR Neutral tone mapper.
vec3 khronos_neutral(vec3 c) {
  const float x = min(c.r, min(c.g, c.b));
  c -= x < 0.08 ? x - 6.25 * x * x : 0.04;
  const float peak = max(c.r, max(c.g, c.b));
  if (peak < 0.76) return c;
  const float d = 0.24;
  const float compressed = 1.0 - d * d / (peak + d - 0.76);
  const float g = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
  return mix(c * (compressed / peak), vec3(compressed), g);
}

// AgX (Troy Sobotka), Rec.709-primaries variant with the matrices of Benjamin Wrensch's "Minimal AgX implementation"
// (2023) and the analytic sigmoid of the configuration instead of a polynomial fit.
float agx_sigmoid(float x) {
  const float pivot_x = 10.0 / 16.5, pivot_y = 0.5, slope = 2.0;
  const bool toe = x < pivot_x;
  const float p = toe ? 3.0 : 3.25;
  const float reach_x = toe ? pivot_x : 1.0 - pivot_x, reach_y = 0.5;
  const float scale = pow(pow(slope * reach_x, -p) * (pow(slope * reach_x / reach_y, p) - 1.0), -1.0 / p);
  const float u = slope * abs(x - pivot_x) / scale;
  const float y = scale * u / pow(1.0 + pow(max(u, 1e-10), p), 1.0 / p);
  return pivot_y + (toe ? -y : y);
}
vec3 agx_curve(vec3 c, float lowest_ev, float highest_ev) {
  const vec3 v = clamp((log2(max(c, vec3(1e-10))) - lowest_ev) / (highest_ev - lowest_ev), 0.0, 1.0);
  return vec3(agx_sigmoid(v.r), agx_sigmoid(v.g), agx_sigmoid(v.b));
}
// lowest_ev, highest_ev: log2 of what comes out black and white.
vec3 agx(vec3 c, float lowest_ev, float highest_ev) {
  const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051, 0.0784335999999992,
      0.878468636469772, 0.0784336,
                          0.0792237451477643, 0.0791661274605434, 0.879142973793104);
  const mat3 outset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438, -0.0980208811401368,
      1.15190312990417,
                           -0.0980434501171241, -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
  const vec3 curved = agx_curve(inset * c, lowest_ev, highest_ev);
  return pow(max(outset * curved, vec3(0.0)), vec3(2.2));
}

// AgX with Rec.2020 primaries, as Blender, Filament and three.js have it: inset and outset of Filament's fit, the same
// sigmoid.
vec3 agx_2020(vec3 c, float lowest_ev, float highest_ev) {
  const mat3 wide = mat3(0.6274039, 0.0690973, 0.0163914, 0.3292830, 0.9195404, 0.0880133, 0.0433131, 0.0113623,
      0.8955953);
  const mat3 narrow = mat3(1.6604910, -0.1245505, -0.0181508, -0.5876411, 1.1328999, -0.1005789, -0.0728499, -0.0083494,
      1.1187297);
  const mat3 inset = mat3(0.856627153315983, 0.137318972929847, 0.11189821299995, 0.0951212405381588,
      0.761241990602591, 0.0767994186031903, 0.0482516061458583, 0.101439036467562, 0.811302368396859);
  const mat3 outset = mat3(1.1271005818144368, -0.1413297634984383, -0.1413297634984383, -0.1106066430966032,
      1.157823702216272, -0.1106066430966032, -0.0164939387178346, -0.0164939387178346, 1.2519364065950405);
  const vec3 curved = agx_curve(inset * (wide * c), lowest_ev, highest_ev);
  return max(narrow * pow(max(outset * curved, vec3(0.0)), vec3(2.2)), vec3(0.0));
}
