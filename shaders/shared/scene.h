#ifndef CANDELA_SHARED_SCENE_H
#define CANDELA_SHARED_SCENE_H
#include "shared/fog.h"
#include "shared/image_light.h"
#include "shared/lights.h"
#include "shared/probes.h"
#include "shared/types.h"

SHARED_BEGIN

// Word offset of an attribute that a section does not have.
#ifdef __cplusplus
inline constexpr uint absent = 0xffffffffu;
#else
const uint absent = 0xffffffffu;
#endif

// Rows of an affine relative_from_local.
struct Transform {
  vec4 row0, row1, row2;
};

// Where a transform's origin lies in the world, as a float and what it leaves.
struct Place {
  vec3 place, rest;
};

// Where a section's vertices lie, in 4-byte words from FrameConstants.vertices; the first three from the deformed
// buffer instead when flags has geometry_deformed. Positions, normals: 3 words a vertex; tangents, colours: 4; UVs: 2.
// geometry_rounded: polygons of metaballs, with more behind their normals (lib/rounded.glsl).
struct Geometry {
  uint position, normal, tangent, uv0, uv1, color;
  uint flags;
};

// One draw item, as culled and drawn.
struct Item {
  vec3 bounds_centre;  // relative space
  uint transform;
  vec3 bounds_extent;  // half sizes; infinite: never culled
  uint geometry;
  uint first_index, index_count;
  uint material;
  uint object_id;  // glTF node index
};

struct TextureRef {
  uint texture;  // bindless index, or absent
  uint sampler_index;
  uint uv_set;
  uint wraps;         // of a relief: wrap_... of u, and of v two bits above; else 0
  vec3 u_row, v_row;  // uv' = (dot(u_row, (uv,1)), dot(v_row, (uv,1)))
};

// Fragment shaders read it in 64-bit words (lib/material.glsl): what is wanted together stands together.
struct Material {
  vec4 base_color;
  vec3 emissive;  // factor * strength
  float alpha_cutoff;
  float metallic, roughness, normal_scale, occlusion_strength;
  float specular;
  float ior_f0;  // ((ior - 1) / (ior + 1))^2
  uint flags;
  uint id;  // glTF material index, absent for the default material
  vec3 specular_color;
  uint relief;  // place of its ReliefRecord among the materials; 0: no relief
  TextureRef base_texture, orm_texture, occlusion_texture, normal_texture, emissive_texture, specular_texture,
      specular_color_texture;
};
// Of a material's relief; it takes the place of a material, behind all of them.
struct ReliefRecord {
  TextureRef heights;
  float depth;         // in the mesh's space
  float depth_before;  // those of the time before (lib/vertex_before.glsl), where anything moves
  vec3 u_row_before, v_row_before;
};

// A punctual light in relative space. Spot factor (KHR_lights_punctual): saturate(spot_offset - e2 * spot_scale)^2,
// where e2 is the squared distance of the two unit vectors, 2 (1 - cos): a narrow cone loses every digit in its
// cosines. Read in 64-bit words, in the order in which lib/light_eval.glsl can tell that a light gives nothing.
struct Light {
  vec3 position;
  float inverse_range;  // 0: no range
  vec3 direction;       // unit, the way the light shines
  uint type;
  float spot_scale, spot_offset;  // of a stand-in the first is the inverse of its inner range (plan/stand_ins.h)
  vec3 intensity;                 // cd or lux, times colour
  uint shadow;       // 1 + its place among the frame's SunShadows, or, with lamp_shadow_bit, LampShadows; 0: no maps
  float radius_m;    // of a point or spot light's sphere, or of a directional light's disc in radians; 0: a point
  float sun_height;  // of a directional light's disc in the sky, for shadows: 1 - cos of its radius; 0: a point
};

// Everything that is the same for all draws of a frame.
struct FrameConstants {
  uint64_t vertices, transforms, geometries, items, materials;
  uint64_t lobes;  // table of shared/lobes.h; only where visible materials have lobes
  mat4 clip_from_relative;
  vec4 planes[5];      // relative space, inside is dot(n, p) + w >= 0
  vec4 ambient_sh[9];  // radiance projected on spherical harmonics, cosine-convolved, divided by pi
  vec3 camera_right, camera_up, camera_back;  // unit axes, relative space
  vec2 tan_half;  // perspective: tangents of the half angles; orthographic: half sizes in metres
  uvec2 size_px;
  uint light_count, item_count;
  uint perspective;
  uint sky_texture, sky_sampler;
  uint split_sum_texture, split_sum_sampler;  // absent without ambient light
  vec2 sky_size_px;
  float pre_exposure;
  LightGrid grid;
  FogMedium fog;
  ImageLight image_light;
  vec2 sky_turn;  // cosine and sine of the sky's rotation about +Y
  float sky_intensity;
  uint sky_background;  // the sky as it is seen: its own image, or that blurred
  ProbeLights probes;
  uint64_t indices, batches;    // only where triangles are rasterized in compute (shared/visibility.h)
  vec4 background;              // premultiplied, pre-exposed
  float least_light_distance2;  // square of the distance within which an inverse square is held (scene/scene_size.h)
  // What added to relative space gives that of the trees for rays (plan/trace_origin.h), as a float and what it leaves.
  vec3 trace_shift, trace_shift_rest;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
enum : uint { geometry_deformed = 1u, geometry_rounded = 2u };
enum : uint {
  material_masked = 1u,
  material_double_sided = 2u,
  material_unlit = 4u,
  material_orm_occlusion = 8u,
  material_orm_metallic_roughness = 16u,
  material_blended = 32u,
  material_blinn_phong = 64u,        // Blinn's lobe instead of facets
  material_exponent_texture = 128u,  // the specular texture's A is of its exponent
  material_relief_ends = 256u,       // the relief ends where the section's texture coordinates do
};
enum : uint { wrap_repeat = 0, wrap_clamp = 1, wrap_mirror = 2 };
enum : uint { light_directional = 0, light_point = 1, light_spot = 2, light_stand_in = 3 };
static_assert(sizeof(Transform) == 48 && sizeof(Place) == 24 && sizeof(Geometry) == 28 && sizeof(Item) == 48 &&
              sizeof(TextureRef) == 40);
static_assert(sizeof(Material) == 80 + 7 * 40 && offsetof(Material, base_texture) == 80);
static_assert(sizeof(ReliefRecord) <= sizeof(Material));
static_assert(sizeof(Light) == 64 && offsetof(Light, direction) == 16 && offsetof(Light, spot_scale) == 32 &&
              offsetof(Light, intensity) == 40);
static_assert(offsetof(FrameConstants, pre_exposure) == 424 && offsetof(FrameConstants, grid) == 432 &&
              offsetof(FrameConstants, fog) == 512 && offsetof(FrameConstants, image_light) == 1440 &&
              offsetof(FrameConstants, probes) == 1512 && offsetof(FrameConstants, indices) == 1912 &&
              sizeof(FrameConstants) == 1976);
}  // namespace candela::shared
#else
const uint geometry_deformed = 1u, geometry_rounded = 2u;
const uint material_masked = 1u, material_double_sided = 2u, material_unlit = 4u, material_orm_occlusion = 8u,
           material_orm_metallic_roughness = 16u, material_blended = 32u, material_blinn_phong = 64u,
           material_exponent_texture = 128u, material_relief_ends = 256u;
const uint wrap_repeat = 0u, wrap_clamp = 1u, wrap_mirror = 2u;
const uint light_directional = 0u, light_point = 1u, light_spot = 2u, light_stand_in = 3u;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer WordsRef { uint w[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer FloatsRef { float f[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TransformsRef { Transform t[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer WorldPlacesRef { Place p[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer GeometriesRef { Geometry g[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ItemsRef { Item i[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MaterialsRef { Material m[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ReliefRecordRef { ReliefRecord r; };
layout(buffer_reference, scalar, buffer_reference_align = 64) readonly buffer LightRef { uint64_t w[8]; };  // a Light
#endif

#endif
