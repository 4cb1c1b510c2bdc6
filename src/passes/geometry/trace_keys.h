#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// The keys of a visibility buffer (passes/geometry/rasterize.h) by a ray of the camera through each sample, for any
// device: the trees and the tests of shaders/lib/trace.glsl, which meet what the reference's rays meet; or the device's
// own trees, by queries or by a pipeline of rays (bvh.traversal; shaders/lib/trace_device.glsl). Holes of masks are
// those of the texture's finest level. Lines and points are not in it. Needs no atomics.
struct TraceKeys {
  static constexpr std::string_view name = "trace_keys";
  using SharedKnobs = std::tuple<BvhKnobs, ReliefKnobs>;
  using InputKnobs = SampleCountKnobs;
  struct In {
    SceneInputs scene;
  };
  struct Out {
    BufferHandle keys;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
