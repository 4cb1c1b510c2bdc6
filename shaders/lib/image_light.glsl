// Light of a sky image (sky/prefilter_sky.h makes what is read here). Directions are in the sky's own axes. Needs
// lib/brdf.glsl.
#include "lib/axes.glsl"
#include "lib/filtered_sky.glsl"
#include "lib/visible_normal.glsl"

float slice_of_roughness(float roughness) {
  return max(float(sky_slice_count - 1u) + float(sky_slices_per_octave) * log2(max(roughness, least_roughness)), 0.0);
}

// Where a lobe's middle lies, from the normal (0) to the mirror direction (1), and the slice as wide as the lobe: xy of
// the part that f0 scales, zw of the part that f90 scales.
vec4 lobe_shape(uint lobe_texture, uint clamp_sampler, float roughness, float n_v) {
  const float size = float(sky_lobe_size), low = sqrt(least_roughness);
  const vec2 at = vec2(sqrt(n_v), (sqrt(max(roughness, least_roughness)) - low) / (1.0 - low));
  return textureLod(sampler2D(textures[lobe_texture], samplers[clamp_sampler]), (at * (size - 1.0) + 0.5) / size,
      0.0);
}

// The sky's bright spots, as far as they are not in the slice.
float share_of_lights(float slice) {
  return clamp((slice - float(sky_lights_after)) / float(sky_lights_from - sky_lights_after), 0.0, 1.0);
}
// Of the triangle, on the viewer's side, in the world's axes, where it is known: bright spots below it are hidden.
// 0: not known.
vec3 sky_lights_plane = vec3(0.0);
// How open the surface is, where nothing else tells which directions are (occlusion in screen space); 1 elsewhere. What
// is open is then taken to be a cone about the normal: an even horizon.
float sky_fraction = 1.0;
float sky_cone() { return acos(sqrt(clamp(1.0 - sky_fraction, 0.0, 1.0))); }
// Of a bright spot whose cosine to the normal is n_l. The less is hidden, the sharper the horizon: where all is open,
// no spot above it loses light.
float sky_light_open(float n_l) {
  const float soft = 0.2 * clamp(4.0 * (1.0 - sky_fraction), 0.05, 1.0);
  return smoothstep(-soft, soft, sky_cone() - acos(clamp(n_l, -1.0, 1.0)));
}
vec3 sky_lights(BrdfTerms b, float slice) {
  const float fraction = share_of_lights(slice);
  vec3 sum = vec3(0.0);
  if (fraction == 0.0) return sum;
  const vec3 plane = in_sky(sky_lights_plane);
  for (uint i = 0u; i < frame.image_light.light_count; ++i) {
    const SkyLight light = SkyLightsRef(frame.image_light.lights).s[i];
    const float n_l = dot(b.normal, light.direction);
    if (n_l <= 0.0 || dot(plane, light.direction) < 0.0) continue;
    vec3 h = light.direction + b.to_viewer;
    float h_h = dot(h, h), v_h = 0.5 * sqrt(h_h);
    if (!(h_h > 1e-8)) {
      h = b.normal;
      h_h = 1.0;
      v_h = 0.0;
    }
    const float x = clamp(1.0 - v_h, 0.0, 1.0), x2 = x * x;
    const vec3 arriving = sky_fraction < 1.0 ? light.illuminance * sky_light_open(n_l) : light.illuminance;
#ifdef LOBED
    sum += arriving * base_fresnel(b, v_h).specular * (base_dv(b, light.direction, h, h_h, n_l) * n_l);
#else
    sum += arriving * (b.f0 + (b.f90 - b.f0) * (x2 * x2 * x)) * (lobe_dv(b, h, h_h, n_l) * n_l);
#endif
  }
  return fraction * sum;
}

// The image itself over what a pixel mirrors, about a direction with its changes from pixel to pixel, widened by the
// lobe: a Gaussian's axes in texels, and along the longer one several lookups, each as wide as the shorter or, where
// taps do not suffice, as their distance (as anisotropic filters of textures do: McCormack et al., "Feline", 1999).
vec3 mirrored_sky(vec3 d, vec3 across, vec3 down, float alpha) {
  const vec2 size = frame.sky_size_px;
  const float flat2 = max(dot(d.xz, d.xz), 1e-6), flat1 = sqrt(flat2);
  const vec2 scale = size * vec2(0.5 / PI, 1.0 / PI);
  const vec2 a = scale * vec2((d.x * across.z - d.z * across.x) / flat2, -across.y / flat1);
  const vec2 b = scale * vec2((d.x * down.z - d.z * down.x) / flat2, -down.y / flat1);
  // Variances: of a box as wide as the step a twelfth of its square; of the lobe, of which half lies within 2 alpha.
  const vec2 lobe = 1.7 * alpha * scale * vec2(1.0 / flat1, 1.0);
  const vec3 s = vec3(a.x * a.x + b.x * b.x, a.y * a.y + b.y * b.y, a.x * a.y + b.x * b.y) / 12.0 +
      vec3(lobe * lobe, 0.0);
  const float mean = 0.5 * (s.x + s.y), off = 0.5 * (s.x - s.y), root = sqrt(off * off + s.z * s.z);
  const float longer = sqrt(12.0 * (mean + root)), shorter = sqrt(12.0 * max(mean - root, 0.0));
  vec2 axis = off > 0.0 ? vec2(off + root, s.z) : vec2(s.z, root - off);
  axis = dot(axis, axis) > 0.0 ? normalize(axis) : vec2(1.0, 0.0);
  const int taps = int(clamp(ceil(longer / max(shorter, 1.0)), 1.0, float(MIRROR_TAPS)));
  const float lod = log2(max(max(shorter, longer / float(taps)), 1.0));
  const vec2 uv = vec2(atan(d.z, d.x) / (2.0 * PI) + 0.5, acos(clamp(d.y, -1.0, 1.0)) / PI);
  const vec2 uv_step = longer * axis / size;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < taps; ++i)
    sum += textureLod(sampler2D(textures[frame.sky_texture], samplers[frame.sky_sampler]),
        uv + ((float(i) + 0.5) / float(taps) - 0.5) * uv_step, lod).rgb;
  return sum / float(taps);
}
// How much of a lobe of a slice mirrors sharply.
float mirror_share(float slice) {
  const float first = slice_of_roughness(least_roughness), last = float(sky_lights_after);
  return clamp((last - slice) / (last - first), 0.0, 1.0);
}

struct SkyLobes {
  vec3 diffuse, specular;
  vec3 lights;  // reflections of bright spots that are lights of their own
};
// The lobe times the cosine to light over the density of seen facets about unit h, in the surface's axes: theirs, or
// Blinn's.
float sampled_weight(BrdfTerms b, float of_facets, float pdf, vec3 h, float n_l) {
  return BLINN_PHONG == 0 || b.exponent < 0.0 ? of_facets : blinn_phong(b.exponent, dot(h.xy, h.xy)) * n_l / pdf;
}
#ifdef LOBED
#include "lib/lobes_sampled.glsl"
#else
// Bright spots are lights where the lobe is wide. Sums over directions by the cosine, and by the normals that the
// viewer sees (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018), each as wide as its fraction (Krivanek
// and Colbert 2008): with more samples it tends to the integral. The same directions for every pixel, so no noise.
// Diffuse light is gathered about `facing`.
SkyLobes sampled_sky(BrdfTerms b, vec3 facing, float roughness) {
  const mat3 axes = axes_about(b.normal), facing_axes = axes_about(facing);
  vec3 v = b.to_viewer * axes;
  v = normalize(vec3(v.xy, max(v.z, 1e-4)));
  const vec3 stretched = normalize(vec3(b.alpha * v.xy, v.z));
  const float across2 = dot(stretched.xy, stretched.xy);
  const vec3 t1 = across2 > 1e-12 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(across2) : vec3(1.0, 0.0, 0.0);
  const vec3 t2 = cross(stretched, t1);
  const float g1 = 2.0 * v.z / (v.z + sqrt(v.z * v.z * (1.0 - b.alpha2) + b.alpha2));
  const uint count = frame.image_light.pixel_samples;
  const float slice = slice_of_roughness(roughness), fraction = share_of_lights(slice);
  SkyLobes sum = SkyLobes(vec3(0.0), vec3(0.0), vec3(0.0));
  for (uint i = 0u; i < count; ++i) {
    const float u = (float(i) + 0.5) / float(count), phi = 2.0 * PI * float(bitfieldReverse(i)) * (1.0 / 4294967296.0);
    const vec2 disc = sqrt(u) * vec2(cos(phi), sin(phi));
    // Diffuse.
    vec3 l = vec3(disc, sqrt(max(1.0 - u, 0.0)));
    const float dv_h = 0.5 * length(l + v), dx = clamp(1.0 - dv_h, 0.0, 1.0), dx2 = dx * dx;
    const float left = 1.0 - (b.f0_max + (b.f90_max - b.f0_max) * dx2 * dx2 * dx);
    if (b.diffuse != vec3(0.0) && l.z > 0.0)
      sum.diffuse += left * sky_through(facing_axes * l, PI / (float(count) * l.z)).rest;
    // Specular.
    const vec3 h = visible_normal(stretched, t1, t2, vec2(b.alpha), disc);
    const float v_h = dot(v, h);
    l = 2.0 * v_h * h - v;
    if (l.z <= 0.0 || v_h <= 0.0) continue;
    const float x = clamp(1.0 - v_h, 0.0, 1.0), x2 = x * x;
    const float g2 = 2.0 * l.z * v.z /
                     (l.z * sqrt(v.z * v.z * (1.0 - b.alpha2) + b.alpha2) +
                         v.z * sqrt(l.z * l.z * (1.0 - b.alpha2) + b.alpha2));
    const float k = dot(h.xy, h.xy) + h.z * h.z * b.alpha2;
    const float pdf = g1 * b.alpha2 / (4.0 * PI * k * k * v.z);
    const SkyTexels sky = sky_through(axes * l, 1.0 / (float(count) * pdf));
    const float weight = sampled_weight(b, g2 / g1, pdf, h, l.z);
    sum.specular += (b.f0 + (b.f90 - b.f0) * (x2 * x2 * x)) * weight * mix(sky.all, sky.rest, fraction);
  }
  sum.diffuse *= b.diffuse * PI / float(count);
  sum.specular /= float(count);
  for (uint i = 0u; i < frame.image_light.light_count; ++i) {
    const SkyLight light = SkyLightsRef(frame.image_light.lights).s[i];
    const float n_l = dot(facing, light.direction);
    const float dx = clamp(1.0 - 0.5 * length(light.direction + b.to_viewer), 0.0, 1.0), dx2 = dx * dx;
    const float left = 1.0 - (b.f0_max + (b.f90_max - b.f0_max) * dx2 * dx2 * dx);
    if (n_l > 0.0) sum.diffuse += b.diffuse * light.illuminance * (left * n_l);
  }
  sum.lights = sky_lights(b, slice);
  return sum;
}
#endif
