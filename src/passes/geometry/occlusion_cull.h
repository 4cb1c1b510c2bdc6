#pragma once
#include "passes/geometry/occlusion_cull_knobs.h"
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Occlusion culling in two phases (Haar and Aaltonen, "GPU-Driven Rendering Pipelines", 2015) without history, so that
// a frame takes the same time however it is reached: the depth of the items whose boxes cover most of the picture is
// drawn first, a pyramid of farthest depths is made of it (passes/geometry/depth_pyramid.h), and all other items are
// tested against that. Only depth is drawn in two phases; surfaces are drawn once, in their order, of what is visible.
//
// Nothing is approximated: boxes are those of frustum culling, those that reach the near plane are kept, rounding never
// hides, and a hidden item has no sample at which the depth test passes. Lines, points and what lets light through are
// neither tested nor occluders. Leaves wrong: nothing; items that the first phase's depth does not hide are drawn.

// First phase: of the items in view, those that are drawn first.
struct Occluders {
  static constexpr std::string_view name = "occluders";
  using Knobs = OcclusionCullKnobs;
  using InputKnobs = std::tuple<CullKnobs>;
  struct In {
    SceneInputs scene;
    BufferHandle kept;  // masks of culling by the camera's planes
  };
  struct Out {
    BufferHandle masks, survivors;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest&) const { return needs_occlusion_culling(facts, knobs); }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

// Second phase: of the items in view, those that are visible, and of these the ones that are not drawn yet.
struct OcclusionCull {
  static constexpr std::string_view name = "occlusion_cull";
  using Knobs = OcclusionCullKnobs;
  using Report = shared::OcclusionReport;
  using InputKnobs = std::tuple<CullKnobs>;
  struct In {
    SceneInputs scene;
    BufferHandle kept, occluders;  // masks
    ImageHandle pyramid;
    bool reports = false;
  };
  struct Out {
    BufferHandle visible, visible_survivors, rest, rest_survivors;
    BufferHandle report;  // empty where it is not read
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest&) const { return needs_occlusion_culling(facts, knobs); }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  std::vector<std::string> warnings(const Report&) const { return {}; }
  std::vector<std::string> notes(const Report& report) const;
  Knobs knobs;
};

}  // namespace candela
