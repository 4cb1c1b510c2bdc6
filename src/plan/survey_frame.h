#pragma once
#include "plan/ask_frame.h"
#include "scene/pose.h"
#include "scene/posed_parts.h"
#include "scene/survey.h"
#include "scene/view.h"

namespace candela {

// The second stage of planning: where everything stands at the frame's time, what lights it, and what is there of which
// kind, which is what passes are chosen by. `candela facts` ends here.
struct SurveyedFrame {
  Pose pose;
  PoseState pose_state;
  View view;
  FrameData data;  // with the neutral light, where there is no other; lights end where the knob lights.floor_lux says
  DevicePose on_device;
  FrameSky sky;
  SceneFacts facts;
  FrameRequest request;  // that of the stage before, with what the scene decides: neutral light, sky, layers
  std::vector<uint32_t> light_group_of;  // of each light its place among request.light_groups; empty without groups
  std::vector<std::string> notes;
  uint64_t posed_at_allocations = 0;  // heap_allocations() when everything was posed
};
Expected<void> survey_frame(const AskedFrame& asked, const PlanContext& context, double time_s, SurveyedFrame& frame);

// Both stages for one frame alone; reads the job's sky and look. Warnings are logged.
Expected<SurveyedFrame> survey_frame(const Job& job, const Scene& scene, double time_s);

}  // namespace candela
