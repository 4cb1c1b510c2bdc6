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
#include "lib/view_ray.glsl"
