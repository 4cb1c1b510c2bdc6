#ifndef CANDELA_SHARED_LOBES_H
#define CANDELA_SHARED_LOBES_H
#include "shared/scene.h"

SHARED_BEGIN

// What a material says of the light that it lets through (KHR_materials_transmission, _volume, _ior, _dispersion).
struct Glass {
  float transmission;
  float thickness_m;                                   // in the mesh's space; 0: a sheet
  float ior;                                           // 0: does not bend light
  float dispersion;                                    // 20 over the Abbe number
  vec3 absorption;                                     // 1/m
  TextureRef transmission_texture, thickness_texture;  // R; G
};
// What a material has on its metallic-roughness base (KHR_materials_clearcoat, sheen, iridescence, anisotropy,
// diffuse_transmission, transmission). Lobes that it does not show are zeros. Textures multiply.
struct MaterialLobes {
  float coat, coat_roughness, coat_normal_scale;
  vec3 sheen;
  float sheen_roughness;
  float film, film_ior, film_least_nm, film_most_nm;
  float anisotropy;
  vec2 anisotropy_turn;  // cosine and sine of the rotation, from the tangent towards the bitangent
  float passing;         // the fraction of diffuse light that comes out on the other side
  vec3 passing_color;
  TextureRef coat_texture, coat_roughness_texture, coat_normal_texture, sheen_texture, sheen_roughness_texture,
      film_texture, film_thickness_texture, anisotropy_texture, passing_texture, passing_color_texture;
  Glass glass;  // where refraction is drawn
};

// What a body does to light that is in it (KHR_materials_volume_scatter), for the streams of a slab: 1/m.
struct BodyLight {
  vec3 turned, lost, depth;  // the fractions that are scattered back and absorbed, and how light fades by both
  vec3 extinction;           // of light that goes straight
  float thickness_m;         // in the mesh's space; 0: the material bounds no such body
};

SHARED_END

// The table, of materials that show a lobe which the frame shades: for each material the word, from the table's begin,
// at which its MaterialLobes stands, or absent; then these, each with its BodyLight behind it where a body of the frame
// scatters light. Bits of the constants LOBES and LOBE_TEXTURES are 1 << Lobe (scene/scene.h).
#ifdef __cplusplus
namespace candela::shared {
enum : uint {
  lobe_clearcoat = 1u,
  lobe_sheen = 2u,
  lobe_iridescence = 4u,
  lobe_anisotropy = 8u,
  lobe_diffuse_transmission = 32u,
  lobe_scattering = 64u
};
inline constexpr uint shaded_lobes =
    lobe_clearcoat | lobe_sheen | lobe_iridescence | lobe_anisotropy | lobe_diffuse_transmission | lobe_scattering;
static_assert(sizeof(Glass) == 28 + 2 * 40 && sizeof(MaterialLobes) == 72 + 10 * 40 + sizeof(Glass) &&
              offsetof(MaterialLobes, coat_texture) == 72);
}  // namespace candela::shared
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MaterialLobesRef { MaterialLobes m; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer BodyLightRef { BodyLight b; };
const uint material_lobes_words = 145u;
#endif

#endif
