// How much of a point or spot light's rays come through, from its depth maps: four by four texels about the point, each
// compared by itself and weighed by a tent of 1.5 texels (Reeves, Salesin, Cook, "Rendering Antialiased Shadows with
// Depth Maps", 1987). Part of lib/light_shadow.glsl; needs pc.lamps and pc.lamp_maps. Only where HAS_LAMP_SHADOWS is 1.
//
// A texel is compared with what the plane of the point's triangle has there (Isidoro, "Shadow Mapping: GPU-based Tips
// and Techniques", 2006), exactly: over a map reversed depth is linear on a plane, and the normal gives its gradient.
// Lifting the point instead, by as much as a plane's depth differs within the lookup, lets it see past what is near:
// from points so lifted rays are open at 8 % of what faces a lamp in Sponza and lies in shadow. Three limits:
// - Where the plane leads away from the light the point's own depth counts: at the inner edge of two walls the other
//   one is not taken for something in front of this one.
// - A texel on which the plane lies some texels nearer to the light than the point sees nothing of what lies between,
//   and counts less and less.
// - Curved surfaces are not planes: the plane is moved towards the light by a share of a texel.

const float PLANE_LIFT_TEXELS = 0.15, MOST_LIFT_TEXELS = 2.0;  // along the normal, and along the ray
const float BLIND_TEXELS = 4.0;

// 1: lit, 0: in shadow. position: relative; normal: of the triangle.
float lamp_visibility(uint lamp, vec3 position, vec3 normal) {
  LampShadowsRef lamps = LampShadowsRef(pc.lamps);
  const vec3 q = position - lamps.s[lamp].position;
  vec3 right = lamps.s[lamp].right, up = lamps.s[lamp].up, forward = lamps.s[lamp].forward;
  uint face = 0u;
  if (lamps.s[lamp].is_cube != 0u) {
    const vec3 a = abs(q);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const float along = axis == 0 ? q.x : axis == 1 ? q.y : q.z;
    right = axis == 0 ? vec3(0.0, 1.0, 0.0) : axis == 1 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    up = right.zxy;
    forward = up.zxy * (along < 0.0 ? -1.0 : 1.0);
    face = 2u * uint(axis) + (along < 0.0 ? 1u : 0u);
  }
  const float z = dot(forward, q);
  if (!(z > lamp_near_m)) return 1.0;
  if (!(dot(normal, q) < 0.0)) return 0.0;
  const vec3 tile = lamps.s[lamp].tiles[face];
  if (tile.z < 0.0) return 1.0;
  const float texel = lamps.s[lamp].texel_tangent, most = lamps.s[lamp].most_tangent;
  const float away = max(-dot(normal, q), 1e-6 * z) / z;  // of the light from the plane
  // All depths in shares of the point's own.
  const vec2 slope = vec2(-dot(right, normal), dot(up, normal)) * (texel / away);  // over a texel
  // The last two for rounding: of the position, and of triangles' corners on the map, which lie on its subpixels.
  const float bias = min(PLANE_LIFT_TEXELS / away, MOST_LIFT_TEXELS) * texel + lamps.s[lamp].bias_m / z + 9.5367432e-7 +
      (abs(slope.x) + abs(slope.y)) * (1.0 / 64.0);
  const vec2 tangent = clamp(vec2(dot(right, q), -dot(up, q)) / z, vec2(-most), vec2(most));
  const vec2 place = tile.xy + tangent / texel - 0.5, f = fract(place);
  const vec4 weight_x = max(vec4(0.5 - f.x, 1.5 - f.x, 0.5 + f.x, f.x - 0.5), 0.0);
  const vec4 weight_y = max(vec4(0.5 - f.y, 1.5 - f.y, 0.5 + f.y, f.y - 0.5), 0.0);
  const float here = lamp_near_m / z;
  float lit = 0.0, all = 0.0;
  for (int j = 0; j < 4; j += 2) {
    for (int i = 0; i < 4; i += 2) {
      // From the corner that four texels share, in the order of textureGather.
      const vec2 corner = (floor(place) + vec2(float(i), float(j))) * lamps.s[lamp].uv_per_texel;
      const vec4 stored = textureGather(
          sampler2DArray(pass_array_images[pc.lamp_maps], graph_samplers[SAMPLER_NEAREST_CLAMP]), vec3(corner, tile.z));
      const vec4 x = vec4(float(i), float(i + 1), float(i + 1), float(i)) - 1.0 - f.x;
      const vec4 y = vec4(float(j + 1), float(j + 1), float(j), float(j)) - 1.0 - f.y;
      const vec4 nearer = max(slope.x * x + slope.y * y, vec4(0.0));
      const vec4 weight = vec4(weight_x[i], weight_x[i + 1], weight_x[i + 1], weight_x[i]) *
          vec4(weight_y[j + 1], weight_y[j + 1], weight_y[j], weight_y[j]) *
          max(1.0 - nearer / (BLIND_TEXELS * texel), 0.0);
      lit += dot(weight, vec4(greaterThanEqual(here * (1.0 + bias + nearer), stored)));
      all += weight.x + weight.y + weight.z + weight.w;
    }
  }
  return min(lit / all, 1.0);  // never 0: one of the inner texels lies where the plane leads away
}
