#pragma once
// The sky's radiance by its harmonics, as they are for diffuse light; every band times its factor. Needs `frame`.
vec3 ambient_radiance(vec3 n, vec3 band) {
  const vec4 sh[9] = frame.ambient_sh;
  const vec3 e = sh[0].rgb * (0.282095 * band.x) +
      (sh[1].rgb * (0.488603 * n.y) + sh[2].rgb * (0.488603 * n.z) + sh[3].rgb * (0.488603 * n.x)) * band.y +
      (sh[4].rgb * (1.092548 * n.x * n.y) + sh[5].rgb * (1.092548 * n.y * n.z) +
       sh[6].rgb * (0.315392 * (3.0 * n.z * n.z - 1.0)) + sh[7].rgb * (1.092548 * n.x * n.z) +
       sh[8].rgb * (0.546274 * (n.x * n.x - n.y * n.y))) * band.z;
  return max(e, vec3(0.0));
}
