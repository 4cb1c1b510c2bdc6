#pragma once
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "graph/builder.h"
#include "job/job.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/relief_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"
#include "plan/frame_dumps.h"
#include "plan/trace_frame.h"
#include "techniques/frame.h"

namespace candela {

// Everything about one frame short of the GPU, as the stages returned it, and the last one's own: the graph. Pure, so
// `candela plan` needs no device.
struct PlannedFrame : SurveyedFrame, PackedFrame, LitFrame, TracedFrame {
  TextureKnobs textures;
  ReliefKnobs relief;
  SurfaceKnobs surfaces;
  IblKnobs image_light;
  ProbeKnobs probes;
  bool stores_samples = true;  // as SceneInputs has it
  CompiledGraph graph;
  // Of the plan without dumps, and as if nothing were kept from other frames: what is the same picture has the same.
  Hash128 hash;
  std::vector<int> imports;  // resource in the plan of each row of the upload table; -1: not in it
  std::vector<FrameReport> reports;
  std::vector<FrameOutput> outputs;
  int counts = -1;  // the buffer of shared::PackCounts in the plan
  std::vector<FrameDump> dumps;
  std::vector<std::string> notes;  // of all stages
  StageClock clock;                // their times; the sum is all of planning
};
// Of a picture of several frames (plan/subframes.h) the one that the context names, else the first of them.
// The chain of the stages: ask_frame, survey_frame, pack_frame, light_frame, trace_frame, and the graph.
Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s);
// The same for one frame alone; reads the job's sky and look.
Expected<PlannedFrame> plan_frame(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s);

}  // namespace candela
