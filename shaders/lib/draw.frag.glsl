// The inputs that lib/draw.vert.glsl makes, read according to the features.
layout(location = 0) in flat uvec2 in_ids;
layout(location = 1) centroid in vec3 in_position;
layout(location = 2) centroid in vec3 in_normal;
layout(location = 3) centroid in vec4 in_tangent;
layout(location = 4) centroid in vec2 in_uv0;
layout(location = 5) centroid in vec2 in_uv1;
layout(location = 6) centroid in vec4 in_color;
layout(location = 7) in vec3 in_plane_position;  // HAS_SHADOWS or HAS_OCCLUSION: for derivatives
#if defined(REFRACTION) || defined(GLASS) || defined(SCATTERS)
layout(location = 11) in flat float in_scale;
#endif
#ifdef STORED
layout(location = 10) in flat uint in_item;
#endif

#ifdef RELIEF
// The triangle itself, as compute passes take it, and what the pixel's ray meets of its relief.
layout(location = 10) in flat uint in_item;
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/relief_fragment.glsl"
ReliefPoint relief_point;
Varyings load_varyings() {
  pixel_middle = floor(gl_FragCoord.xy) + 0.5;
  const Item item = load_item(in_item);
  const Geometry g = load_geometry(item.geometry);
  const Corners corners = load_corners(frame.indices, item, g, uint(gl_PrimitiveID));
  const ViewRay ray = view_ray(relief_pixel());
  relief_at = meet_triangle(corners, ray);
  if (!meet_relief(item, g, corners, load_material(item.material), ray, relief_at, relief_point)) discard;
  put_relief_depth(corners, relief_at.position);
#ifdef RELIEF_LIGHT
  begin_relief_light(relief_point.layer, relief_point.at, relief_point.lod, relief_point.back);
#endif
  return relief_varyings(item, g, corners, relief_at, relief_point);
}
// As lib/plane.glsl has it: of the relief.
vec3 triangle_normal(vec3 position, vec3 to_viewer) {
  const vec3 n = normalize_or(relief_point.front, to_viewer);
  return gl_FrontFacing ? n : -n;
}
#define in_plane_position relief_at.position
#else
Varyings load_varyings() {
  Varyings v;
  v.relative_position = in_position;
  v.normal = IS_UNLIT == 0 ? in_normal : vec3(0.0);
  v.tangent = IS_UNLIT == 0 && HAS_TANGENT ? in_tangent : vec4(0.0);
  v.uv0 = HAS_TEXTURES != 0 ? in_uv0 : vec2(0.0);
  v.uv1 = HAS_UV1 != 0 ? in_uv1 : vec2(0.0);
  v.color = HAS_VERTEX_COLOR != 0 ? in_color : vec4(1.0);
#ifdef SCATTERS
  v.scale = in_scale;
#endif
  return v;
}
#endif
#include "lib/view_ray.glsl"

#if defined(ROUNDED) && !defined(RELIEF)
#include "lib/rounded.glsl"
layout(location = 12) centroid in vec4 in_rounded;
void round_off(inout vec3 normal, inout vec3 point) { round_off(in_rounded, normal, point); }
#else
void round_off(inout vec3 normal, inout vec3 point) {}
#endif
