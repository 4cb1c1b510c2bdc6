#pragma once
// The light that a surface sends back along a ray that has met it, before exposure, by the functions that shade what
// the camera sees. Needs lib/triangle.glsl, lib/shade.glsl, and pc.deformed_before, which holds the place of each item
// of the trees among those that are drawn.

// width_m: what the ray stands for there across its direction, by which textures are filtered.
vec3 hit_radiance(TraceHit hit, TraceRay along, float width_m) {
  const Item item = load_item(WordsRef(pc.deformed_before).w[hit.item]);
  const Geometry g = load_geometry(item.geometry);
  const Corners corners = load_corners(frame.indices, item, g, hit.primitive);
  const mat3 axes = axes_about(along.direction);
  // Slopes are those of a camera there: what a pixel is wide at 1 m, or, without perspective, anywhere.
  const float width = frame.perspective != 0u ? width_m / max(hit.t, 1e-30) : width_m;
  const TrianglePoint p =
      meet_triangle(corners, ViewRay(along.origin, along.direction, width * axes[0], width * axes[1]));
  const Material m = load_material(item.material);
  const Varyings v = lit_varyings(item, g, corners, p);
  if ((m.flags & material_unlit) != 0u || g.normal == absent) return max(surface_base_color(m, v).rgb, vec3(0.0));
  const vec3 to_viewer = -along.direction;
  const Surface s = load_surface(m, v, hit.back == 0u ? 1.0 : -1.0, to_viewer);
  begin_rays_at(hit, to_viewer);
  return surface_radiance(s, brdf_terms(s, to_viewer), p.position, p.position, rays_side);
}
