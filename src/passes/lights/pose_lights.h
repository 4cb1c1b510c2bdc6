#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// The frame's lights where instances of a node stand among them (CANDELA_light_instances): position = origin + linear
// translation, direction likewise, intensity by its modulation at the frame's time, all in double, as
// scene/frame_data.cpp has it; rounded once to the floats of shared/scene.h, relative space. Lights that the host has
// posed are copied to their places. The knob moves the work between the host and the device.
struct PoseLights {
  static constexpr std::string_view name = "pose_lights";
  struct Knobs {
    static constexpr std::string_view name = "pose_lights";
    // automatic: a CPU gains nothing by a pass, and lists of lights that the host has posed take it half the time
    // (lights.order); a GPU poses `few` or more, for finding the bounds of fewer takes it longer than the host.
    enum Enabled : int { off, on, automatic };
    int enabled = automatic;
    static constexpr uint32_t few = 2048;
    bool on_device(bool is_cpu, uint32_t instances) const;
    static std::span<const Knob> table();
  };
  Knobs knobs;
  struct In {
    SceneInputs scene;
  };
  struct Out {
    BufferHandle lights;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool on_device = false;  // there are groups of instances
};

}  // namespace candela
