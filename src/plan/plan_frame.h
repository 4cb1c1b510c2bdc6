#pragma once
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "base/reused.h"
#include "graph/builder.h"
#include "job/job.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/relief_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"
#include "plan/planned_graph.h"
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
  bool stores_samples = true;                // as SceneInputs has it
  std::optional<Hash128> sun_key, lamp_key;  // as SceneInputs has them
  std::vector<UploadRow> rows;               // what is uploaded (plan/upload_table.h)
  std::shared_ptr<PlannedGraph> made;        // the graph, which other frames may share
  const CompiledGraph& graph() const { return made->graph; }
  Notes notes;       // of all stages
  StageClock clock;  // their times; the sum is all of planning
};
// Of a picture of several frames (plan/subframes.h) the one that the context names, else the first of them.
// The chain of the stages: ask_frame, survey_frame, pack_frame, light_frame, trace_frame, and the graph.
// `planned` is filled in, whatever frame it held: memory that it has is used again.
Expected<void> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted, double time_s,
                          PlannedFrame& planned);
Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s);
// The same for one frame alone; reads the job's sky and look.
Expected<PlannedFrame> plan_frame(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s);

}  // namespace candela
