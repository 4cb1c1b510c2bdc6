#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "frame/frame_dumps.h"
#include "frame/frame_lamps.h"
#include "frame/frame_rays.h"
#include "frame/frame_suns.h"
#include "frame/frame_upload.h"
#include "frame/job.h"
#include "frame/job_sky.h"
#include "frame/survey_frame.h"
#include "graph/builder.h"
#include "passes/lights/light_grid.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"
#include "scene/draw_list.h"
#include "scene/environment.h"
#include "scene/geometry_layout.h"
#include "scene/pose.h"
#include "scene/survey.h"
#include "scene/view.h"
#include "shared/trace.h"
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

// The job whose picture has the same bits as this one's unless lists of lights lose something: by the technique
// `reference`, whose pixels the hardware shades as it does most techniques'; or, for a technique with pixels of its
// own, by that one with every light at every pixel.
Job with_every_light(Job job, const std::string& reference);
// Whether a technique shades other points of surfaces than the hardware does (Technique::own_pixels).
bool has_own_pixels(const std::string& technique);

// Tables for `candela list`, --set and the help text.
std::vector<std::string> technique_names();
std::vector<std::string> transparency_names();
std::vector<std::string> pass_names();
std::vector<std::string> layer_names();
std::vector<std::string> tonemap_names();
std::vector<std::string> view_names();
// A line about a technique or a layer; empty for what is none.
std::string_view technique_says(std::string_view name);
std::string_view transparency_says(std::string_view name);
std::string_view layer_says(std::string_view name);
std::vector<std::string> effect_names();
struct KnobRow {
  std::string pass, knob, value_now, unit, range, ladder, trades;  // values of choices by their names
  std::string kind;                                                // what it trades: error, time or look
  std::vector<std::string> walk;    // values that a sweep of errors measures, the exact one last
  std::vector<std::string> beside;  // settings that must stand beside it, or it does nothing
  std::vector<std::string> passes;  // whose work it changes
};
std::vector<KnobRow> knob_rows(const std::string& quality);

}  // namespace candela
