#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "graph/kept.h"
#include "job/choose_occlusion.h"
#include "job/frame_choices.h"
#include "job/frame_knobs.h"
#include "job/job.h"
#include "job/job_look.h"
#include "job/wanted_outputs.h"
#include "plan/frame_dumps.h"
#include "plan/frame_rays.h"
#include "plan/lamp_pool.h"
#include "plan/subframes.h"
#include "scene/geometry_layout.h"
#include "scene/posed_parts.h"
#include "sky/job_sky.h"
#include "techniques/technique.h"

namespace candela {

class KeptGraphs;  // plan/planned_graph.h

// What does not change with time, made once for a scene.
struct PlanContext {
  const Scene& scene;
  const GeometryLayout& layout;
  const JobSky* sky = nullptr;            // the job's, as the session read it; without one there is no sky
  const LookFile* look = nullptr;         // the job's, as the session read it; without one plan_frame reads the file
  const Look* look_now = nullptr;         // of the frame's time, where the caller has it
  bool is_whole = false;                  // the picture is one frame, as the caller found by subframes_of()
  KeptGraphs* graphs = nullptr;           // of earlier frames; null: the graph is made anew
  const KeptKeys* kept = nullptr;         // what earlier frames left; null: nothing is kept
  const KeptLamps* kept_lamps = nullptr;  // likewise, of maps of point and spot lights
  std::span<const uint8_t> moving = {};   // as moving_of() gives it, for the job's animation; empty: it is found anew
  const PosedParts* parts = nullptr;      // likewise, of what it drives; null: they are found anew
  const ChosenOcclusion* occlusion = nullptr;  // likewise, what it leaves to occlusion.method=auto
  const View* face = nullptr;          // of a reflection probe's image, which takes the place of the job's camera
  const Subframe* subframe = nullptr;  // what the frame is of a picture with shutter or lens; null: all of it
  DevicePose on_device = {};           // instances that the device can pose
  std::shared_ptr<const FrameRays> rays = {};  // of an earlier frame; taken where the key is this one's
  // The device runs shaders on a CPU, by subgroups of eight or more: without a device as the one here by default.
  bool cpu = true;
  bool stores_samples = true;  // the device has multisampled storage images of the job's samples
};

// The first stage of planning: what is asked of a frame, by the job, its look and the time alone.
struct AskedFrame {
  Job job;  // without auto
  KnobValues knobs;
  const Technique* technique = nullptr;
  FrameRequest request;
  std::vector<std::string> notes;
  std::string occlusion_note;  // how occlusion.method=auto was chosen; for frames that have any
};
Expected<AskedFrame> ask_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted, double time_s);

}  // namespace candela
