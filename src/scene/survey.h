#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/frame_data.h"
#include "scene/scene.h"

namespace candela {

// What the frame holds: enough for passes to say whether they are needed. Every value prints as
// JSON.
// Surfaces below it mirror a sky image sharply: the roughness of the first of its maps that lacks bright spots.
inline constexpr float smooth_roughness = 0.0992f;

struct SceneFacts {
  uint32_t draw_items = 0, opaque_items = 0, mask_items = 0, blend_items = 0;
  uint32_t lit_items = 0, unlit_items = 0;  // of opaque and mask
  uint32_t blend_lit_items = 0, blend_unlit_items = 0;
  uint32_t refracting_items =
      0;  // where refraction is drawn: lit, let light through, and are not among the opaque ones
  uint32_t refracting_bodies = 0;  // of these, those that bend light: with a thickness
  bool takes_light() const { return lit_items + blend_lit_items + refracting_items > 0; }
  uint32_t deformed_items = 0, skinned_items = 0, morphed_items = 0;
  uint32_t deformed_vertices = 0;
  uint32_t metaball_chunks = 0;                   // items that have room for metaballs' polygons
  uint32_t triangles = 0, lines = 0, points = 0;  // drawn, instances counted each time
  uint32_t point_lights = 0, spot_lights = 0, directional_lights = 0;
  uint32_t sized_lights = 0;  // point and spot lights with a radius
  uint32_t lights() const { return point_lights + spot_lights + directional_lights; }
  bool emissive = false;     // a visible material emits
  bool environment = false;  // a sky image is given
  bool image_light = false;  // surfaces reflect it, not only its spherical harmonics
  uint32_t probes = 0;       // reflection probes that surfaces reflect
  bool perspective = true;
  bool any_normal_texture = false, any_base_texture = false, any_orm_texture = false, any_occlusion_texture = false,
       any_emissive_texture = false, any_specular_texture = false, any_vertex_color = false, any_uv1 = false,
       any_texture_transform = false, any_specular = false, any_blinn_phong = false,
       any_relief = false;                      // over visible materials
  bool any_smooth = false;                      // of a roughness at which the sky is mirrored sharply
  uint32_t lobes = 0, lobe_textures = 0;        // 1 << Lobe: what visible materials show, and what of it has textures
  std::vector<bool> material_used, image_used;  // by visible items: only these are uploaded and decoded
  std::vector<uint32_t> cut_outs;               // scene/cut_outs.h; only `candela facts` asks
  bool operator==(const SceneFacts&) const = default;
};
// refraction: surfaces that let light through are drawn so; else they are opaque ones.
SceneFacts survey(const Scene& scene, const Pose& pose, const FrameData& frame, bool environment,
                  bool refraction = false);
std::string facts_json(const SceneFacts& facts);

}  // namespace candela
