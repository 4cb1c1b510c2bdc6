#pragma once
#include "passes/shared/scene_inputs.h"
#include "shared/reflections.h"

namespace candela {

// What reflections found, as what adds them to pictures takes it (shaders/lib/reflections_over.glsl). Not a
// pass.
struct Reflected {
  using MadeBy = std::tuple<ReflectionKnobs>;
  ImageHandle
      light;  // by texel: the light that the lobe meets where it meets the scene; what fraction of the sky's it hides
  ImageHandle z, surface, reflectance, sky;  // shaders/lib/reflections.glsl
  uint32_t texel_px = 1;
};

// A full-screen draw, added to the attachments of `formats`: to the picture; or, with `terms`, what is appended to the
// shader's name, to terms of it. depth: of the frame, at its samples. is_tested: it is the rendering's depth too.
PipelineHandle declare_reflected(GraphBuilder& builder, const SceneInputs& scene, const Reflected& reflected,
                                 ImageHandle depth, const std::vector<VkFormat>& formats, bool is_tested = false,
                                 const std::string& terms = {});
void record_reflected(CommandList& commands, const SceneInputs& scene, const Reflected& reflected, ImageHandle depth,
                      PipelineHandle pipeline);

shared::ReflectedSurfaces surfaces_of(CommandList& commands, const Reflected& reflected);

}  // namespace candela
