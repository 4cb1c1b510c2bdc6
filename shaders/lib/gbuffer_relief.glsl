#pragma once
// The relief that a point of the G-buffer lies on, for its light's way through the layer. Its texel is the one
// behind those of the surface, where RELIEF_TEXEL is defined: the item and 1, the triangle of it, the mip level of its
// heights; 0: none. Needs lib/light_shadow.glsl, lib/gbuffer_read.glsl and what lib/triangle.glsl does.
#ifdef RELIEF_TEXEL
#include "lib/triangle.glsl"

void begin_gbuffer_relief(GBufferSample sample_, vec3 position) {
  const uvec4 texel = sample_.texel[GBUFFER];
  end_relief_light();
  if (texel.x == 0u) return;
  const Item item = load_item(texel.x - 1u);
  const Geometry g = load_geometry(item.geometry);
  const Corners c = load_corners(frame.indices, item, g, texel.y);
  const Relief r = triangle_relief(item, g, c.v, c.p, load_material(item.material));
  vec3 row[3];
  if (!relief_rows(r, row)) return;
  // Formats that round the position have it off the surface.
  const vec3 q = position - r.corner;
  const vec2 at = vec2(dot(row[0], q), dot(row[1], q));
  const float lod = uintBitsToFloat(texel.z);
  const float depth = RELIEF_STEPS == 0 ? relief_height(r, at)
      : textureLod(RELIEF_TEXTURE(r), relief_texture_uv(r, at), lod).r;
  begin_relief_light(r, vec3(at, depth), lod, false);
}
#endif
