#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "graph/builder.h"
#include "job/job.h"
#include "passes/lights/light_grid.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"
#include "plan/frame_dumps.h"
#include "plan/frame_lamps.h"
#include "plan/frame_rays.h"
#include "plan/frame_suns.h"
#include "plan/frame_upload.h"
#include "plan/survey_frame.h"
#include "scene/draw_list.h"
#include "scene/environment.h"
#include "scene/geometry_layout.h"
#include "scene/pose.h"
#include "scene/survey.h"
#include "scene/view.h"
#include "shared/trace.h"
#include "sky/job_sky.h"
#include "techniques/frame.h"

namespace candela {

using OutputImage = FrameOutput;

// Everything about one frame short of the GPU: pure, so `candela plan` needs no device.
struct PlannedFrame {
  Pose pose;
  View view;
  FrameData data;
  DrawList draws;
  SceneFacts facts;
  FrameRequest request;
  FrameUpload upload;
  uint32_t light_instances = 0;  // of the layout that groups of lights are of
  uint32_t mesh_instances = 0;   // likewise of items
  LightGrid light_grid;
  bool shadow_colors = false;  // see-through surfaces are drawn into the views of shadow maps
  FrameSuns suns;
  FrameLamps lamps;
  std::shared_ptr<const FrameRays> rays;          // null: nothing is traced
  std::vector<shared::RaySettings> ray_settings;  // one, where shading sends rays or shadows are soft
  TracedRays traced;                              // without handles
  bool stores_samples = true;                     // as SceneInputs has it
  TextureKnobs textures;
  SurfaceKnobs surfaces;
  IblKnobs image_light;
  ProbeKnobs probes;
  FrameSky sky;
  CompiledGraph graph;
  // Of the plan without dumps, and as if nothing were kept from other frames: what is the same picture has the same.
  Hash128 hash;
  std::vector<int> imports;  // resource in the plan of each row of the upload table; -1: not in it
  std::vector<FrameReport> reports;
  std::vector<OutputImage> outputs;
  int counts = -1;  // the buffer of shared::PackCounts in the plan
  std::vector<FrameDump> dumps;
  std::vector<KeptUse> kept;  // images of the plan that outlive it
  std::vector<std::string> notes;
  StageClock clock;  // the stages of planning; their sum is all of it
};
Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s);
// The same for one frame alone; reads the job's sky and look.
Expected<PlannedFrame> plan_frame(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s);

}  // namespace candela
