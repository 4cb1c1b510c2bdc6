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
