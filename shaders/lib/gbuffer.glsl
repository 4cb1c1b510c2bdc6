#pragma once
// What a G-buffer keeps of a shaded point, in texels of four 32-bit words, and how it comes back. Needs
// lib/surface.glsl, lib/view_ray.glsl. GBUFFER: texels of a sample. Formats (passes/surfaces/gbuffer.h):
//   floats (no PACKED): every value as it is, bit for bit; GBUFFER is 8 where smooth surfaces mirror a sky, by what a
//   pixel shows of it (lib/surface.glsl, find_mirror), else 7 where shadows or occlusion ask for the triangle's plane,
//   else 5.
//   PACKED_SPECULAR, PACKED_BITS128: 16 bytes; PACKED_POSITION, PACKED_FIELDS: 32 bytes.
// Lobes, where LOBED, are gbuffer_lobe_texels more, floats in every format. A texel of zeros: nothing is seen here.

struct SurfacePoint {
  Surface surface;     // of an unlit surface the emission alone, which is all its light
  vec3 position;       // relative space
  vec3 on_triangle;    // the same place in its triangle's plane
  vec3 at_middle;      // that plane at the pixel's middle, which may lie beyond the triangle; or the position
  vec3 plane_normal;   // unit, on the viewer's side; zero where not asked for
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
const uint point_is_seen = 1u, point_is_unlit = 2u, point_has_facets = 4u, point_mirrors = 8u;

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
  p.position = p.on_triangle = p.at_middle = p.plane_normal = vec3(0.0);
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

#define PACKED_SPECULAR 1
#define PACKED_BITS128 2
#define PACKED_POSITION 3
#define PACKED_FIELDS 4
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
// At the pixel's middle, for formats that do not hold where in it the point is: with the point's own depth it would lie
// off its triangle, in the triangle's own shadow. Where the plane is seen edge-on it is the point's own.
float depth_at_middle(SurfacePoint p) {
  const float own = depth_of_point(p.position), middle = depth_of_point(p.at_middle);
  return middle > 0.5 * own && middle < 2.0 * own ? middle : own;
}
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

// Three channels of `bits` bits with a common exponent of 5.
uint shared_exponent_bits(vec3 c, uint bits) {
  const float most = max(c.r, max(c.g, c.b)), largest = float((1u << bits) - 1u);
  const int exponent = clamp(most > 0.0 ? int(floor(log2(most))) + 1 : -15, -15, 16);
  const uvec3 q = uvec3(clamp(c * exp2(float(int(bits) - exponent)) + 0.5, vec3(0.0), vec3(largest)));
  return q.r | q.g << bits | q.b << 2u * bits | uint(exponent + 15) << 3u * bits;
}
vec3 color_of_shared_exponent(uint stored, uint bits) {
  const vec3 q = vec3(uvec3(stored, stored >> bits, stored >> 2u * bits) & ((1u << bits) - 1u));
  return q * exp2(float(int(stored >> 3u * bits & 31u) - 15 - int(bits)));
}
uint steps(float fraction, float most) { return uint(clamp(fraction * most + 0.5, 0.0, most)); }

// A dielectric's reflectance: its root, which gives those of common materials most steps.
vec3 stored_f0(vec3 f0) { return sqrt(clamp(f0, vec3(0.0), vec3(1.0))); }
#endif

// texels_of_position, position_of: those that tell where the point is, and where.
#if !defined(PACKED)
const int texels_of_position = 1;

vec3 position_of(GBufferTexels g) { return uintBitsToFloat(g.texel[0].xyz); }

GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  GBufferTexels g;
  uint flags = flags_of(p);
#if GBUFFER == 8
  if (mirror_known) flags |= point_mirrors;
  g.texel[7] = floatBitsToUint(vec4(mirror_across, mirror_down.x));
  const vec2 down = mirror_down.yz;
#else
  const vec2 down = vec2(0.0);
#endif
  g.texel[0] = uvec4(floatBitsToUint(p.position), flags);
  g.texel[1] = floatBitsToUint(vec4(s.normal, s.roughness));
  g.texel[2] = floatBitsToUint(vec4(s.base_color, s.metallic));
  g.texel[3] = floatBitsToUint(vec4(s.emission, s.occlusion));
  g.texel[4] = floatBitsToUint(vec4(s.dielectric_f0, s.dielectric_f90));
#if GBUFFER >= 7
  g.texel[5] = floatBitsToUint(vec4(p.on_triangle, down.x));
  g.texel[6] = floatBitsToUint(vec4(p.plane_normal, down.y));
#endif
  return g;
}

// Says what it mirrors too.
SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const uint flags = g.texel[0].w;
  const vec4 shape = uintBitsToFloat(g.texel[1]), color = uintBitsToFloat(g.texel[2]);
  const vec4 emitted = uintBitsToFloat(g.texel[3]), dielectric = uintBitsToFloat(g.texel[4]);
  p.position = p.on_triangle = position_of(g);
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
#if GBUFFER >= 7
  p.on_triangle = uintBitsToFloat(g.texel[5].xyz);
  p.plane_normal = uintBitsToFloat(g.texel[6].xyz);
#endif
#if GBUFFER == 8
  mirror_known = (flags & point_mirrors) != 0u;
  mirror_across = uintBitsToFloat(g.texel[7].xyz);
  mirror_down = uintBitsToFloat(uvec3(g.texel[7].w, g.texel[5].w, g.texel[6].w));
#endif
  return p;
}

#elif PACKED == PACKED_FIELDS

// Depth 32 bits float, normals 2x16 octahedral, albedo sRGB8, the rest 8 bits; emission, pre-exposed, half floats; the
// place in the pixel 2x8.
const int texels_of_position = 2;

vec3 position_of(GBufferTexels g) {
  return position_at(uintBitsToFloat(g.texel[0].x), 0.5 * unpackSnorm4x8(g.texel[1].y).zw);
}

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
  const vec3 f0 = unpackUnorm4x8(g.texel[1].z).rgb;
  const uint flags = g.texel[0].w >> 24u;
  p.position = p.on_triangle = position_of(g);
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

#elif PACKED == PACKED_POSITION

// Position 3 floats; normal 3x10 of its coordinates, the other two bits flags; albedo sRGB8, the rest 8 bits; emission,
// pre-exposed, 3x9 bits with a common exponent. The triangle's plane is the shading normal's.
const int texels_of_position = 1;

vec3 position_of(GBufferTexels g) { return uintBitsToFloat(g.texel[0].xyz); }

GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  const uvec3 normal = uvec3((s.normal * 0.5 + 0.5) * 1023.0 + 0.5);
  const uint normal_flags = normal.x | normal.y << 10u | normal.z << 20u | flags_of(p) >> 1u << 30u;
  GBufferTexels g;
  g.texel[0] = uvec4(floatBitsToUint(p.on_triangle), normal_flags);
  g.texel[1].x = packUnorm4x8(vec4(srgb_of_linear(s.base_color), s.occlusion));
  g.texel[1].y = packUnorm4x8(vec4(s.roughness, s.metallic, s.dielectric_f90, 0.0));
  g.texel[1].z = shared_exponent_bits(s.emission * frame.pre_exposure, 9u);
  g.texel[1].w = packUnorm4x8(vec4(stored_f0(s.dielectric_f0), 0.0));
  return g;
}

SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const uint packed_normal = g.texel[0].w, flags = packed_normal >> 30u << 1u;
  const vec3 normal = vec3(uvec3(packed_normal, packed_normal >> 10u, packed_normal >> 20u) & 1023u) / 1023.0;
  const vec4 color = unpackUnorm4x8(g.texel[1].x), rough = unpackUnorm4x8(g.texel[1].y);
  const vec3 f0 = unpackUnorm4x8(g.texel[1].w).rgb;
  p.position = p.on_triangle = position_of(g);
  p.is_unlit = (flags & point_is_unlit) != 0u;
  p.surface.has_facets = (flags & point_has_facets) != 0u;
  p.surface.normal = normalize(normal * 2.0 - 1.0);
  if (HAS_SHADOWS || HAS_OCCLUSION != 0) p.plane_normal = p.surface.normal;
  p.surface.base_color = linear_of_srgb(color.rgb);
  p.surface.occlusion = color.a;
  p.surface.roughness = rough.x;
  p.surface.metallic = rough.y;
  p.surface.dielectric_f90 = rough.z;
  p.surface.dielectric_f0 = f0 * f0;
  p.surface.emission = color_of_shared_exponent(g.texel[1].z, 9u) / frame.pre_exposure;
  return p;
}

#elif PACKED == PACKED_SPECULAR

// Depth at the pixel's middle, 24 bits of a positive float; normal 2x12 octahedral; diffuse and specular reflectance
// sRGB8; a whole exponent, alpha^2 = 2 / (exponent + 2) (Walter et al. 2007), 16 bits; occlusion 6, two flags. The
// triangle's plane is the shading normal's. Emission only of unlit surfaces, as their diffuse colour.
const int texels_of_position = 1;

vec3 position_of(GBufferTexels g) {
  return position_at(uintBitsToFloat((g.texel[0].x & 0xffffffu) << 7u), vec2(0.0));
}

GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  const uint depth = floatBitsToUint(depth_at_middle(p)) + 64u;
  // Shading takes the specular part from the diffuse one, that of metals too: it gets that back here.
  const vec3 f0 = mix(s.dielectric_f0, s.base_color, s.metallic), d = s.dielectric_f0;
  const float kept = (1.0 - max(d.r, max(d.g, d.b))) / max(1.0 - max(f0.r, max(f0.g, f0.b)), 1e-3);
  const vec3 diffuse = p.is_unlit ? s.emission : s.base_color * ((1.0 - s.metallic) * kept);
  const uvec3 specular = uvec3(srgb_of_linear(f0) * 255.0 + 0.5);
  const float alpha = s.roughness * s.roughness;
  const uint exponent = uint(clamp(2.0 / max(alpha * alpha, 1e-9) - 2.0, 0.0, 65535.0) + 0.5);
  GBufferTexels g;
  g.texel[0].x = depth >> 7u | steps(s.occlusion, 63.0) << 24u | flags_of(p) >> 1u << 30u;
  g.texel[0].y = octahedral_bits(s.normal, 12u) | specular.r << 24u;
  g.texel[0].z = packUnorm4x8(vec4(srgb_of_linear(diffuse), 0.0)) | specular.g << 24u;
  g.texel[0].w = exponent | specular.b << 16u | point_is_seen << 24u;
  return g;
}

SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const uvec4 t = g.texel[0];
  const uint flags = t.x >> 30u << 1u;
  p.position = p.on_triangle = position_of(g);
  p.is_unlit = (flags & point_is_unlit) != 0u;
  p.surface.has_facets = (flags & point_has_facets) != 0u;
  p.surface.normal = octahedral_direction(t.y & 0xffffffu, 12u);
  if (HAS_SHADOWS || HAS_OCCLUSION != 0) p.plane_normal = p.surface.normal;
  p.surface.occlusion = float(t.x >> 24u & 63u) / 63.0;
  p.surface.base_color = linear_of_srgb(unpackUnorm4x8(t.z).rgb);
  if (p.is_unlit) p.surface.emission = p.surface.base_color;
  p.surface.dielectric_f0 = linear_of_srgb(vec3(t.y >> 24u, t.z >> 24u, t.w >> 16u & 255u) / 255.0);
  const vec3 f0 = p.surface.dielectric_f0;
  p.surface.dielectric_f90 = clamp(50.0 * max(f0.r, max(f0.g, f0.b)), 0.0, 1.0);  // Lagarde and de Rousiers 2014
  p.surface.roughness = sqrt(sqrt(2.0 / float((t.w & 0xffffu) + 2u)));
  return p;
}

#else  // PACKED_BITS128

// Depth at the pixel's middle, 32 bits float; normal 2x11 octahedral, roughness 6, occlusion 4; albedo sRGB8,
// reflectance 8 without colour; emission, pre-exposed, 3x7 bits with a common exponent of 5, metallic 4, two flags. The
// triangle's plane is the shading normal's.
const int texels_of_position = 1;

vec3 position_of(GBufferTexels g) { return position_at(uintBitsToFloat(g.texel[0].x), vec2(0.0)); }

GBufferTexels gbuffer_of(SurfacePoint p) {
  const Surface s = p.surface;
  const vec3 root = stored_f0(s.dielectric_f0);
  GBufferTexels g;
  g.texel[0].x = floatBitsToUint(depth_at_middle(p));
  g.texel[0].y = octahedral_bits(s.normal, 11u) | steps(s.roughness, 63.0) << 22u | steps(s.occlusion, 15.0) << 28u;
  g.texel[0].z = packUnorm4x8(vec4(srgb_of_linear(s.base_color), max(root.r, max(root.g, root.b))));
  g.texel[0].w = shared_exponent_bits(s.emission * frame.pre_exposure, 7u) | steps(s.metallic, 15.0) << 26u |
      (flags_of(p) >> 1u) << 30u;
  return g;
}

SurfacePoint point_of(GBufferTexels g) {
  SurfacePoint p = no_point();
  const vec4 color = unpackUnorm4x8(g.texel[0].z);
  const uint flags = g.texel[0].w >> 30u << 1u;
  p.position = p.on_triangle = position_of(g);
  p.is_unlit = (flags & point_is_unlit) != 0u;
  p.surface.has_facets = (flags & point_has_facets) != 0u;
  p.surface.normal = octahedral_direction(g.texel[0].y, 11u);
  if (HAS_SHADOWS || HAS_OCCLUSION != 0) p.plane_normal = p.surface.normal;
  p.surface.roughness = float(g.texel[0].y >> 22u & 63u) / 63.0;
  p.surface.occlusion = float(g.texel[0].y >> 28u) / 15.0;
  p.surface.base_color = linear_of_srgb(color.rgb);
  p.surface.dielectric_f0 = vec3(color.a * color.a);
  p.surface.dielectric_f90 = clamp(50.0 * color.a * color.a, 0.0, 1.0);  // Lagarde and de Rousiers 2014
  p.surface.emission = color_of_shared_exponent(g.texel[0].w, 7u) / frame.pre_exposure;
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
