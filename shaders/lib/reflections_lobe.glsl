#pragma once
// The directions from which a surface's GGX lobe sends light to the camera, by the normals that the viewer sees (Heitz,
// "Sampling the GGX Distribution of Visible Normals", 2018), and what is made of the light that comes from there. All
// in camera space. Needs lib/reflections.glsl, lib/axes.glsl, lib/ambient_sh.glsl and a constant HAS_SKY.
#include "lib/visible_normal.glsl"
#include "shared/split_sum.h"
const float LOBE_PI = 3.14159265358979323846;

struct ReflectedLobe {
  mat3 axes;  // about the normal; the next four are in them
  vec3 view, stretched, t1, t2;
  float alpha, alpha2, smith_v, g1;
  vec3 f0;
  float f90;
};
// v: unit, to the camera.
ReflectedLobe reflected_lobe(Reflecting r, vec3 v, float roughness) {
  ReflectedLobe o;
  o.alpha = max(roughness, least_roughness);
  o.alpha *= o.alpha;
  o.alpha2 = o.alpha * o.alpha;
  o.f0 = r.f0;
  o.f90 = r.f90;
  o.axes = axes_about(r.normal);
  o.view = v * o.axes;
  o.view = normalize(vec3(o.view.xy, max(o.view.z, 1e-4)));
  o.stretched = normalize(vec3(o.alpha * o.view.xy, o.view.z));
  const float across2 = dot(o.stretched.xy, o.stretched.xy);
  o.t1 = across2 > 1e-12 ? vec3(-o.stretched.y, o.stretched.x, 0.0) * inversesqrt(across2) : vec3(1.0, 0.0, 0.0);
  o.t2 = cross(o.stretched, o.t1);
  o.smith_v = sqrt(o.view.z * o.view.z * (1.0 - o.alpha2) + o.alpha2);
  o.g1 = 2.0 * o.view.z / (o.view.z + o.smith_v);
  return o;
}

struct LobeSample {
  vec3 l;       // unit
  vec3 weight;  // of its light
  float cone;   // tangent of half the angle of its fraction of the lobe
  float sky;    // weight of the sky there
};
// Number `part` of so many of a pixel: strata of the first number by sample, of the second by the pattern of 4 by 4
// texels (`order`), over all parts of a supersampled frame. False: the direction leads into the surface.
bool lobe_sample(ReflectedLobe o, uint part, uint parts, uint order, out LobeSample sampled) {
  const float u = (float(part) + (float(order) + 0.5) / 16.0) / float(parts);
  const float turn = fract(float(bitfieldReverse(part)) * (1.0 / 4294967296.0) +
      float(bitfieldReverse(order) >> 28) / 16.0);
  const float radius = sqrt(u), phi = 2.0 * LOBE_PI * turn;
  const vec2 disc = radius * vec2(cos(phi), sin(phi));
  const vec3 h = visible_normal(o.stretched, o.t1, o.t2, vec2(o.alpha), disc);
  const float v_h = dot(o.view, h);
  const vec3 local = 2.0 * v_h * h - o.view;
  if (local.z <= 0.0 || v_h <= 0.0) return false;
  const float x = clamp(1.0 - v_h, 0.0, 1.0), x2 = x * x;
  const float g2 = 2.0 * local.z * o.view.z /
      (local.z * o.smith_v + o.view.z * sqrt(local.z * local.z * (1.0 - o.alpha2) + o.alpha2));
  sampled.weight = (o.f0 + (o.f90 - o.f0) * (x2 * x2 * x)) * (g2 / o.g1);
  sampled.l = o.axes * local;
  sampled.sky = 1.0;
  if (HAS_SKY != 0)
    sampled.sky = max(dot(ambient_radiance(from_camera_space(sampled.l), vec3(1.0)), vec3(0.2126, 0.7152, 0.0722)),
        0.0);
  sampled.sky *= max(sampled.weight.r, max(sampled.weight.g, sampled.weight.b));
  // A cone as wide as the sample's fraction of the lobe (Krivanek and Colbert, "Real-time Shading with Filtered Importance
  // Sampling", 2008).
  const float d = dot(h.xy, h.xy) + h.z * h.z * o.alpha2;
  const float pdf = o.g1 * o.alpha2 / (4.0 * LOBE_PI * d * d * o.view.z);
  sampled.cone = sqrt(min(1.0 / (LOBE_PI * float(parts) * pdf), 1.0));
  return true;
}

struct LobeLight {
  vec3 light, all;
  float sky_all, sky_hit;
};
// The mean light over the lobe of the directions that meet the scene, and what fraction of the sky's they hide.
vec4 mean_of(LobeLight sum) {
  return vec4(sum.light / max(sum.all, vec3(1e-20)),
      sum.sky_all > 0.0 ? clamp(sum.sky_hit / sum.sky_all, 0.0, 1.0) : 0.0);
}

// How far a surface reflects the scene at all: less from three quarters of the roughest on.
float reflects_scene(float roughness, float roughest) {
  return roughest >= 1.0 ? 1.0 : 1.0 - smoothstep(0.75 * roughest, max(roughest, 1e-6), roughness);
}
