#pragma once
// A point of a surface that lets light through, and what the surface does to it. Needs lib/surface.glsl, lib/brdf.glsl,
// lib/ambient.glsl and frame.lobes.
#include "lib/bend.glsl"

struct GlassPoint {
  vec3 position, to_viewer, normal;
  vec2 pixel;
  float thickness_m, ior, alpha, roughness;
  float depth_m;
};

// What the interface reflects of even light, and thus does not let through.
vec3 refraction_reflected(Surface s, BrdfTerms b) {
  const float n_v = clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0);
  const float x = 1.0 - n_v, x2 = x * x;
  vec3 f = s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * (x2 * x2 * x);
  if (HAS_AMBIENT != 0) {
    const vec2 fraction = split_sum(s.roughness, n_v).xy;
    f = s.dielectric_f0 * fraction.x + vec3(s.dielectric_f90 * fraction.y);
  }
  return clamp(f, vec3(0.0), vec3(1.0));
}

// scale: of the mesh's metres. share: of the diffuse base's light that goes through instead.
GlassPoint glass_point(Glass glass, Surface s, BrdfTerms b, Varyings v, float scale, out float fraction) {
  fraction = glass.transmission;
  GlassPoint g;
  g.thickness_m = glass.thickness_m;
  if (glass.transmission_texture.texture != absent) fraction *= sample_texture(glass.transmission_texture, v).r;
  if (glass.thickness_texture.texture != absent) g.thickness_m *= sample_texture(glass.thickness_texture, v).g;
  fraction = clamp(fraction, 0.0, 1.0);
  if (g.thickness_m > 0.0) g.thickness_m = clamp(g.thickness_m * scale, 0.0, 1e15);  // a sheet is one at any scale
  g.position = v.relative_position;
  g.to_viewer = b.to_viewer;
  g.normal = s.normal;
  g.pixel = gl_FragCoord.xy;
  g.alpha = b.alpha;
  g.roughness = s.roughness;
  g.depth_m = -dot(v.relative_position, frame.camera_back) * 0.9999;
  g.ior = glass.ior;
  return g;
}

// What goes through, of what is behind: way_m through the body. reflected: by the interface.
vec3 glass_tint(Glass glass, Surface s, vec3 reflected, float fraction, bool is_body, float way_m) {
  vec3 tint = s.base_color * ((1.0 - s.metallic) * fraction);
  if (is_body)  // the slab's other side, and what is reflected between the two
    tint *= tint * exp(-glass.absorption * way_m) / (1.0 + reflected);
  return tint * (1.0 - reflected);
}
