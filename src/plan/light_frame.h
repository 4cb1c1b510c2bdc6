#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "passes/lights/light_grid.h"
#include "plan/frame_lamps.h"
#include "plan/frame_suns.h"
#include "plan/pack_frame.h"
#include "plan/survey_frame.h"
#include "shared/fog.h"

namespace candela {

// The fourth stage of planning: how light reaches surfaces and air. Lists of lights, shadow maps, fog.
struct LitFrame {
  LightGrid light_grid;
  bool shadow_colors = false;  // see-through surfaces are drawn into the views of shadow maps
  FrameSuns suns;
  FrameLamps lamps;
  std::optional<shared::FogMedium> fog;
  Notes notes;
};
// clock: gets the times of its four parts, light_grid, sun_shadows, fog and local_shadows. Errors: those of plan_suns()
// and plan_lamps().
// lit: whatever it held, its memory is used again.
Expected<void> light_frame(const AskedFrame& asked, const SurveyedFrame& frame, const PackedFrame& packed,
                           const PlanContext& context, StageClock& clock, LitFrame& lit);
// Of each node whether it moves by what plays (scene/moving_nodes.h). Errors: those of choose_animations().
Expected<std::vector<uint8_t>> moving_of(const Scene& scene, const std::string& animation);

}  // namespace candela
