#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "graph/builder.h"
#include "render/job.h"
#include "scene/pose.h"
#include "scene/survey.h"
#include "scene/view.h"

namespace candela {

// What a readback buffer holds: one image of the frame, tightly packed rows from the top.
struct OutputImage {
  std::string layer;       // "beauty" (linear, pre-exposed, premultiplied alpha), "display" (tone-mapped), "depth", "normal", ...
  VkFormat format = VK_FORMAT_UNDEFINED;
  int resource = -1;       // the buffer in the plan
};

// Everything about one frame short of the GPU: pure, so `candela plan` needs no device.
struct PlannedFrame {
  Pose pose;
  View view;
  FrameData data;
  SceneFacts facts;
  FrameRequest request;
  CompiledGraph graph;
  std::vector<OutputImage> outputs;
  std::vector<std::string> notes;
};
struct WantedOutputs {
  bool linear = true;      // EXR
  bool display = false;    // PNG, video
  int display_bits = 8;    // 8 or 16
};
Expected<PlannedFrame> plan_frame(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s);

// Tables for `candela list`, --set and the help text.
std::vector<std::string> technique_names();
std::vector<std::string> pass_names();
std::vector<std::string> layer_names();
std::vector<std::string> tonemap_names();
struct KnobRow { std::string pass, knob, value_now, unit, range, ladder, trades; };
std::vector<KnobRow> knob_rows(const std::string& quality);

}  // namespace candela
