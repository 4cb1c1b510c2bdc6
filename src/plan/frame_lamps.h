#pragma once
#include <vector>

#include "passes/shadows/lamp_knobs.h"
#include "plan/frame_views.h"
#include "plan/pack_frame.h"
#include "plan/survey_frame.h"
#include "scene/scene.h"
#include "shared/shadows.h"

namespace candela {

// The frame's shadow maps of point and spot lights, the most important light's first.
struct FrameLamps : ShadowMaps {
  std::vector<shared::LampShadow> shadows;
  uint32_t maps = 0;
  std::vector<uint32_t> moving;  // a bit for each node that moves; empty: nothing that casts shadows does
  Reused<LampPool> pool;         // the image outlives the frame, and holds these maps then
  PlacedLamps placed;            // for placing them alone
};

// Chooses the lights that get maps (those that the look marks first) and the maps' sizes, and places these in one
// layered image. rows: of the picture's samples, height times the side of supersampling, which maps follow in size.
// Errors: more draw commands than the knob local.draws has room for.
// out: whatever it held, its memory is used again.
Expected<void> plan_lamps(const Scene& scene, const SurveyedFrame& frame, const PackedFrame& packed,
                          const LampKnobs& knobs, int rows, const MapOptions& options, FrameLamps& out);

}  // namespace candela
