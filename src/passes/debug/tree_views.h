#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// What the ray of the camera through each pixel's middle costs in the trees (shaders/lib/trace.glsl) until it has met
// an opaque or masked surface, or none: 0.25 for each node that it enters, 1 for each triangle that it is tested
// against, as `candela reference` counts (and the notes of T. Le's thesis renderer do). A ray that has met a back that
// is not drawn, or a blended surface, begins anew behind it, as those of TraceKeys do. For looking, not for frames that
// are timed.
struct TraversalHeat {
  static constexpr std::string_view name = "traversal_heat";
  using SharedKnobs = std::tuple<BvhKnobs>;
  static constexpr LayerName layers[1] = {
      {"heatmap_traversal", "what the camera's ray costs: 0.25 a node of the trees, 1 a triangle", LayerForm::count}};
  struct In {
    SceneInputs scene;
  };
  struct Out {
    ImageHandle cost;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

// The boxes of those trees as lines over black, nothing hiding them: leaves in orange over inner nodes in blue. The
// root of each tree counts as an inner node, and so do leaves of instances, whose trees are drawn where each instance
// has them, as boxes of its own space.
struct TreeBoxes {
  static constexpr std::string_view name = "tree_boxes";
  using SharedKnobs = std::tuple<BvhKnobs>;
  static constexpr LayerName layers[1] = {
      {"debug_bvh", "boxes of the trees for rays: leaves orange, inner nodes blue", LayerForm::color}};
  struct In {
    SceneInputs scene;
  };
  struct Out {
    ImageHandle lines;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

// Whether the frame's trees are to be looked at.
bool shows_trees(const FrameRequest& request);

}  // namespace candela
