#pragma once
// How a surface that lets light through moves and widens what is seen behind it, as numbers that several surfaces of a
// ray add up, in any order (McGuire and Mara 2016, 2017), whatever lies how far behind. Light goes through the body
// between this surface and the nearest back face behind it (Wyman, "An Approximate Image-Space Approach for Interactive
// Refraction", 2005), or a slab of the file's thickness. Needs lib/glass.glsl; where BACKS is 1, pc.own >> 16
// is the place of the image of back faces.
layout(constant_id = 42) const int GLASS_SEARCH = 3;  // steps to the body's other side

struct GlassSums {
  float covers;  // 0: it is cut out here, or the far side of a body, which the near one counts too; else 1
  float fraction;  // of the diffuse base's light that goes through instead
  vec3 tint;    // of what is behind, what the surface lets through
  vec4 moved;   // by moved.xy + moved.zw q; q: one over the depth behind, or that depth where the view is parallel
  vec4 widths;  // squared width as the ray leaves, that times the depth, and its square; dispersion by the first
};

vec3 in_view(vec3 v) {
  return vec3(dot(v, frame.camera_right), dot(v, frame.camera_up), -dot(v, frame.camera_back));
}
vec2 seen_at(vec3 view) { return frame.perspective != 0u ? view.xy / max(view.z, 1e-20) : view.xy; }

#if BACKS
// From `at` along `inside`, both in view space: the other side of the body, and its normal towards the inside.
bool other_side(vec3 at, vec3 inside, inout vec3 exit, inout vec3 normal) {
  const vec2 px = 0.5 * vec2(frame.size_px) / frame.tan_half * vec2(1.0, -1.0), origin = seen_at(at);
  vec3 point = at;
  bool found = false;
  for (int i = 0; i < GLASS_SEARCH; ++i) {
    const ivec2 texel = clamp(ivec2(floor(gl_FragCoord.xy + (seen_at(point) - origin) * px)), ivec2(0),
                              ivec2(frame.size_px) - 1);
    const vec4 back = texelFetch(pass_images[pc.own >> 16u], texel, 0);
    if (!(back.w > at.z)) break;  // nothing, or another body's before this one
    const vec2 there = origin + (vec2(texel) + 0.5 - gl_FragCoord.xy) / px;
    const vec3 on_back = vec3(frame.perspective != 0u ? there * back.w : there, back.w);
    const float towards = dot(inside, back.xyz);
    if (!(towards > 1e-3)) break;
    const float way = dot(on_back - at, back.xyz) / towards;
    if (!(way > 0.0)) break;
    point = at + inside * way;
    exit = point;
    normal = -back.xyz;
    found = true;
  }
  return found;
}
#endif

GlassSums glass_sums(Material m, uint material, Surface s, BrdfTerms b, Varyings v, float scale) {
  const Glass glass = load_glass(material);
  GlassSums sums;
  const GlassPoint g = glass_point(glass, s, b, v, scale, sums.fraction);
  const float ior = g.ior >= 1.0 ? g.ior : 1.0;
  const bool is_body = g.thickness_m > 0.0;
  const vec3 at = in_view(g.position);
  sums.covers = is_body && !gl_FrontFacing ? 0.0 : surface_coverage(m, s.alpha);
  sums.moved = vec4(0.0);
  float alpha2 = g.roughness < least_roughness ? 0.0 : g.alpha * g.alpha, way = 0.0;
  // A width that is not visible tells depth and dispersion where nothing is rough.
  const float least = 1e-12;
  if (is_body) {
    const vec3 inside = in_view(bent(-g.to_viewer, g.normal, 1.0 / ior));
    vec3 exit = at + inside * g.thickness_m, normal = in_view(g.normal);
#if BACKS
    other_side(at, inside, exit, normal);
#endif
    way = length(exit - at);
    const vec3 leaving = bent(inside, normal, ior);
    const vec2 slope = leaving.xy / max(leaving.z, 0.05);
    const vec2 begin = exit.xy - slope * exit.z, seen = seen_at(at);
    sums.moved = frame.perspective != 0u ? vec4(slope - seen, begin) : vec4(begin - seen, slope);
    alpha2 = alpha2 * (ior - 1.0) * (ior - 1.0) + least;
    sums.widths.xyz = alpha2 * (vec3(1.0, at.z, at.z * at.z) + vec3(1.0, exit.z, exit.z * exit.z));
    sums.widths.w = 0.025 * glass.dispersion * sums.widths.x;
  } else {
    alpha2 = 4.0 * alpha2 + least;
    sums.widths = vec4(alpha2 * vec3(1.0, at.z, at.z * at.z), 0.0);
  }
  sums.tint = glass_tint(glass, s, refraction_reflected(s, b), sums.fraction, is_body, way);
  return sums;
}
