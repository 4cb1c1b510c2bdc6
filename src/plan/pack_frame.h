#pragma once
#include "plan/frame_upload.h"
#include "plan/survey_frame.h"
#include "scene/draw_list.h"

namespace candela {

// The third stage of planning: what is drawn, in the order of drawing, and packed as the device reads it.
struct PackedFrame {
  DrawList draws;
  FrameUpload upload;            // without what later stages decide: shadows of lights, light grid, fog
  uint32_t light_instances = 0;  // of the layout that groups of lights are of
  uint32_t mesh_instances = 0;   // likewise of items
  bool traces_keys = false;      // rays find what the camera sees
};
// packed: whatever it held, its memory is used again.
Expected<void> pack_frame(const AskedFrame& asked, const SurveyedFrame& frame, const PlanContext& context,
                          double time_s, PackedFrame& packed);

}  // namespace candela
