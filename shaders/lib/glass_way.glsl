#pragma once
// What bodies absorb of the light that comes to the camera through a point of one, from the faces of all in the picture
// (refraction_bodies.frag). Part of lib/refraction.glsl. The way to the nearest back face is searched for along the ray
// that goes in (Wyman 2005, with depths alone); what lies behind that face - a hollow body's other wall, other bodies -
// counts by its straight way, shortened as much as the first one is. A body that is open, or that something opaque
// stands in, is a slab of the file's thickness where no back face is found, and the last of its pixel.
layout(constant_id = 46) const int BODY_SEARCH = 3;

vec2 refraction_place_px(vec3 position, float w);

float nearest_back_m(ivec2 p) {
  const uint image = REFRACTION_PLACE(uint(pc.table >> 32), 1u);
  const float back = texelFetch(pass_images[image], clamp(p, ivec2(0), ivec2(frame.size_px) - 1), 0).r;
  return back > 0.0 ? 1.0 / back : 0.0;
}

// Optical depth. Where what is behind is seen stays the slab's business: an exit without its direction is no nearer to
// the truth (measured on balls and lenses).
vec3 absorbed_by_bodies(Glass glass, GlassPoint g) {
  const float ior = g.ior >= 1.0 ? g.ior : 1.0, at_m = -dot(g.position, frame.camera_back);
  const vec3 inside = bent(-g.to_viewer, g.normal, 1.0 / ior);
  const float forward = -dot(inside, frame.camera_back), straight = max(dot(g.to_viewer, frame.camera_back), 1e-3);
  const vec2 from_px = g.pixel - refraction_place_px(g.position, 1.0);
  const float here_m = nearest_back_m(ivec2(g.pixel));
  if (!(here_m > at_m) || !(forward > 1e-3)) return glass.absorption * g.thickness_m;
  const float first = (here_m - at_m) / straight;  // the straight way to the other side
  const float most = max(first, g.thickness_m);
  // From the nearer of the two: at the outline of a hollow body the straight way goes round the hollow.
  float way = min(first, g.thickness_m);
  for (int i = 0; i < BODY_SEARCH; ++i) {
    const float back_m = nearest_back_m(ivec2(floor(refraction_place_px(g.position + inside * way, 1.0) + from_px)));
    if (!(back_m > at_m)) break;
    way = min((back_m - at_m) / forward, most);
  }
  vec3 absorbed = glass.absorption * way;
  const vec4 sum = texelFetch(pass_images[REFRACTION_PLACE(uint(pc.table >> 32), 0u)], ivec2(g.pixel), 0);
  if (abs(sum.a) < 0.5)  // as many front faces as back faces
    absorbed += max(sum.rgb / straight - glass.absorption * first, vec3(0.0)) * min(way / max(first, 1e-30), 1.0);
  return absorbed;
}
