// What a fragment's material says of the lobes on its base. Part of lib/surface.glsl where LOBED; needs frame.lobes.
#include "shared/lobes.h"

#ifdef SCATTERS
#include "lib/scattering.glsl"
#endif

const float coat_f0 = 0.04;
float coat_fresnel(vec3 coat_normal, vec3 to_viewer) {
  const float x = 1.0 - clamp(abs(dot(coat_normal, to_viewer)), 1e-4, 1.0), x2 = x * x;
  return coat_f0 + (1.0 - coat_f0) * (x2 * x2 * x);
}

// material: its number in the scene, or absent. base_color, normal: the base's, shading.
SurfaceLobes load_lobes(uint material, Varyings v, vec3 base_color, vec3 normal, float facing, vec3 to_viewer) {
  SurfaceLobes s;
  s.coat = s.coat_roughness = s.coat_takes = 0.0;
  s.coat_normal = normal;
  s.sheen = vec3(0.0);
  s.sheen_roughness = 1.0;
  s.film = s.film_ior = s.film_nm = 0.0;
  s.anisotropy = 0.0;
  s.tangent = s.bitangent = vec3(0.0);
  s.mirroring = normal;
  s.passing = 0.0;
  s.passing_color = vec3(0.0);
#ifdef SCATTERS
  s.front = base_color;
  s.slab_m = 0.0;
#endif
  // What is loaded is there in all lanes: lavapipe 25.0.7 may load where no lane takes the branch.
  const uint word = material == absent ? absent : WordsRef(frame.lobes).w[material == absent ? 0u : material];
  const MaterialLobes m = MaterialLobesRef(frame.lobes + (word == absent ? 0ul : 4ul * uint64_t(word))).m;
#ifdef SCATTERS
  const BodyLight body =
      BodyLightRef(frame.lobes + (word == absent ? 0ul : 4ul * uint64_t(word + material_lobes_words))).b;
#endif
  if (word == absent) return s;
  const bool has_tangent = dot(v.tangent.xyz, v.tangent.xyz) > 0.0;
  const vec3 bitangent = v.tangent.w * cross(v.normal, v.tangent.xyz);
  if (HAS_COAT) {
    s.coat = m.coat;
    s.coat_roughness = m.coat_roughness;
    vec3 n = v.normal;
    if ((LOBE_TEXTURES & lobe_clearcoat) != 0) {
      if (m.coat_texture.texture != absent) s.coat *= sample_texture(m.coat_texture, v).r;
      if (m.coat_roughness_texture.texture != absent) s.coat_roughness *= sample_texture(m.coat_roughness_texture, v).g;
      if (m.coat_normal_texture.texture != absent && has_tangent) {
        const vec3 t = (sample_texture(m.coat_normal_texture, v).xyz * 2.0 - 1.0) *
                       vec3(m.coat_normal_scale, m.coat_normal_scale, 1.0);
        n = t.x * v.tangent.xyz + t.y * bitangent + t.z * v.normal;
      }
    }
    s.coat_normal = facing * normalize_or(n, facing * to_viewer);
    s.coat_takes = s.coat * coat_fresnel(s.coat_normal, to_viewer);
  }
  if (HAS_SHEEN) {
    s.sheen = m.sheen;
    s.sheen_roughness = m.sheen_roughness;
    if ((LOBE_TEXTURES & lobe_sheen) != 0) {
      if (m.sheen_texture.texture != absent) s.sheen *= sample_texture(m.sheen_texture, v).rgb;
      if (m.sheen_roughness_texture.texture != absent)
        s.sheen_roughness *= sample_texture(m.sheen_roughness_texture, v).a;
    }
  }
  if (HAS_FILM) {
    s.film = m.film;
    s.film_ior = m.film_ior;
    s.film_nm = m.film_most_nm;
    if ((LOBE_TEXTURES & lobe_iridescence) != 0) {
      if (m.film_texture.texture != absent) s.film *= sample_texture(m.film_texture, v).r;
      if (m.film_thickness_texture.texture != absent)
        s.film_nm = mix(m.film_least_nm, m.film_most_nm, sample_texture(m.film_thickness_texture, v).g);
    }
    if (!(s.film_nm > 0.0)) s.film = 0.0;
  }
  if (HAS_ANISOTROPY && has_tangent) {
    float strength = m.anisotropy;
    vec2 along = vec2(1.0, 0.0);
    if ((LOBE_TEXTURES & lobe_anisotropy) != 0 && m.anisotropy_texture.texture != absent) {
      const vec3 t = sample_texture(m.anisotropy_texture, v).rgb;
      along = t.rg * 2.0 - 1.0;
      strength *= t.b;
    }
    const vec2 turn = m.anisotropy_turn;
    along = vec2(turn.x * along.x - turn.y * along.y, turn.y * along.x + turn.x * along.y);
    const vec3 t = along.x * v.tangent.xyz + along.y * bitangent, across = t - dot(t, normal) * normal;
    if (dot(across, across) > 1e-12) {
      s.anisotropy = strength;
      s.tangent = normalize(across);
      s.bitangent = cross(normal, s.tangent);
    }
  }
  if (HAS_PASSING) {
    s.passing = m.passing;
    s.passing_color = m.passing_color;
    if ((LOBE_TEXTURES & lobe_diffuse_transmission) != 0) {
      if (m.passing_texture.texture != absent) s.passing *= sample_texture(m.passing_texture, v).a;
      if (m.passing_color_texture.texture != absent) s.passing_color *= sample_texture(m.passing_color_texture, v).rgb;
    }
  }
#ifdef SCATTERS
  float thickness_m = body.thickness_m;
  if ((LOBE_TEXTURES & lobe_scattering) != 0 && m.glass.thickness_texture.texture != absent)
    thickness_m *= sample_texture(m.glass.thickness_texture, v).g;
  float straight = 0.0;
#if defined(REFRACTION) || defined(GLASS)
  straight = m.glass.transmission;
  if (m.glass.transmission_texture.texture != absent) straight *= sample_texture(m.glass.transmission_texture, v).r;
#endif
  scatter_in_body(body, clamp(thickness_m * v.scale, 0.0, 1e15), base_color, clamp(straight, 0.0, 1.0), s);
#endif
  return s;
}

// The normal about which a lobe of stretched facets mirrors: leaning towards what these show, the less the rounder the
// lobe (the bent normal of Khronos's sample renderer).
vec3 mirroring_normal(Surface s, vec3 to_viewer) {
  if (!HAS_ANISOTROPY || s.lobes.anisotropy == 0.0) return s.normal;
  const vec3 leaning = cross(cross(s.lobes.bitangent, to_viewer), s.lobes.bitangent);
  const float is_round = 1.0 - s.lobes.anisotropy * (1.0 - s.roughness), round2 = is_round * is_round;
  return normalize_or(mix(leaning, s.normal, round2 * round2), s.normal);
}
