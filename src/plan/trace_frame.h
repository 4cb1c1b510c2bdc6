#pragma once
#include <memory>
#include <string>
#include <vector>

#include "plan/frame_rays.h"
#include "plan/light_frame.h"
#include "shared/trace.h"

namespace candela {

// The fifth stage of planning: trees, where rays are sent, and how shading sends them.
struct TracedFrame {
  std::shared_ptr<const FrameRays> rays;          // null: nothing is traced
  glm::dvec3 shift{0};                            // what added to relative space gives that of the trees
  std::vector<shared::RaySettings> ray_settings;  // one, where shading sends rays or shadows are soft
  TracedRays traced;                              // without handles
  Notes notes;
};
// out: whatever it held, its memory is used again.
void trace_frame(const AskedFrame& asked, const SurveyedFrame& frame, const PackedFrame& packed, const LitFrame& lit,
                 const PlanContext& context, TracedFrame& out);

}  // namespace candela
