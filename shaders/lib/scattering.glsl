// Bodies that scatter light (KHR_materials_volume_scatter) as slabs of the file's thickness, in two streams (Kubelka,
// "New Contributions to the Optics of Intensely Light-Scattering Materials", 1948). Light comes out where it went in, or opposite: none spreads along the surface, and the slab's sides
// are far away. Part of lib/surface_lobes.glsl where SCATTERS.

struct SlabShares {
  vec3 reflected, through;
};

SlabShares slab_shares(BodyLight body, float thickness_m) {
  const vec3 depth = body.depth * thickness_m;
  // The hyperbolic sine over its argument, and the cosine, of the depth, both times e^-depth.
  const vec3 twice = exp(-2.0 * depth), low = min(depth, vec3(0.02));
  const vec3 sine = mix((1.0 - twice) / (2.0 * max(depth, vec3(0.02))),
                        1.0 - low * (1.0 - low * (2.0 / 3.0 - low * (1.0 / 3.0))), lessThan(depth, vec3(0.02)));
  const vec3 sum = (body.turned + body.lost) * thickness_m * sine + 0.5 + 0.5 * twice;
  return SlabShares(body.turned * thickness_m * sine / sum, exp(-depth) / sum);
}

// Between two walls, each of which reflects and lets through these shares of what meets it, from either side.
SlabShares between_walls(SlabShares slab, SlabShares wall) {
  const vec3 back = 1.0 / max(1.0 - slab.reflected * wall.reflected, vec3(1e-6));
  const vec3 reflected = slab.reflected + slab.through * slab.through * wall.reflected * back;
  const vec3 out_of = 1.0 / max(1.0 - reflected * wall.reflected, vec3(1e-6));
  return SlabShares(wall.reflected + wall.through * wall.through * reflected * out_of,
                    wall.through * wall.through * slab.through * back * out_of);
}

// What the base does to diffuse light of either side. straight: the fraction of it that the surface lets through as a
// window, which is shown as the picture behind it.
void scatter_in_body(BodyLight body, float thickness_m, vec3 base_color, float straight, inout SurfaceLobes s) {
  const vec3 front = base_color * ((1.0 - s.passing) * (1.0 - straight));
  const vec3 entering = s.passing_color * (s.passing * (1.0 - straight)) + base_color * straight;
  s.front = front;
  s.passing_color *= 1.0 - straight;
  if (!(thickness_m > 0.0)) return;
  const SlabShares all = between_walls(slab_shares(body, thickness_m), SlabShares(front, entering));
  s.front = all.reflected;
  s.slab_m = thickness_m;
  s.passing = 1.0;
  const vec3 shown = base_color * straight;
  s.passing_color = max(all.through - shown * shown * exp(-body.extinction * thickness_m), vec3(0.0));
}
