#pragma once
// The light that a surface sends back along a ray that has met it, before exposure, by the functions that shade what
// the camera sees. Needs lib/triangle.glsl, lib/shade.glsl, and pc.deformed_before, which holds the place of each item
// of the trees among those that are drawn.

// pixel_m: what a pixel is wide there. cone: tangent of half the angle of the directions that the ray stands for
// besides (those of all pictures of a supersampled frame are parts already). Textures are filtered over both. Over
// those directions half vectors turn half as far, and as far as normals do: highlights of lamps, which may be narrower
// than that and would be met by chance, are their mean over it. Slopes are no angles where the disc is wide: it ends at
// MOST_DISC.
const float MOST_DISC = 0.5;
struct HitPoint {
  uint material;
  Material m;
  Varyings v;
  vec3 to_viewer;
#ifdef ROUNDED
  vec3 surface_point, plane_normal;  // as shadows take them
  bool is_rounded;
#endif
  bool is_unlit;
};
HitPoint hit_point(TraceHit hit, TraceRay along, float pixel_m, float cone) {
  const float lobe_m = 2.0 * cone * hit.t * (IS_SUBSAMPLE != 0 ? 1.0 / pc.subsample_footprint : 1.0);
  const float width_m = pixel_m + lobe_m;
  const Item item = load_item(WordsRef(pc.deformed_before).w[hit.item]);
  const Geometry g = load_geometry(item.geometry);
  const Corners corners = load_corners(frame.indices, item, g, hit.primitive);
  const mat3 axes = axes_about(along.direction);
  // Slopes are those of a camera there: what a pixel is wide at 1 m, or, without perspective, anywhere.
  const float width = frame.perspective != 0u ? width_m / max(hit.t, 1e-30) : width_m;
#ifdef RELIEFS
  end_relief_light();
#endif
  TrianglePoint p =
      meet_triangle(corners, ViewRay(along.origin, along.direction, width * axes[0], width * axes[1]));
  HitPoint h;
  h.material = item.material;
  h.m = load_material(item.material);
#ifdef RELIEFS
  if (h.m.relief != 0u) {
    // The ray knows where it met the relief.
    const Relief r = triangle_relief(item, g, corners.v, corners.p, h.m);
    const vec2 at = vec2(hit.u, hit.v);
    const float depth = hit.back != 0u ? 1.0 : relief_height(r, at);
    put_relief_place(r, vec3(at, depth), p);
    const ReliefPoint point = relief_point_at(r, h.m, vec3(at, depth), 0.0, hit.back != 0u);
    begin_relief_light(point.layer, point.at, point.lod, point.back);
    h.v = relief_varyings(item, g, corners, p, point);
  } else {
    h.v = lit_varyings(item, g, corners, p);
  }
#else
  h.v = lit_varyings(item, g, corners, p);
#endif
  h.to_viewer = -along.direction;
#ifdef ROUNDED
  h.surface_point = h.v.relative_position;
  h.plane_normal = dot(p.plane, along.direction) < 0.0 ? p.plane : -p.plane;
  round_off(item, g, corners, p, h.plane_normal, h.surface_point);
  h.is_rounded = (g.flags & geometry_rounded) != 0u;
#endif
  h.is_unlit = (h.m.flags & material_unlit) != 0u || g.normal == absent;
  const float turned = max(length(h.v.normal_across), length(h.v.normal_down));
  facets_disc = min(0.5 * cone + turned * cone * hit.t / max(width_m, 1e-30), MOST_DISC);
  return h;
}
Surface hit_surface(HitPoint h, TraceHit hit) {
  return load_surface(h.m, h.v, hit.back == 0u ? 1.0 : -1.0, h.to_viewer);
}
// begin_rays_at() goes before.
vec3 lit_hit(HitPoint h, Surface s) {
  const vec3 at = h.v.relative_position;
#ifdef ROUNDED
  if (h.is_rounded) {
    const TracePoint on_triangle = rays_from;
    const vec3 side = rays_side;
    rays_from = trace_free_point(h.surface_point, h.plane_normal, on_triangle.error_m);
    rays_side = h.plane_normal;
    const vec3 radiance = surface_radiance(s, brdf_terms(s, h.to_viewer), at, h.surface_point, rays_side);
    rays_from = on_triangle;
    rays_side = side;
    return radiance;
  }
#endif
  return surface_radiance(s, brdf_terms(s, h.to_viewer), at, at, rays_side);
}
vec3 hit_radiance(TraceHit hit, TraceRay along, float pixel_m, float cone) {
  const HitPoint h = hit_point(hit, along, pixel_m, cone);
  if (h.is_unlit) return max(surface_base_color(h.m, h.v).rgb, vec3(0.0));
  begin_rays_at(hit, h.to_viewer);
  return lit_hit(h, hit_surface(h, hit));
}
