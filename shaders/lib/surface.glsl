// What a fragment's material says of its surface. Needs lib/scene.glsl and the feature constants of lib/features.glsl.

#include "lib/material.glsl"
#include "lib/blinn_phong.glsl"

struct Varyings {
  vec3 relative_position, normal;
  vec4 tangent;
  vec2 uv0, uv1;
  vec4 color;
#ifdef SCATTERS
  float scale;  // world metres to one of the mesh
#endif
#ifdef TRIANGLES  // slopes, by pixels: to the right and down. Fragment shaders take differences to their neighbours
  vec2 uv0_across, uv0_down, uv1_across, uv1_down;
  vec3 normal_across, normal_down;
#endif
};

#ifdef LOBED
// Of a point; absent lobes are zeros.
struct SurfaceLobes {
  float coat, coat_roughness;
  vec3 coat_normal;  // unit, towards the viewer's side
  float coat_takes;  // the fraction of light that the coat mirrors to the viewer, and that nothing below gets
  vec3 sheen;
  float sheen_roughness;
  float film, film_ior, film_nm;
  float anisotropy;         // strength
  vec3 tangent, bitangent;  // unit, at right angles to the shading normal; facets are rougher along the tangent
  vec3 mirroring;           // normal about which ambient light is mirrored
  float passing;            // share of diffuse light that comes out on the other side
  vec3 passing_color;
#ifdef SCATTERS
  vec3 front;               // what the base reflects of diffuse light, instead of its colour and what passes
  float slab_m;             // how far behind the surface light from there comes in
#endif
};
#endif

struct Surface {
  vec3 base_color;
  float alpha;
  float metallic, roughness, occlusion;
  vec3 normal;            // unit, shading, towards the viewer's side
  vec3 emission;
  vec3 dielectric_f0;
  float dielectric_f90;
  bool has_facets;        // else the lobe is Blinn's, of the exponent that goes with the roughness
#ifdef LOBED
  SurfaceLobes lobes;
#endif
};

vec2 texture_uv(TextureRef r, Varyings v) {
  const vec2 uv = HAS_UV1 != 0 && r.uv_set == 1u ? v.uv1 : v.uv0;
  if (HAS_TEXTURE_TRANSFORM == 0) return uv;
  return vec2(dot(r.u_row, vec3(uv, 1.0)), dot(r.v_row, vec3(uv, 1.0)));
}
#ifdef TRIANGLES
vec4 sample_texture(TextureRef r, Varyings v) {
  const bool second = HAS_UV1 != 0 && r.uv_set == 1u;
  vec2 across = second ? v.uv1_across : v.uv0_across, down = second ? v.uv1_down : v.uv0_down;
  if (HAS_TEXTURE_TRANSFORM != 0) {
    across = vec2(dot(r.u_row.xy, across), dot(r.v_row.xy, across));
    down = vec2(dot(r.u_row.xy, down), dot(r.v_row.xy, down));
  }
  if (IS_SUBSAMPLE != 0) {
    across *= pc.subsample_footprint;
    down *= pc.subsample_footprint;
  }
  if (across == vec2(0.0) && down == vec2(0.0))  // as below
    return textureLod(nonuniformEXT(sampler2D(textures[nonuniformEXT(r.texture)],
                                              samplers[nonuniformEXT(r.sampler_index)])),
                      texture_uv(r, v), 0.0);
  return textureGrad(nonuniformEXT(sampler2D(textures[nonuniformEXT(r.texture)],
                                             samplers[nonuniformEXT(r.sampler_index)])),
                     texture_uv(r, v), across, down);
}
#else
vec4 sample_texture(TextureRef r, Varyings v) {
  const vec2 uv = texture_uv(r, v);
  // Where the corners of a triangle share one place there is no footprint: llvmpipe's anisotropic filter divides by it.
  if (dFdxCoarse(uv) == vec2(0.0) && dFdyCoarse(uv) == vec2(0.0))
    return textureLod(nonuniformEXT(sampler2D(textures[nonuniformEXT(r.texture)],
                                              samplers[nonuniformEXT(r.sampler_index)])),
                      uv, 0.0);
  if (IS_SUBSAMPLE != 0)
    return textureGrad(nonuniformEXT(sampler2D(textures[nonuniformEXT(r.texture)],
                                               samplers[nonuniformEXT(r.sampler_index)])),
                       uv, dFdx(uv) * pc.subsample_footprint, dFdy(uv) * pc.subsample_footprint);
  return texture(nonuniformEXT(sampler2D(textures[nonuniformEXT(r.texture)], samplers[nonuniformEXT(r.sampler_index)])),
                 uv);
}
#endif

// Base colour with alpha: all that the depth pre-pass and unlit surfaces need.
vec4 surface_base_color(Material m, Varyings v) {
  vec4 c = m.base_color;
  if (HAS_VERTEX_COLOR != 0) c *= v.color;
  if (HAS_BASE_TEXTURE != 0 && m.base_texture.texture != absent) c *= sample_texture(m.base_texture, v);
  return c;
}

// glTF 2.0, 3.9.4: opaque ignores alpha, mask is all or nothing, blend covers.
float surface_coverage(Material m, float alpha) {
  if ((m.flags & material_blended) != 0u) return clamp(alpha, 0.0, 1.0);
  if ((m.flags & material_masked) != 0u) return alpha < m.alpha_cutoff ? 0.0 : 1.0;
  return 1.0;
}

vec3 surface_emission(Material m, Varyings v) {
  if (HAS_EMISSION == 0) return vec3(0.0);
  vec3 e = m.emissive;
  if (HAS_EMISSIVE_TEXTURE != 0 && m.emissive_texture.texture != absent) e *= sample_texture(m.emissive_texture, v).rgb;
  return e;
}

// Normal, bitangent frame as MikkTSpace wants it: interpolated vectors are not normalised before the combination.
// facing is -1 on back faces, where the whole frame turns over (glTF 2.0, 3.9.6).
vec3 surface_normal(Material m, Varyings v, float facing, vec3 to_viewer) {
  vec3 n = v.normal;
  if (HAS_NORMAL_TEXTURE != 0 && m.normal_texture.texture != absent && dot(v.tangent.xyz, v.tangent.xyz) > 0.0) {
    const vec3 s = (sample_texture(m.normal_texture, v).xyz * 2.0 - 1.0) * vec3(m.normal_scale, m.normal_scale, 1.0);
    const vec3 bitangent = v.tangent.w * cross(v.normal, v.tangent.xyz);
    n = s.x * v.tangent.xyz + s.y * bitangent + s.z * v.normal;
  }
  return facing * normalize_or(n, facing * to_viewer);
}

#ifdef LOBED
#include "lib/surface_lobes.glsl"
#endif

// How far normals stray within the pixel, as the variance of their slopes: by the shading normal's differences between
// pixels (Tokuyoshi and Kaplanyan, "Improved Geometric Specular Antialiasing", 2019), or by those of the interpolated
// normal and what the filtered normal map says of its own texels (session/mip_chain.h).
const float specular_aa_pixel = 0.15915494;  // variance of a pixel's filter, 1 / (2 pi)
const float specular_aa_most = 0.18;         // of what is added to alpha squared
#ifdef TRIANGLES
Varyings varyings_beside(Varyings v, bool below) {
  v.normal += below ? v.normal_down : v.normal_across;
  v.uv0 += below ? v.uv0_down : v.uv0_across;
  v.uv1 += below ? v.uv1_down : v.uv1_across;
  return v;
}
vec3 unfaced_normal(Material m, Varyings v) {
  if (SPECULAR_AA == specular_aa_maps) return normalize_or(v.normal, vec3(0.0));
  return surface_normal(m, v, 1.0, vec3(0.0));
}
#endif
float normal_variance(Material m, Varyings v, vec3 normal) {
#ifdef TRIANGLES
  normal = unfaced_normal(m, v);
  vec3 along = unfaced_normal(m, varyings_beside(v, false)) - normal;
  vec3 across = unfaced_normal(m, varyings_beside(v, true)) - normal;
#else
  if (SPECULAR_AA == specular_aa_maps) normal = normalize_or(v.normal, vec3(0.0));
  vec3 along = dFdx(normal), across = dFdy(normal);
#endif
  if (IS_SUBSAMPLE != 0) {
    along *= pc.subsample_footprint;
    across *= pc.subsample_footprint;
  }
  float variance = specular_aa_pixel * (dot(along, along) + dot(across, across));
  if (SPECULAR_AA == specular_aa_maps && HAS_NORMAL_TEXTURE != 0 && m.normal_texture.texture != absent) {
    const float root = sample_texture(m.normal_texture, v).a;
    variance += root * root * m.normal_scale * m.normal_scale;
  }
  return variance;
}
// The roughness of facets that stray by their own and by that.
float widened(float roughness, float variance) {
  const float alpha = roughness * roughness;
  return sqrt(sqrt(min(alpha * alpha + min(2.0 * variance, specular_aa_most), 1.0)));
}

// What a pixel of a smooth surface mirrors: the change of the unit mirror direction from pixel to pixel (Igehy, "Tracing
// Ray Differentials", 1999). Of what load_surface was called for last, with MIRROR_TAPS, or the G-buffer's point; else,
// and of the surfaces that rays meet, not known.
bool mirror_known = false;
vec3 mirror_across = vec3(0.0), mirror_down = vec3(0.0);
vec3 mirror_step(vec3 n, vec3 d, vec3 n_step, vec3 d_step) {
  return d_step - 2.0 * ((dot(d_step, n) + dot(d, n_step)) * n + dot(d, n) * n_step);
}
#ifdef FACETS_DISC
void find_mirror(Material m, Varyings v, vec3 normal, float facing, vec3 to_viewer) {}
#else
void find_mirror(Material m, Varyings v, vec3 normal, float facing, vec3 to_viewer) {
#ifdef TRIANGLES
  const vec3 plain = surface_normal(m, v, 1.0, vec3(0.0));
  vec3 n_across = facing * (surface_normal(m, varyings_beside(v, false), 1.0, vec3(0.0)) - plain);
  vec3 n_down = facing * (surface_normal(m, varyings_beside(v, true), 1.0, vec3(0.0)) - plain);
#else
  vec3 n_across = dFdx(normal), n_down = dFdy(normal);
#endif
  const vec3 d = -to_viewer;
  vec3 d_across = vec3(0.0), d_down = vec3(0.0);
  if (frame.perspective != 0u) {
    const float nearness = -dot(d, frame.camera_back);  // one over the ray's length at depth 1
    const vec2 px = 2.0 * frame.tan_half / vec2(frame.size_px) * nearness;
    d_across = px.x * (frame.camera_right - dot(frame.camera_right, d) * d);
    d_down = -px.y * (frame.camera_up - dot(frame.camera_up, d) * d);
  }
  mirror_across = mirror_step(normal, d, n_across, d_across);
  mirror_down = mirror_step(normal, d, n_down, d_down);
  if (IS_SUBSAMPLE != 0) {
    mirror_across *= pc.subsample_footprint;
    mirror_down *= pc.subsample_footprint;
  }
  mirror_known = true;
}
#endif

Surface load_surface(Material m, Varyings v, float facing, vec3 to_viewer) {
  Surface s;
  const vec4 base = surface_base_color(m, v);
  s.base_color = max(base.rgb, vec3(0.0));
  s.alpha = base.a;
  s.metallic = m.metallic;
  s.roughness = m.roughness;
  s.occlusion = 1.0;
  if (HAS_ORM_TEXTURE != 0 && m.orm_texture.texture != absent) {
    const vec3 orm = sample_texture(m.orm_texture, v).rgb;
    if ((m.flags & material_orm_metallic_roughness) != 0u) {
      s.roughness *= orm.g;
      s.metallic *= orm.b;
    }
    if ((m.flags & material_orm_occlusion) != 0u) s.occlusion = 1.0 + m.occlusion_strength * (orm.r - 1.0);
  }
  if (HAS_OCCLUSION_TEXTURE != 0 && m.occlusion_texture.texture != absent)
    s.occlusion = 1.0 + m.occlusion_strength * (sample_texture(m.occlusion_texture, v).r - 1.0);
  s.metallic = clamp(s.metallic, 0.0, 1.0);
  s.roughness = clamp(s.roughness, 0.0, 1.0);
  s.normal = surface_normal(m, v, facing, to_viewer);
  s.emission = surface_emission(m, v);
  // KHR_materials_ior and KHR_materials_specular.
  float specular = m.specular;
  vec3 specular_color = m.specular_color;
  if (HAS_SPECULAR_TEXTURE != 0) {
    if (m.specular_texture.texture != absent) {
      const float alpha = sample_texture(m.specular_texture, v).a;
      if (BLINN_PHONG != 0 && (m.flags & material_exponent_texture) != 0u)
        s.roughness = roughness_of_exponent(exponent_of_roughness(s.roughness) * alpha);
      else
        specular *= alpha;
    }
    if (m.specular_color_texture.texture != absent) specular_color *= sample_texture(m.specular_color_texture, v).rgb;
  }
  s.dielectric_f0 = min(m.ior_f0 * specular_color, vec3(1.0)) * specular;
  s.dielectric_f90 = specular;
  s.has_facets = BLINN_PHONG == 0 || (m.flags & material_blinn_phong) == 0u;
  if (MIRROR_TAPS != 0 && s.roughness < smooth_roughness) find_mirror(m, v, s.normal, facing, to_viewer);
  if (SPECULAR_AA != 0) s.roughness = widened(s.roughness, normal_variance(m, v, s.normal));
#ifdef LOBED
  s.lobes = load_lobes(m.id, v, s.base_color, s.normal, facing, to_viewer);
  s.lobes.mirroring = mirroring_normal(s, to_viewer);
  s.emission *= 1.0 - s.lobes.coat_takes;
#endif
  return s;
}
