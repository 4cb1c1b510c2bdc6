#version 460
// Depths of lamps' views, each from its place among the texels to its tile of an image of floats: four texels of a row
// a thread. What lies beyond a light's reach counts as nothing. CLEARS: all of the image becomes that, a layer for each
// z. OVER: of views of what moves alone, over what another tile holds.
#include "shared/cull.h"
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { ViewTilesPush pc; };
#include "lib/image_kinds.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int CLEARS = 0;
layout(constant_id = 1) const int OVER = 0;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TexelsRef { vec4 t[]; };

void main() {
  const uvec3 at = gl_GlobalInvocationID;
  if (at.x * 4u >= pc.size_px || at.y >= pc.size_px) return;
  if (CLEARS != 0) {
    for (uint i = 0u; i < 4u; ++i)
      imageStore(storage_array_images[pc.image], ivec3(at.x * 4u + i, at.y, at.z), vec4(0.0));
    return;
  }
  const View view = ViewsRef(pc.views).v[pc.first_view + at.z];
  const uvec2 from = view.origin_px + uvec2(at.x * 4u, at.y), to = view.tile_px + uvec2(at.x * 4u, at.y);
  const vec4 depths = max(TexelsRef(pc.texels).t[((view.layer * pc.image_px + from.y) * pc.image_px + from.x) >> 2u],
      vec4(view.least_depth));
  const uvec2 under = view.under_px + uvec2(at.x * 4u, at.y);
  for (uint i = 0u; i < 4u; ++i) {
    float depth = depths[i];
    if (OVER != 0)
      depth = max(depth, imageLoad(storage_array_images[pc.image], ivec3(under.x + i, under.y, view.under_layer)).x);
    imageStore(storage_array_images[pc.image], ivec3(to.x + i, to.y, view.tile_layer), vec4(depth));
  }
}
