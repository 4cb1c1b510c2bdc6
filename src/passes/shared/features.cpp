#include "passes/shared/features.h"

#include <algorithm>

#include "shared/lobes.h"
#include "shared/occlusion.h"

namespace candela {
namespace {
SpecConstant constant(Feature f, uint32_t value = 1) {
  static const char* const names[] = {"HAS_BASE_TEXTURE",
                                      "HAS_ORM_TEXTURE",
                                      "HAS_OCCLUSION_TEXTURE",
                                      "HAS_NORMAL_TEXTURE",
                                      "HAS_EMISSIVE_TEXTURE",
                                      "HAS_SPECULAR_TEXTURE",
                                      "HAS_VERTEX_COLOR",
                                      "HAS_UV1",
                                      "HAS_TEXTURE_TRANSFORM",
                                      "HAS_LIGHTS",
                                      "HAS_AMBIENT",
                                      "IS_MASKED",
                                      "IS_UNLIT",
                                      "HAS_TEXTURES",
                                      "IS_SUBSAMPLE",
                                      "HAS_SUN_SHADOWS",
                                      "HAS_OCCLUSION",
                                      "IBL_METHOD",
                                      "HAS_SKY_IRRADIANCE",
                                      "HAS_LAMP_SHADOWS",
                                      "RAY_STACK",
                                      "RAYS_MEET_BLENDED",
                                      "PROBE_COUNT",
                                      "LOBES",
                                      "LOBE_TEXTURES",
                                      "HAS_EMISSION",
                                      "BLINN_PHONG",
                                      "SPECULAR_AA",
                                      "RAY_QUERY",
                                      "LIGHT_VOXELS"};
  return {uint32_t(f),
          f == Feature::relief    ? "RELIEF_SEARCH"
          : f == Feature::rounded ? "ROUNDED"
                                  : names[uint32_t(f)],
          value};
}
bool concerns_base_color(const SpecConstant& c) {
  switch (Feature(c.id)) {
    case Feature::base_texture:
    case Feature::vertex_color:
    case Feature::uv1:
    case Feature::texture_transform:
    case Feature::textures:
    case Feature::subsample:
    case Feature::relief:
      return true;
    default:
      return false;
  }
}
// Puts out a surface's light, or stores it (passes/transparency/fragments.h).
bool shades(const GraphicsPipelineDesc& desc) {
  return !desc.color_formats.empty() || desc.fragment_shader.find("#STORED=") != std::string::npos;
}
}  // namespace

std::vector<SpecConstant> scene_features(const SceneFacts& facts, bool ambient) {
  std::vector<SpecConstant> list;
  const auto add = [&](bool present, Feature f) {
    if (present) list.push_back(constant(f));
  };
  add(facts.any_base_texture, Feature::base_texture);
  add(facts.any_orm_texture, Feature::orm_texture);
  add(facts.any_occlusion_texture, Feature::occlusion_texture);
  add(facts.any_normal_texture, Feature::normal_texture);
  add(facts.any_emissive_texture, Feature::emissive_texture);
  add(facts.any_specular_texture, Feature::specular_texture);
  add(facts.any_vertex_color, Feature::vertex_color);
  add(facts.any_uv1, Feature::uv1);
  add(facts.any_texture_transform, Feature::texture_transform);
  add(facts.lights() > 0, Feature::lights);
  add(ambient, Feature::ambient);
  add(facts.emissive, Feature::emission);
  add(facts.any_blinn_phong, Feature::blinn_phong);
  add(facts.metaball_chunks > 0, Feature::rounded);
  add(facts.any_base_texture || facts.any_orm_texture || facts.any_occlusion_texture || facts.any_normal_texture ||
          facts.any_emissive_texture || facts.any_specular_texture || facts.any_relief || facts.lobe_textures != 0,
      Feature::textures);
  const uint32_t lobes = facts.lobes & shared::shaded_lobes, textured = facts.lobe_textures & shared::shaded_lobes;
  if (lobes != 0) list.push_back(constant(Feature::lobes, lobes));
  if (textured != 0) list.push_back(constant(Feature::lobe_textures, textured));
  return list;
}

SpecConstant sun_shadows_constant(bool traced, bool soft) {
  return constant(Feature::sun_shadows, (traced ? 2u : 1u) + (soft ? 4u : 0u));
}
SpecConstant lamp_shadows_constant(bool traced, bool soft) {
  return constant(Feature::lamp_shadows, (traced ? 2u : 1u) + (soft ? 4u : 0u));
}

SpecConstant occlusion_constant(uint32_t shape, bool traced) {
  const bool bent = OCCLUSION_BENT(shape) != 0;
  return constant(Feature::occlusion, traced ? (bent ? ~1u : ~0u) : shape);
}

SpecConstant light_voxels_constant(bool suns, bool lamps, bool halve) {
  return constant(Feature::light_voxels, (suns ? 1u : 0u) + (lamps ? 2u : 0u) + (halve ? 4u : 0u));
}

SpecConstant rays_meet_blended_constant() { return constant(Feature::rays_meet_blended); }
std::vector<SpecConstant> ray_constants(uint32_t stack, bool blended, bool by_query) {
  std::vector<SpecConstant> list = {constant(Feature::ray_stack, stack)};
  if (blended) list.push_back(rays_meet_blended_constant());
  if (by_query) list.push_back(constant(Feature::ray_query));
  return list;
}

namespace {
bool holds(const std::vector<SpecConstant>& constants, Feature f) {
  return std::any_of(constants.begin(), constants.end(), [&](const SpecConstant& c) { return Feature(c.id) == f; });
}
}  // namespace

void leave_out_reliefs(std::vector<SpecConstant>& constants) {
  std::erase_if(constants, [](const SpecConstant& c) { return Feature(c.id) == Feature::relief; });
}
bool meets_reliefs(const std::vector<SpecConstant>& constants) { return holds(constants, Feature::relief); }
bool has_reliefs_of_samples(const std::vector<SpecConstant>& constants) {
  return std::ranges::any_of(constants, [](const SpecConstant& c) {
    return Feature(c.id) == Feature::relief && (c.value >> 27 & 1) != 0;  // as relief_constant()
  });
}
bool marches_to_lights(const std::vector<SpecConstant>& constants) {
  return std::ranges::any_of(constants, [](const SpecConstant& c) {
    return Feature(c.id) == Feature::relief && (c.value >> 11 & 0x7ff) != 0;  // as relief_constant()
  });
}
bool sends_rays(const std::vector<SpecConstant>& constants) { return holds(constants, Feature::ray_stack); }
bool mirrors_sky(const std::vector<SpecConstant>& constants) {
  return std::any_of(constants.begin(), constants.end(),
                     [](const SpecConstant& c) { return Feature(c.id) == Feature::ibl_method && c.value >> 8 != 0; });
}
bool shades_lobes(const std::vector<SpecConstant>& constants) { return holds(constants, Feature::lobes); }
bool rounds_off(const std::vector<SpecConstant>& constants) {
  return holds(constants, Feature::rounded) &&
         (holds(constants, Feature::sun_shadows) || holds(constants, Feature::lamp_shadows) ||
          holds(constants, Feature::occlusion));
}
bool scatters_in_bodies(const std::vector<SpecConstant>& constants) {
  return std::any_of(constants.begin(), constants.end(), [](const SpecConstant& c) {
    return Feature(c.id) == Feature::lobes && (c.value & shared::lobe_scattering) != 0;
  });
}

std::vector<SpecConstant> base_color_constants(const std::vector<SpecConstant>& features) {
  std::vector<SpecConstant> list;
  std::copy_if(features.begin(), features.end(), std::back_inserter(list), concerns_base_color);
  return list;
}
std::string surface_definitions(const std::vector<SpecConstant>& constants) {
  return std::string(sends_rays(constants) ? "#TRACES=1" : "") +
         (holds(constants, Feature::ray_query) ? "#TRACE_QUERY=1" : "") +
         (holds(constants, Feature::light_voxels) ? "#VOXELS=1" : "") + (shades_lobes(constants) ? "#LOBED=1" : "") +
         (scatters_in_bodies(constants) ? "#SCATTERS=1" : "") + (meets_reliefs(constants) ? "#RELIEFS=1" : "") +
         (rounds_off(constants) ? "#ROUNDED=1" : "");
}

std::vector<SpecConstant> image_light_constants(int method, bool irradiance_map, int mirror_taps) {
  std::vector<SpecConstant> list = {constant(Feature::ibl_method)};
  list.front().value = uint32_t(method + 1) | uint32_t(mirror_taps) << 8;
  if (irradiance_map) list.push_back(constant(Feature::sky_irradiance));
  return list;
}

SpecConstant relief_constant(int steps, int refinements, int light_steps, bool by_sample) {
  return constant(Feature::relief, 1u << 31 | uint32_t(by_sample) << 27 | uint32_t(refinements) << 22 |
                                       uint32_t(light_steps + 1) << 11 | uint32_t(steps));
}

SpecConstant specular_aa_constant(int method) { return constant(Feature::specular_aa, uint32_t(method)); }

SpecConstant probes_constant(uint32_t count) { return constant(Feature::probe_count, count); }

std::vector<SpecConstant> with_subsample(std::vector<SpecConstant> features) {
  features.push_back(constant(Feature::subsample));
  return features;
}

std::vector<SpecConstant> run_constants(const std::vector<SpecConstant>& scene, const GraphicsPipelineDesc& desc,
                                        bool masked, bool unlit) {
  if (desc.fragment_shader.empty()) {
    // The vertex shader alone: it only places.
    for (const SpecConstant& c : scene)
      if (Feature(c.id) == Feature::subsample) return {c};
    return {};
  }
  const bool base_only = unlit || !shades(desc);
  std::vector<SpecConstant> list = desc.constants;
  for (const SpecConstant& c : scene)
    if (!base_only || concerns_base_color(c)) list.push_back(c);
  if (masked) list.push_back(constant(Feature::is_masked));
  if (unlit && shades(desc)) list.push_back(constant(Feature::is_unlit));
  return list;
}

}  // namespace candela
