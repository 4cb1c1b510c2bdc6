#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/frame_data.h"
#include "scene/look.h"
#include "scene/scene.h"

namespace candela {

// What the frame holds: enough for passes to say whether they are needed (DESIGN section 4). Every value prints as
// JSON.
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
       any_texture_transform = false, any_specular = false, any_blinn_phong = false;  // over visible materials
  uint32_t lobes = 0, lobe_textures = 0;        // 1 << Lobe: what visible materials show, and what of it has textures
  std::vector<bool> material_used, image_used;  // by visible items: only these are uploaded and decoded
  std::vector<uint32_t> cut_outs;               // scene/cut_outs.h; only `candela facts` asks
};
// refraction: surfaces that let light through are drawn so; else they are opaque ones.
SceneFacts survey(const Scene& scene, const Pose& pose, const FrameData& frame, bool environment,
                  bool refraction = false);
std::string facts_json(const SceneFacts& facts);

// What the job wants of the frame.
struct FrameRequest {
  int width_px = 1280, height_px = 720;
  int samples = 4;            // MSAA: 1 or 4
  bool want_linear = true;    // EXR: linear beauty
  bool want_display = false;  // PNG or video: tone-mapped
  // What is read back is packed as files hold it (passes/post/pack.h); else it is texels.
  bool for_files = false;
  bool exr_float = false;                   // colours are stored in 32 bits
  bool look_nonfinite = false;              // count pixels that are not finite, also of a beauty that is not read back
  bool shows_through = false;               // pictures are transparent where nothing is
  std::optional<uint32_t> behind_rgb = {};  // display output is laid over these sRGB codes there; else it has alpha
  bool sky_hidden = false;                  // the sky lights and is mirrored; behind everything is the background
  bool draw_background = true;
  std::vector<std::string> layers;  // beside beauty: depth, normal, albedo, object_id, material_id, emission, direct
  std::string view = "beauty";      // what display output shows: beauty, a layer, or an image of the frame
  bool view_is_light = true;        // it goes through exposure and tone curve
  bool view_alone = false;          // the layer that it shows is asked for by nothing else
  std::string technique = "clustered";
  std::string transparency = "sorted";  // how blended surfaces come over each other (techniques/technique.h)
  std::string tonemap = "agx";
  float exposure_ev = 0;         // stops; multiplies by 2^ev before tone mapping
  float pre_exposure_ev = 0;     // the part of it that linear pictures inside the frame have already
  int display_bits = 8;          // 8 or 16
  bool dither = true;            // before 8 bits
  uint32_t noise_seed = 0;       // differs from frame to frame
  uint32_t still_seed = 0;       // for noise that stays as it is from frame to frame
  std::string quality = "high";  // draft, normal, high, exact
  std::string effects = "auto";  // auto, none, or names of effects separated by commas
  Look look;                     // of the frame's time
  bool neutral_light = false;    // no light and no sky: light the object so that it is seen
  // Whether an effect is wanted that belongs to the truth of a scene (shadows, occlusion): from quality normal up.
  bool wants_true(std::string_view effect) const {
    return effects == "auto" ? quality != "draft" : names_effect(effect);
  }
  // The same for one that belongs to the look (bloom, fog): where the look has it.
  bool wants_looked(std::string_view effect, bool in_look) const {
    return effects == "auto" ? in_look : names_effect(effect);
  }
  bool display_alpha() const { return shows_through && !behind_rgb && view == "beauty"; }
  bool shown_alone(std::string_view layer) const { return view_alone && layer == view; }
  bool names_effect(std::string_view effect) const;
  bool draws_reflections() const { return wants_looked("ssr", look.reflections.has_value()); }
  // Bloom is wanted, and something that shows it.
  bool draws_bloom() const {
    const bool in_look = look.bloom.has_value(), shown = want_display && view == "beauty";
    return wants_looked("bloom", in_look) &&
           (shown || (in_look && look.bloom->in_beauty && want_linear) || has_layer("bloom"));
  }
  // A term of beauty (passes/surfaces/terms.h) is asked for as a layer, or something is made of it.
  bool wants_term(std::string_view name) const {
    return has_layer(name) || (name == "emission" && look.bloom && look.bloom->of_emission && draws_bloom());
  }
  bool draws_fog() const { return look.fog && wants_looked("fog", true); }
  bool draws_probes() const { return !look.probes.empty() && wants_looked("probes", true); }
  bool draws_volumetric() const { return look.volumetric && wants_looked("volumetric", true); }
  bool has_layer(std::string_view name) const {
    for (const std::string& l : layers)
      if (l == name) return true;
    return false;
  }
};

}  // namespace candela
