// One function for all passes that rasterise the scene, so that depths are equal bit for bit and EQUAL tests hold.
// Needs lib/features.glsl, lib/scene.glsl and pc.subsample_ndc.
vec3 relative_position(Item item, Geometry g, uint vertex) {
  const Transform t = TransformsRef(frame.transforms).t[item.transform];
  precise vec3 p = transform_point(t, load3(deformable_base(g), g.position + 3u * vertex));
  return p;
}
vec4 clip_position(vec3 relative) {
  precise vec4 clip = frame.clip_from_relative * vec4(relative, 1.0);
  if (IS_SUBSAMPLE != 0) clip.xy -= pc.subsample_ndc * clip.w;
  return clip;
}
#ifdef LAMPS
#include "shared/shadows.h"
// About a light, whose place in the world is `origin` and what it leaves: the same wherever the camera is. Needs
// pc.places.
vec3 position_about(vec3 origin, vec3 rest, Item item, Geometry g, uint vertex) {
  const Transform t = TransformsRef(frame.transforms).t[item.transform];
  const Place at = WorldPlacesRef(pc.places).p[item.transform];
  const vec3 local = load3(deformable_base(g), g.position + 3u * vertex);
  precise vec3 p = vec3(t.row0.x, t.row1.x, t.row2.x) * local.x;
  p = p + vec3(t.row0.y, t.row1.y, t.row2.y) * local.y;
  p = p + vec3(t.row0.z, t.row1.z, t.row2.z) * local.z;
  p = p + ((at.place - origin) + (at.rest - rest));
  return p;
}
// In the clip space of a lamp's view, which begins right at the light.
vec4 lamp_clip(mat4 clip_from_relative, vec3 about_light) {
  precise vec4 clip = clip_from_relative * vec4(about_light, 0.0);
  clip.z = lamp_near_m;
  return clip;
}
#endif
