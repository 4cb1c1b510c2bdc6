#pragma once
#include <algorithm>
#include <bit>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "passes/geometry/views.h"
#include "passes/shadows/sun_knobs.h"
#include "plan/frame_upload.h"
#include "plan/frame_views.h"
#include "scene/survey.h"
#include "shared/shadows.h"

namespace candela {

// The frame's shadow maps of directional lights, decided before the graph is built.
struct FrameSuns {
  bool traced = false;                     // shading sends rays; maps, where there are any, are for fog
  bool by_voxels = false;                  // where cells of the view do not know what these find
  std::string absence;                     // why there are none; empty: there are
  std::vector<shared::SunShadow> shadows;  // the brightest light's first
  FrameViews views;
  std::shared_ptr<const ViewImage> image;  // null: none
  std::vector<std::string> notes;
};

// Of a map's side in texels, a bound by the picture's longer side: 64 texels a pixel, as a power of two; half of it for
// the maps of point and spot lights, whose default side is half too. What is finer is
// not seen. At quality exact there is none.
inline uint32_t most_map_px(int longer_side_px, std::string_view quality) {
  return quality == "exact" ? 1u << 30 : std::bit_ceil(64u * uint32_t(std::max(longer_side_px, 1)));
}

// Chooses the lights that get maps, fits their cascades, and tells the uploaded lights which is whose. longer_side: of
// the picture, in pixels. Errors: more
// draw commands than the knob sun.draws has room for.
Expected<FrameSuns> plan_suns(const Scene& scene, const FrameData& data, const View& view, const DrawList& draws,
                              const SceneFacts& facts, const FrameRequest& request, const SunKnobs& knobs,
                              int longer_side, bool culling, bool see_through, FrameUpload& upload);

}  // namespace candela
