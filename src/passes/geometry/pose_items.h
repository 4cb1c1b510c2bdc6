#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// The frame's items where instances of a node stand among them (EXT_mesh_gpu_instancing): transforms, boxes and the
// batches of triangles that compute rasterizes. Matrices and boxes are in double, as scene/frame_data.cpp and
// scene/deformation_bounds.cpp have them, and rounded once to the floats of shared/scene.h, relative space. What the
// host has posed is copied to its places in the order of drawing. The knob moves the work between the host and the
// device.
struct PoseItems {
  static constexpr std::string_view name = "pose_items";
  struct Knobs {
    static constexpr std::string_view name = "pose_items";
    int enabled = 1;
    static std::span<const Knob> table();
  };
  Knobs knobs;
  struct In {
    SceneInputs scene;
  };
  struct Out {
    BufferHandle transforms, items, batches, places;
    PipelineHandle pose_transforms, pose_items, pose_batches;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool on_device = false;  // there are groups of instances, or a pass changes items
};

}  // namespace candela
