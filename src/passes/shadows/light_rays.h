#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct LightRayKnobs {
  static constexpr std::string_view name = "light_rays";
  static constexpr int never = 0, by_device = 1, always = 2;
  int apart = by_device;
  int budget_mb = 256;
  static std::span<const Knob> table();
};

// Rays from the surfaces that a visibility buffer names to the lights whose shadows are traced, before these are
// shaded: what comes along each of them is recorded, and shading reads it. The same rays with the same results as
// shading would send (shaders/lib/traced_light.glsl), but their kernel holds nothing else, and traces with all lanes
// (Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", 2009). Leaves nothing wrong: pixels whose
// records find no room are shaded by rays of their own.
struct LightRays {
  static constexpr std::string_view name = "light_rays";
  using Knobs = LightRayKnobs;
  struct In {
    SceneInputs scene;
    BufferHandle keys;
    BufferHandle deformed;  // optional
    Lighting lists;
  };
  struct Out {
    LightRecords records;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  TracedRays rays;  // of the frame
  bool lists_have_a_cap = false;
  Knobs knobs;
};

}  // namespace candela
