#version 460
#ifdef LAMPS
#extension GL_ARB_shader_viewport_layer_array : require
#endif
#include "shared/draw.h"
#ifdef LAMPS
layout(push_constant, scalar) uniform Push { DepthLampPush pc; };
#else
layout(push_constant, scalar) uniform Push { DepthViewPush pc; };
#endif
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
// Depth of a view that is not the camera's.
layout(location = 0) out flat uint out_material;
layout(location = 1) centroid out vec2 out_uv0;
layout(location = 2) centroid out vec2 out_uv1;
layout(location = 3) centroid out vec4 out_color;
#ifdef RELIEF
layout(location = 4) out vec3 out_position;
#endif

void main() {
  const Item item = load_item(gl_InstanceIndex);
  const Geometry g = load_geometry(item.geometry);
#ifdef LAMPS
  gl_Layer = int(pc.layer);
  const vec3 position = position_about(pc.origin, pc.origin_rest, item, g, gl_VertexIndex);
  gl_Position = lamp_clip(pc.clip_from_relative, position);
#else
  const vec3 position = relative_position(item, g, gl_VertexIndex);
  gl_Position = pc.clip_from_relative * vec4(position, 1.0);
  // What lies before the near plane is flattened onto it. Not where the view is perspective: triangles that cross the
  // plane of the eye would be bent; such a view begins so near that nothing lies before it (shared/shadows.h).
  if (pc.flattens != 0u) gl_Position.z = min(gl_Position.z, gl_Position.w);
#endif
#ifdef RELIEF
  out_material = uint(gl_InstanceIndex);  // the item: relief_depth.frag, relief_view.frag
#endif
#ifdef RELIEF
  out_position = position;
#endif
  if (IS_MASKED != 0) {
    const uint v = gl_VertexIndex;
    out_material = item.material;
    out_uv0 = vertex_uv0(g, v);
    out_uv1 = HAS_UV1 != 0 ? vertex_uv1(g, v) : vec2(0.0);
    out_color = HAS_VERTEX_COLOR != 0 ? vertex_color(g, v) : vec4(1.0);
  }
}
