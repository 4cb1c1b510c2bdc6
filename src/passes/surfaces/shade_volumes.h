#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/volume_lists.h"
#include "passes/surfaces/gbuffer_images.h"

namespace candela {

struct LightVolumeKnobs {
  static constexpr std::string_view name = "light_volumes";
  enum : int { r11g11b10, half, floats };
  enum : int { unguarded, reached, marked };
  int accumulator = floats;
  int guard = marked;
  int depth_test = 0;
  static std::span<const Knob> table();
};

// Radiance of what a G-buffer holds, light by light: each is drawn as the volume that it reaches
// (passes/lights/light_volumes.h) and adds its part to the pixels in it, shaded by the same functions as ShadeForward;
// then exposed and seen through fog. Units: cd/m2 times the pre-exposure.
// Knob `light_volumes.guard`, of time alone: `reached` reads of a surface that a light does not reach nothing but where
// it is; `marked` also has the stencil, written once, hold at each sample the first of the pixel's that is the same in
// the G-buffer, so that no volume is drawn over other samples or over what is behind all surfaces. Its image is there
// only then. Not with the test of depth, whose image has no stencil: there it is `reached`.
// All lights in their order, into floats, give the bits of the forward techniques. With the test of depth lights that
// reach everywhere, volumes from outside and volumes from inside are drawn one after another, so that sums differ by
// rounding.
struct ShadeVolumes {
  static constexpr std::string_view name = "shade_volumes";
  using Knobs = LightVolumeKnobs;
  using SharedKnobs = GBufferShadingKnobs;
  static constexpr std::array<std::string_view, 2> shading_effects = {"ibl", "probes"};  // image-based light
  struct In {
    SceneInputs scene;
    GBufferImages gbuffer;
    Lighting lists;        // of shadows, occlusion and fog
    LightVolumes volumes;  // optional: no light
    ImageHandle depth;
    BufferHandle deformed;  // optional; of reliefs
  };
  struct Out {
    ImageHandle color;
    ImageHandle sum, tested;  // tested: depth or stencil of the volumes, optional
    PipelineHandle mark, base, over;
    std::vector<PipelineHandle> by_list;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool marks() const { return knobs.guard == Knobs::marked && knobs.depth_test == 0; }
  Knobs knobs;
};

}  // namespace candela
