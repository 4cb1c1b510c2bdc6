#pragma once
// The G-buffer's texels of a sample. Needs lib/gbuffer.glsl, and pc.table: 4 bits for the place of each image among the
// pass's.
#include "lib/bindless.glsl"
layout(set = 1, binding = 0) uniform utexture2DMS pass_uint_multisampled_images[16];
layout(constant_id = 30) const int SAMPLES = 1;

uvec4 gbuffer_texel(int image, ivec2 pixel, int s) {
  const uint place = uint(pc.table >> (4 * image)) & 15u;
  return SAMPLES > 1 ? texelFetch(pass_uint_multisampled_images[place], pixel, s)
      : texelFetch(pass_uint_images[place], pixel, 0);
}

#ifdef LOBED
const int gbuffer_images = GBUFFER + gbuffer_lobe_texels;
#else
const int gbuffer_images = GBUFFER;
#endif
struct GBufferSample {
  uvec4 texel[gbuffer_images];
};
GBufferSample load_gbuffer(ivec2 pixel, int s) {
  GBufferSample g;
  for (int i = 0; i < gbuffer_images; ++i) g.texel[i] = gbuffer_texel(i, pixel, s);
  return g;
}
bool is_seen(GBufferSample g) { return g.texel[0] != uvec4(0u); }
bool gbuffer_holds(GBufferSample g, ivec2 pixel, int s) {
  for (int i = 0; i < gbuffer_images; ++i)
    if (gbuffer_texel(i, pixel, s) != g.texel[i]) return false;
  return true;
}

SurfacePoint surface_point_of(GBufferSample g, vec3 to_viewer) {
  GBufferTexels own;
  for (int i = 0; i < GBUFFER; ++i) own.texel[i] = g.texel[i];
  SurfacePoint p = point_of(own);
#ifdef LOBED
  uvec4 lobes[gbuffer_lobe_texels];
  for (int i = 0; i < gbuffer_lobe_texels; ++i) lobes[i] = g.texel[GBUFFER + i];
  lobes_from_texels(lobes, to_viewer, p.surface);
#endif
  return p;
}
