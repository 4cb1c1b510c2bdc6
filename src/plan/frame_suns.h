#pragma once
#include <algorithm>
#include <bit>
#include <string_view>
#include <vector>

#include "passes/shadows/sun_knobs.h"
#include "plan/frame_views.h"
#include "plan/pack_frame.h"
#include "plan/survey_frame.h"
#include "shared/shadows.h"

namespace candela {

// The frame's shadow maps of directional lights, the brightest light's first.
struct FrameSuns : ShadowMaps {
  std::vector<shared::SunShadow> shadows;
};

// Of a map's side in texels, a bound by the picture's longer side: 64 texels a pixel, as a power of two; half of it for
// the maps of point and spot lights, whose default side is half too. What is finer is
// not seen. At quality exact there is none.
inline uint32_t most_map_px(int longer_side_px, std::string_view quality) {
  return quality == "exact" ? 1u << 30 : std::bit_ceil(64u * uint32_t(std::max(longer_side_px, 1)));
}

// Chooses the lights that get maps and fits their cascades. Errors: more draw commands than the knob sun.draws has room
// for.
// out: whatever it held, its memory is used again.
Expected<void> plan_suns(const Scene& scene, const SurveyedFrame& frame, const PackedFrame& packed,
                         const SunKnobs& knobs, const MapOptions& options, FrameSuns& out);

}  // namespace candela
