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

#ifndef RELIEF_TEXEL
#define GBUFFER_RELIEFS 0
#else
#define GBUFFER_RELIEFS 1
#endif
#ifdef LOBED
const int gbuffer_images = GBUFFER + gbuffer_lobe_texels + GBUFFER_RELIEFS;
#else
const int gbuffer_images = GBUFFER + GBUFFER_RELIEFS;
#endif
struct GBufferSample {
  uvec4 texel[gbuffer_images];
};
void load_texels(inout GBufferSample g, ivec2 pixel, int s, int first, int end) {
  for (int i = first; i < end; ++i) g.texel[i] = gbuffer_texel(i, pixel, s);
}
GBufferSample load_gbuffer(ivec2 pixel, int s) {
  GBufferSample g;
  load_texels(g, pixel, s, 0, gbuffer_images);
  return g;
}
bool is_seen(GBufferSample g) { return g.texel[0] != uvec4(0u); }
bool gbuffer_holds(GBufferSample g, ivec2 pixel, int s) {
  for (int i = 0; i < gbuffer_images; ++i)
    if (gbuffer_texel(i, pixel, s) != g.texel[i]) return false;
  return true;
}
// The samples from s on that hold what it holds; 0 where nothing is seen or an earlier sample of the pixel holds it.
int samples_first_held(GBufferSample g, ivec2 pixel, int s) {
  if (!is_seen(g)) return 0;
  for (int before = 0; before < s; ++before)
    if (gbuffer_holds(g, pixel, before)) return 0;
  int same = 1 << s;
  for (int other = s + 1; other < SAMPLES; ++other)
    if (gbuffer_holds(g, pixel, other)) same |= 1 << other;
  return same;
}

GBufferTexels own_texels(GBufferSample g) {
  GBufferTexels own;
  for (int i = 0; i < GBUFFER; ++i) own.texel[i] = g.texel[i];
  return own;
}
SurfacePoint surface_point_of(GBufferSample g, vec3 to_viewer) {
  SurfacePoint p = point_of(own_texels(g));
#ifdef LOBED
  uvec4 lobes[gbuffer_lobe_texels];
  for (int i = 0; i < gbuffer_lobe_texels; ++i) lobes[i] = g.texel[GBUFFER + GBUFFER_RELIEFS + i];
  lobes_from_texels(lobes, to_viewer, p.surface);
#endif
  return p;
}
