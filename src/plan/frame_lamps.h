#pragma once
#include <memory>
#include <string>
#include <vector>

#include "passes/geometry/views.h"
#include "passes/shadows/lamp_knobs.h"
#include "plan/frame_upload.h"
#include "plan/frame_views.h"
#include "scene/scene.h"
#include "scene/survey.h"
#include "shared/shadows.h"

namespace candela {

// The frame's shadow maps of point and spot lights, decided before the graph is built.
struct FrameLamps {
  bool traced = false;                      // shading sends rays; maps, where there are any, are for fog
  bool by_voxels = false;                   // where cells of the view do not know what these find
  std::string absence;                      // why there are none; empty: there are
  std::vector<shared::LampShadow> shadows;  // the most important light's first
  FrameViews views;
  std::shared_ptr<const ViewImage> image;  // null: none
  std::vector<std::string> notes;
};

// Chooses the lights that get maps (those that the look marks first) and the maps' sizes, places these in one layered
// image, and tells the uploaded lights which is whose. rows: of the picture's samples, height times the side of
// supersampling, which maps follow in size; longer_side: of the picture, in pixels. Errors: more draw commands than
// the knob shadows.draws has room for.
Expected<FrameLamps> plan_lamps(const Scene& scene, const FrameData& data, const View& view, const DrawList& draws,
                                const SceneFacts& facts, const FrameRequest& request, const LampKnobs& knobs, int rows,
                                int longer_side, bool culling, bool see_through, FrameUpload& upload);

}  // namespace candela
