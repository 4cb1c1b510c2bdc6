#pragma once
#include <string>
#include <vector>

#include "graph/pipeline_desc.h"
#include "scene/survey.h"

namespace candela {

// Ids of shaders/lib/features.glsl.
enum class Feature : uint32_t {
  base_texture,
  orm_texture,
  occlusion_texture,
  normal_texture,
  emissive_texture,
  specular_texture,
  vertex_color,
  uv1,
  texture_transform,
  lights,
  ambient,
  is_masked,
  is_unlit,
  textures,
  subsample,
  sun_shadows,
  occlusion,
  ibl_method,
  sky_irradiance,
  lamp_shadows,
  ray_stack,
  rays_meet_blended,
  probe_count,
  lobes,
  lobe_textures,
  emission,
  blinn_phong,
  specular_aa,
  ray_query,  // of no shader: what asks the device is compiled apart (surface_definitions)
  light_voxels,
  relief = 34,   // 30 to 33 are the rasterizer's
  rounded = 35,  // of no shader, as ray_query
};

// The scene-wide constants. Absent features are not listed: the shader's default is 0.
std::vector<SpecConstant> scene_features(const SceneFacts& facts, bool ambient);
// What the surfaces of a frame with image-based light need besides (passes/surfaces/ibl_knobs.h).
// mirror_taps: of smooth surfaces; 0 without.
std::vector<SpecConstant> image_light_constants(int method, bool irradiance_map, int mirror_taps);
// Of a frame with that many reflection probes, at least one.
SpecConstant probes_constant(uint32_t count);
// Scene-wide constants for a picture that is one of a supersampled frame's.
std::vector<SpecConstant> with_subsample(std::vector<SpecConstant> features);
// Of a frame whose surfaces are as rough as their normals stray in a pixel (passes/surfaces/surface_knobs.h): 1 or
// more.
SpecConstant specular_aa_constant(int method);
// Of a frame with reliefs (passes/surfaces/relief_knobs.h).
SpecConstant relief_constant(int steps, int refinements, int light_steps, bool by_sample);
void leave_out_reliefs(std::vector<SpecConstant>& constants);  // of a pass that meets none
bool meets_reliefs(const std::vector<SpecConstant>& constants);
bool has_reliefs_of_samples(const std::vector<SpecConstant>& constants);  // relief.by_sample
bool marches_to_lights(const std::vector<SpecConstant>& constants);       // in reliefs (relief.light_steps)
// Of a pass that shades under lights with shadow maps.
SpecConstant sun_shadows_constant(bool traced, bool soft);
SpecConstant lamp_shadows_constant(bool traced, bool soft);
// Of a pass that reads ambient occlusion's texels, of that shape (shared/occlusion.h), or traces it.
SpecConstant occlusion_constant(uint32_t shape, bool traced);
// Something lets a part of the light along rays through.
SpecConstant rays_meet_blended_constant();
// Of a pass that traces light: entries of a ray's stack, whether something lets a part of the light through, and
// whether the device is asked what rays meet (bvh.traversal=query).
std::vector<SpecConstant> ray_constants(uint32_t stack, bool blended, bool by_query);
bool sends_rays(const std::vector<SpecConstant>& constants);          // those are among them
bool mirrors_sky(const std::vector<SpecConstant>& constants);         // smooth surfaces, by what pixels show of it
bool shades_lobes(const std::vector<SpecConstant>& constants);        // visible materials have lobes (shared/lobes.h)
bool rounds_off(const std::vector<SpecConstant>& constants);          // shadows or openness of rounded polygons
bool scatters_in_bodies(const std::vector<SpecConstant>& constants);  // one of them does (lib/scattering.glsl)
// Those that a surface's base colour depends on.
std::vector<SpecConstant> base_color_constants(const std::vector<SpecConstant>& features);
// Of a pass that asks cells which lights are seen from them (passes/shadows/light_voxels.h).
SpecConstant light_voxels_constant(bool suns, bool lamps, bool halve);
// What is compiled into a shading shader only where the constants need it, behind its name.
std::string surface_definitions(const std::vector<SpecConstant>& constants);
// The constants of one run's pipeline: those its shaders read. A depth-only pipeline without fragment shader needs
// none, an unlit or masked depth one only what the base colour takes.
std::vector<SpecConstant> run_constants(const std::vector<SpecConstant>& scene, const GraphicsPipelineDesc& desc,
                                        bool masked, bool unlit);

}  // namespace candela
