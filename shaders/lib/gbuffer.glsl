#pragma once
// What a G-buffer keeps of a shaded point, in texels of four 32-bit words, and how it comes back. Needs
// lib/surface.glsl, lib/view_ray.glsl. GBUFFER: texels of a sample. Formats (passes/surfaces/gbuffer.h):
//   floats (no PACKED): every value as it is, bit for bit; GBUFFER is 7 where shadows or occlusion ask for the
//   triangle's plane, else 5.
//   PACKED 2: 32 bytes; PACKED 1: 16 bytes.
// Lobes, where LOBED, are gbuffer_lobe_texels more, floats in every format. A texel of zeros: nothing is seen here.

struct SurfacePoint {
  Surface surface;     // of an unlit surface the emission alone, which is all its light
  vec3 position;       // relative space
  vec3 on_triangle;    // the same place in its triangle's plane
  vec3 plane_normal;   // unit, on the viewer's side; zero where nobody asks
  bool is_unlit;
};

#ifndef GBUFFER  // texels of a sample: 5 unless a pass says more
#define GBUFFER 5
#endif
struct GBufferTexels {
  uvec4 texel[GBUFFER];
};
#ifdef SCATTERS
const int gbuffer_lobe_texels = 6;
#else
const int gbuffer_lobe_texels = 5;
#endif
const uint point_is_seen = 1u, point_is_unlit = 2u, point_has_facets = 4u;

uint flags_of(SurfacePoint p) {
  return point_is_seen | (p.is_unlit ? point_is_unlit : 0u) | (p.surface.has_facets ? point_has_facets : 0u);
}

SurfacePoint no_point() {
  SurfacePoint p;
  p.surface.base_color = p.surface.emission = p.surface.dielectric_f0 = vec3(0.0);
  p.surface.alpha = 1.0;
  p.surface.metallic = p.surface.roughness = p.surface.dielectric_f90 = 0.0;
  p.surface.occlusion = 1.0;
  p.surface.normal = vec3(0.0);
  p.surface.has_facets = true;
  p.position = p.on_triangle = p.plane_normal = vec3(0.0);
  p.is_unlit = false;
#ifdef LOBED
  SurfaceLobes l;
  l.coat = l.coat_roughness = l.coat_takes = l.sheen_roughness = l.film = l.film_ior = l.film_nm = 0.0;
  l.anisotropy = l.passing = 0.0;
  l.coat_normal = l.sheen = l.tangent = l.bitangent = l.mirroring = l.passing_color = vec3(0.0);
#ifdef SCATTERS
  l.front = vec3(0.0);
  l.slab_m = 0.0;
#endif
  p.surface.lobes = l;
#endif
  return p;
}

#ifdef PACKED
#include "lib/octahedral.glsl"

// IEC 61966-2-1, 8 bits a channel; beyond 1 is 1.
vec3 srgb_of_linear(vec3 c) {
  c = clamp(c, vec3(0.0), vec3(1.0));
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}
vec3 linear_of_srgb(vec3 c) {
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}

// Depth along the view axis, in metres, of a point and where it lies off the pixel's middle, in pixels.
float depth_of_point(vec3 position) { return -dot(position, frame.camera_back); }
vec2 place_in_pixel(vec3 position) {
  const float by = frame.perspective != 0u ? depth_of_point(position) : 1.0;
  vec2 ndc = vec2(dot(position, frame.camera_right), -dot(position, frame.camera_up)) / (frame.tan_half * by);
  if (IS_SUBSAMPLE != 0) ndc -= pc.subsample_ndc;
  const vec2 place = (ndc * 0.5 + 0.5) * vec2(frame.size_px) - PIXEL_MIDDLE;
  return clamp(place, vec2(-0.5), vec2(0.5));
}
vec3 position_at(float depth, vec2 place) {
  const ViewRay ray = view_ray(PIXEL_MIDDLE + place);
  return ray.origin + depth * ray.direction;
}

// A dielectric's reflectance: its root, which gives those of common materials most steps.
vec3 stored_f0(vec3 f0) { return sqrt(clamp(f0, vec3(0.0), vec3(1.0))); }
#endif

#if !defined(PACKED)

GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  GBufferTexels g;
  g.texel[0] = uvec4(floatBitsToUint(p.position), flags_of(p));
  g.texel[1] = floatBitsToUint(vec4(s.normal, s.roughness));
  g.texel[2] = floatBitsToUint(vec4(s.base_color, s.metallic));
  g.texel[3] = floatBitsToUint(vec4(s.emission, s.occlusion));
  g.texel[4] = floatBitsToUint(vec4(s.dielectric_f0, s.dielectric_f90));
#if GBUFFER == 7
  g.texel[5] = floatBitsToUint(vec4(p.on_triangle, 0.0));
  g.texel[6] = floatBitsToUint(vec4(p.plane_normal, 0.0));
#endif
  return g;
}

SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const uint flags = g.texel[0].w;
  const vec4 shape = uintBitsToFloat(g.texel[1]), color = uintBitsToFloat(g.texel[2]);
  const vec4 emitted = uintBitsToFloat(g.texel[3]), dielectric = uintBitsToFloat(g.texel[4]);
  p.position = p.on_triangle = uintBitsToFloat(g.texel[0].xyz);
  p.is_unlit = (flags & point_is_unlit) != 0u;
  p.surface.has_facets = (flags & point_has_facets) != 0u;
  p.surface.normal = shape.xyz;
  p.surface.roughness = shape.w;
  p.surface.base_color = color.rgb;
  p.surface.metallic = color.a;
  p.surface.emission = emitted.rgb;
  p.surface.occlusion = emitted.a;
  p.surface.dielectric_f0 = dielectric.rgb;
  p.surface.dielectric_f90 = dielectric.a;
#if GBUFFER == 7
  p.on_triangle = uintBitsToFloat(g.texel[5].xyz);
  p.plane_normal = uintBitsToFloat(g.texel[6].xyz);
#endif
  return p;
}

#elif PACKED == 2

// Depth 32 bits float, normals 2x16 octahedral, albedo sRGB8, the rest 8 bits; emission, pre-exposed, half floats; the
// place in the pixel 2x8.
GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  const vec3 emission = min(s.emission * frame.pre_exposure, vec3(65504.0));
  GBufferTexels g;
  g.texel[0].x = floatBitsToUint(depth_of_point(p.on_triangle));
  g.texel[0].y = octahedral_bits(s.normal, 16u);
  g.texel[0].z = packUnorm4x8(vec4(srgb_of_linear(s.base_color), s.occlusion));
  g.texel[0].w = packUnorm4x8(vec4(s.roughness, s.metallic, s.dielectric_f90, 0.0)) | flags_of(p) << 24u;
  g.texel[1].x = packHalf2x16(emission.rg);
  g.texel[1].y = (packHalf2x16(vec2(emission.b, 0.0)) & 0xffffu) |
      packSnorm4x8(vec4(0.0, 0.0, 2.0 * place_in_pixel(p.on_triangle)));
  g.texel[1].z = packUnorm4x8(vec4(stored_f0(s.dielectric_f0), 0.0));
  g.texel[1].w = octahedral_bits(p.plane_normal, 16u);
  return g;
}

SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const vec4 color = unpackUnorm4x8(g.texel[0].z), rough = unpackUnorm4x8(g.texel[0].w);
  const vec2 place = 0.5 * unpackSnorm4x8(g.texel[1].y).zw;
  const vec3 f0 = unpackUnorm4x8(g.texel[1].z).rgb;
  const uint flags = g.texel[0].w >> 24u;
  p.position = p.on_triangle = position_at(uintBitsToFloat(g.texel[0].x), place);
  p.is_unlit = (flags & point_is_unlit) != 0u;
  p.surface.has_facets = (flags & point_has_facets) != 0u;
  p.surface.normal = octahedral_direction(g.texel[0].y, 16u);
  p.surface.base_color = linear_of_srgb(color.rgb);
  p.surface.occlusion = color.a;
  p.surface.roughness = rough.x;
  p.surface.metallic = rough.y;
  p.surface.dielectric_f90 = rough.z;
  p.surface.emission =
      vec3(unpackHalf2x16(g.texel[1].x), unpackHalf2x16(g.texel[1].y & 0xffffu).x) / frame.pre_exposure;
  p.surface.dielectric_f0 = f0 * f0;
  if (HAS_SHADOWS || HAS_OCCLUSION != 0) p.plane_normal = octahedral_direction(g.texel[1].w, 16u);
  return p;
}

#else

// Depth 32 bits float; normal 2x11 octahedral, roughness 6, occlusion 4; albedo sRGB8, reflectance 8 without colour;
// emission, pre-exposed, 3x7 bits with a common exponent of 5, metallic 4, two flags. The triangle's plane is the
// shading normal's.
uint shared_exponent_bits(vec3 c) {
  const float most = max(c.r, max(c.g, c.b));
  const int exponent = clamp(most > 0.0 ? int(floor(log2(most))) + 1 : -15, -15, 16);
  const uvec3 q = uvec3(clamp(c * exp2(float(7 - exponent)) + 0.5, vec3(0.0), vec3(127.0)));
  return q.r | q.g << 7u | q.b << 14u | uint(exponent + 15) << 21u;
}
vec3 color_of_shared_exponent(uint stored) {
  const vec3 q = vec3(uvec3(stored, stored >> 7u, stored >> 14u) & 127u);
  return q * exp2(float(int(stored >> 21u & 31u) - 15 - 7));
}
uint steps(float share, float most) { return uint(clamp(share * most + 0.5, 0.0, most)); }

GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  const vec3 root = stored_f0(s.dielectric_f0);
  GBufferTexels g;
  g.texel[0].x = floatBitsToUint(depth_of_point(p.position));
  g.texel[0].y = octahedral_bits(s.normal, 11u) | steps(s.roughness, 63.0) << 22u | steps(s.occlusion, 15.0) << 28u;
  g.texel[0].z = packUnorm4x8(vec4(srgb_of_linear(s.base_color), max(root.r, max(root.g, root.b))));
  g.texel[0].w = shared_exponent_bits(s.emission * frame.pre_exposure) | steps(s.metallic, 15.0) << 26u |
      (flags_of(p) >> 1u) << 30u;
  return g;
}

SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const vec4 color = unpackUnorm4x8(g.texel[0].z);
  const uint flags = g.texel[0].w >> 30u << 1u;
  p.position = p.on_triangle = position_at(uintBitsToFloat(g.texel[0].x), vec2(0.0));
  p.is_unlit = (flags & point_is_unlit) != 0u;
  p.surface.has_facets = (flags & point_has_facets) != 0u;
  p.surface.normal = octahedral_direction(g.texel[0].y, 11u);
  if (HAS_SHADOWS || HAS_OCCLUSION != 0) p.plane_normal = p.surface.normal;
  p.surface.roughness = float(g.texel[0].y >> 22u & 63u) / 63.0;
  p.surface.occlusion = float(g.texel[0].y >> 28u) / 15.0;
  p.surface.base_color = linear_of_srgb(color.rgb);
  p.surface.dielectric_f0 = vec3(color.a * color.a);
  p.surface.dielectric_f90 = clamp(50.0 * color.a * color.a, 0.0, 1.0);  // Lagarde and de Rousiers 2014
  p.surface.emission = color_of_shared_exponent(g.texel[0].w) / frame.pre_exposure;
  p.surface.metallic = float(g.texel[0].w >> 26u & 15u) / 15.0;
  return p;
}

#endif

#ifdef LOBED
void lobes_to_texels(SurfaceLobes l, out uvec4 texel[gbuffer_lobe_texels]) {
  texel[0] = floatBitsToUint(vec4(l.coat, l.coat_roughness, l.film, l.film_ior));
  texel[1] = floatBitsToUint(vec4(l.coat_normal, l.film_nm));
  texel[2] = floatBitsToUint(vec4(l.sheen, l.sheen_roughness));
  texel[3] = floatBitsToUint(vec4(l.tangent, l.anisotropy));
  texel[4] = floatBitsToUint(vec4(l.passing_color, l.passing));
#ifdef SCATTERS
  texel[5] = floatBitsToUint(vec4(l.front, l.slab_m));
#endif
}
void lobes_from_texels(uvec4 texel[gbuffer_lobe_texels], vec3 to_viewer, inout Surface s) {
  const vec4 coat = uintBitsToFloat(texel[0]), normal = uintBitsToFloat(texel[1]);
  const vec4 sheen = uintBitsToFloat(texel[2]), along = uintBitsToFloat(texel[3]);
  const vec4 passing = uintBitsToFloat(texel[4]);
  s.lobes.coat = coat.x;
  s.lobes.coat_roughness = coat.y;
  s.lobes.film = coat.z;
  s.lobes.film_ior = coat.w;
  s.lobes.coat_normal = normal.xyz;
  s.lobes.film_nm = normal.w;
  if (HAS_COAT) s.lobes.coat_takes = s.lobes.coat * coat_fresnel(s.lobes.coat_normal, to_viewer);
  s.lobes.sheen = sheen.rgb;
  s.lobes.sheen_roughness = sheen.w;
  s.lobes.anisotropy = along.w;
  s.lobes.tangent = along.xyz;
  s.lobes.bitangent = cross(s.normal, s.lobes.tangent);
  s.lobes.mirroring = mirroring_normal(s, to_viewer);
  s.lobes.passing_color = passing.rgb;
  s.lobes.passing = passing.w;
#ifdef SCATTERS
  const vec4 body = uintBitsToFloat(texel[5]);
  s.lobes.front = body.rgb;
  s.lobes.slab_m = body.w;
#endif
}
#endif
