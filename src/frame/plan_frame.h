#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "frame/frame_upload.h"
#include "frame/job.h"
#include "frame/light_grid.h"
#include "graph/builder.h"
#include "passes/surfaces/texture_knobs.h"
#include "scene/draw_list.h"
#include "scene/environment.h"
#include "scene/geometry_layout.h"
#include "scene/pose.h"
#include "scene/survey.h"
#include "scene/view.h"

namespace candela {

// What a readback buffer holds: one image of the frame, tightly packed rows from the top.
struct OutputImage {
  std::string
      layer;  // "beauty" (linear, pre-exposed, premultiplied alpha), "display" (tone-mapped), "depth", "normal", ...
  VkFormat format = VK_FORMAT_UNDEFINED;
  int resource = -1;  // the buffer in the plan
};

// Buffers that the scene upload fills, by the plan's resource number; -1: not in the plan.
struct ImportedResources {
  int constants = -1, vertices = -1, indices = -1, items = -1, transforms = -1, geometries = -1, materials = -1,
      lights = -1, light_bounds = -1, light_chunks = -1, light_globals = -1, cull_groups = -1, deform_jobs = -1,
      joints = -1, weights = -1;
};

// Everything about one frame short of the GPU: pure, so `candela plan` needs no device.
struct PlannedFrame {
  Pose pose;
  View view;
  FrameData data;
  DrawList draws;
  SceneFacts facts;
  FrameRequest request;
  FrameUpload upload;
  LightGrid light_grid;
  TextureKnobs textures;
  CompiledGraph graph;
  ImportedResources imports;
  int light_losses = -1;  // buffer in the plan that tells what the knob lights.cap lost
  std::vector<OutputImage> outputs;
  std::vector<std::string> notes;
  double animate_ms = 0, light_grid_ms = 0, plan_ms = 0;
};
struct WantedOutputs {
  bool linear = true;    // EXR
  bool display = false;  // PNG, video
  int display_bits = 8;  // 8 or 16
};

// What does not change with time, made once for a scene.
struct PlanContext {
  const Scene& scene;
  const GeometryLayout& layout;
  const AmbientSh* environment = nullptr;  // of the sky image, when the job has one
};
Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s);
// The same for one frame alone; reads the job's sky.
Expected<PlannedFrame> plan_frame(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s);

// Tables for `candela list`, --set and the help text.
std::vector<std::string> technique_names();
std::vector<std::string> pass_names();
std::vector<std::string> layer_names();
std::vector<std::string> tonemap_names();
std::vector<std::string> view_names();
struct KnobRow {
  std::string pass, knob, value_now, unit, range, ladder, trades;  // values of choices by their names
  std::string kind;                                                // what it trades: error, time or look
  std::vector<std::string> walk;    // values that a sweep of errors measures, the exact one last
  std::vector<std::string> passes;  // whose work it changes
};
std::vector<KnobRow> knob_rows(const std::string& quality);

}  // namespace candela
