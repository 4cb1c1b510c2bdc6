#version 460
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"

invariant gl_Position;
layout(location = 0) out flat uint out_material;
layout(location = 1) centroid out vec2 out_uv0;
layout(location = 2) centroid out vec2 out_uv1;
layout(location = 3) centroid out vec4 out_color;

void main() {
  const Item item = load_item(gl_InstanceIndex);
  const Geometry g = load_geometry(item.geometry);
  gl_Position = clip_position(relative_position(item, g, gl_VertexIndex));
  gl_PointSize = 1.0;
#ifdef RELIEF
  out_material = uint(gl_InstanceIndex);  // the item: relief_depth.frag, relief_view.frag
#endif
  if (IS_MASKED != 0) {
    const uint v = gl_VertexIndex;
    out_material = item.material;
    out_uv0 = vertex_uv0(g, v);
    out_uv1 = HAS_UV1 != 0 ? vertex_uv1(g, v) : vec2(0.0);
    out_color = HAS_VERTEX_COLOR != 0 ? vertex_color(g, v) : vec4(1.0);
  }
}
