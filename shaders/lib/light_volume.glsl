#pragma once
// The volume that a point or spot light reaches, as a body of 20 triangles about it: an icosahedron about a ball, a
// pyramid of ten sides about a cone. It is wider than the light by two pixels where it is farthest, because surfaces
// are not shaded where their samples lie, and by the rounding of positions. Needs lib/frame.glsl, lib/light_data.glsl.

struct LightVolume {
  vec3 position;
  float reach_m;       // of the widened range; of a cone its height
  float bound_m;       // of all its corners, from the position
  bool is_cone;
  vec3 axis;
  float sine, cosine;  // of the half angle, widened
};

const float ICOSAHEDRON_BY_INRADIUS = 1.2585;
const float PYRAMID_BY_INRADIUS = 1.0515;  // of ten sides

// Metres of two pixels at a depth along the view axis.
float pixels_at(float depth) {
  const vec2 pixel = 2.0 * frame.tan_half / vec2(frame.size_px);
  return 2.0 * max(pixel.x, pixel.y) * (frame.perspective != 0u ? max(depth, 0.0) : 1.0);
}

// Of a light with a range.
LightVolume light_volume(LightRef light, float inverse_range) {
  LightVolume v;
  const vec2 xy = light_word(light, 0u), z_range = light_word(light, 1u), z_type = light_word(light, 3u);
  v.position = vec3(xy, z_range.x);
  const float range = 1.0 / inverse_range;
  const float margin = pixels_at(-dot(v.position, frame.camera_back) + range) +
      1e-4 * range + 1e-5 * (abs(v.position.x) + abs(v.position.y) + abs(v.position.z));
  v.reach_m = range + margin;
  v.bound_m = v.reach_m * ICOSAHEDRON_BY_INRADIUS;
  v.is_cone = false;
  v.axis = vec3(light_word(light, 2u), z_type.x);
  v.sine = 0.0;
  v.cosine = 1.0;
  if (floatBitsToUint(z_type.y) != light_spot) return v;
  const vec2 angle = light_word(light, 4u);
  // Where the falloff, in the square of the chord from the axis, ends. No cone is narrower than 3 degrees.
  const float cosine = min(1.0 - 0.5 * angle.y / angle.x - 1e-4, 0.9986);
  if (!(cosine > 0.5)) return v;
  v.is_cone = true;
  v.cosine = cosine;
  v.sine = sqrt(1.0 - cosine * cosine);
  const float behind = margin / v.sine, along = v.reach_m + behind;
  v.position -= v.axis * behind;
  v.reach_m = along;
  v.bound_m = along * length(vec2(1.0, PYRAMID_BY_INRADIUS * v.sine / v.cosine));
  return v;
}

vec3 icosahedron_corner(uint i) {  // unit
  const vec2 p = vec2(0.525731112, 0.850650808);
  const vec3 corners[12] = vec3[](vec3(-p.x, 0, p.y), vec3(p.x, 0, p.y), vec3(-p.x, 0, -p.y), vec3(p.x, 0, -p.y),
      vec3(0, p.y, p.x), vec3(0, p.y, -p.x), vec3(0, -p.y, p.x), vec3(0, -p.y, -p.x),
      vec3(p.y, p.x, 0), vec3(-p.y, p.x, 0), vec3(p.y, -p.x, 0), vec3(-p.y, -p.x, 0));
  const uint faces[60] = uint[](0u, 1u, 4u, 0u, 4u, 9u, 9u, 4u, 5u, 4u, 8u, 5u, 4u, 1u, 8u, 8u, 1u, 10u, 8u, 10u, 3u,
      5u, 8u, 3u, 5u, 3u, 2u, 2u, 3u, 7u, 7u, 3u, 10u, 7u, 10u, 6u, 7u, 6u, 11u, 11u, 6u, 0u, 0u, 6u, 1u, 6u, 10u, 1u,
      9u, 11u, 0u, 9u, 2u, 11u, 9u, 5u, 2u, 7u, 11u, 2u);
  return corners[faces[i]];
}

// Corner of a triangle, counter-clockwise from outside. In relative space.
vec3 volume_corner(LightVolume v, uint vertex) {
  if (!v.is_cone) return v.position + icosahedron_corner(vertex) * v.bound_m;
  const uint triangle = vertex / 3u, corner = vertex % 3u, side = triangle % 10u;
  const bool cap = triangle >= 10u;
  if (corner == 0u) return v.position + (cap ? v.axis * v.reach_m : vec3(0.0));
  // Any two directions across the axis.
  const vec3 a = normalize(cross(v.axis, abs(v.axis.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0))), b = cross(v.axis, a);
  const uint at = side + ((corner == 1u) == cap ? 0u : 1u);
  const float turn = 0.62831853 * float(at % 10u);
  const float radius = v.reach_m * v.sine / v.cosine * PYRAMID_BY_INRADIUS;
  return v.position + v.axis * v.reach_m + radius * (cos(turn) * a + sin(turn) * b);
}

// In which list the light stands; volume_lists: in none, it is not seen.
uint volume_list(LightRef light) {
  const float inverse_range = light_word(light, 1u).y;
  const uint type = floatBitsToUint(light_word(light, 3u).y);
  if (type == light_directional || !(inverse_range > 0.0)) return volumes_everywhere;
  const LightVolume v = light_volume(light, inverse_range);
  if (!(v.bound_m < 1e18)) return volumes_everywhere;
  for (int i = 0; i < 5; ++i)
    if (dot(frame.planes[i].xyz, v.position) + frame.planes[i].w < -v.bound_m) return volume_lists;
  // The near plane cuts a hole into front faces that it meets.
  if (frame.perspective != 0u) {
    const float near = frame.clip_from_relative[3].z;
    const float corner = near * sqrt(1.0 + dot(frame.tan_half, frame.tan_half));
    return length(v.position) > v.bound_m * 1.001 + corner ? volumes_outside : volumes_inside;
  }
  const vec4 nearest = frame.clip_from_relative * vec4(v.position + frame.camera_back * (v.bound_m * 1.001), 1.0);
  return nearest.z < nearest.w ? volumes_outside : volumes_inside;
}
