#include "lib/vertex_attributes.glsl"
// The vertex shader of every pass that shades the scene. Varyings are centroid: never extrapolated off the triangle, so
// that a partly covered pixel shades a point of the surface. PLACED: a function placed() says where.
invariant gl_Position;
layout(location = 0) out flat uvec2 out_ids;  // material, object
layout(location = 1) centroid out vec3 out_position;
layout(location = 2) centroid out vec3 out_normal;
layout(location = 3) centroid out vec4 out_tangent;
layout(location = 4) centroid out vec2 out_uv0;
layout(location = 5) centroid out vec2 out_uv1;
layout(location = 6) centroid out vec4 out_color;
// Not centroid: its differences from pixel to pixel lie in the triangle's plane and are never parallel, where those of
// the centroids of partly covered pixels may be.
layout(location = 7) out vec3 out_plane_position;
#ifdef MOTION
#include "lib/vertex_before.glsl"
layout(location = 8) out vec3 out_now;  // clip space without its depth
layout(location = 9) out vec3 out_before;
#endif
#if defined(REFRACTION) || defined(GLASS) || defined(SCATTERS)
#include "lib/volume_scale.glsl"
layout(location = 11) out flat float out_scale;  // world metres to one of the mesh: the cube root of the volume's
#endif
#if defined(STORED) || defined(RELIEF)
layout(location = 10) out flat uint out_item;  // of the frame, in the order of drawing
#endif
#ifdef ROUNDED
#include "lib/rounded.glsl"
layout(location = 12) centroid out vec4 out_rounded;
#endif

void main() {
  const uint v = gl_VertexIndex;
  const Item item = load_item(gl_InstanceIndex);
  const Geometry g = load_geometry(item.geometry);
  const Transform t = TransformsRef(frame.transforms).t[item.transform];
#if defined(STORED) || defined(RELIEF)
  out_item = uint(gl_InstanceIndex);
#endif
  out_ids = uvec2(item.material, item.object_id);
  out_position = relative_position(item, g, v);
  gl_Position = clip_position(out_position);
  gl_PointSize = 1.0;
#ifdef MOTION
  out_now = gl_Position.xyw;
  out_before = clip_position_before(item, g, v).xyw;
#endif
#if defined(REFRACTION) || defined(GLASS) || defined(SCATTERS)
  out_scale = scale_of_volume(t);
#endif
  if (HAS_SHADOWS || HAS_OCCLUSION != 0) out_plane_position = out_position;
  if (IS_UNLIT == 0) {
    out_normal = vertex_normal(g, t, v);
    if (HAS_TANGENT) out_tangent = vertex_tangent(g, t, v);
  }
#ifdef ROUNDED
  out_rounded = vertex_rounded(g, t, v);
#endif
  if (HAS_TEXTURES != 0) out_uv0 = vertex_uv0(g, v);
  if (HAS_UV1 != 0) out_uv1 = vertex_uv1(g, v);
  if (HAS_VERTEX_COLOR != 0) out_color = vertex_color(g, v);
#ifdef PLACED
  gl_Position = placed();
#endif
}
