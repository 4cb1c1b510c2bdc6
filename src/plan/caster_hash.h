#pragma once
#include <optional>
#include <span>

#include "base/hash.h"
#include "passes/shared/views.h"
#include "passes/surfaces/texture_knobs.h"
#include "plan/frame_upload.h"
#include "scene/pose.h"

namespace candela {

// A hash of everything that decides the depth of what casts shadows, whatever the view: items with their transforms and
// geometry, and of masked ones the mask. Nothing when something that casts is deformed: that changes from frame to
// frame. What neither casts nor masks (blended surfaces, colours) is not in it. Transforms are relative to the camera,
// so a camera that moves changes it.
std::optional<Hash128> caster_hash(const DrawList& draws, const FrameUpload& upload, const Pose& pose,
                                   const TextureKnobs& textures);

// The key of the image that these views draw of those casters.
Hash128 depth_views_key(const Hash128& casters, const ViewImage& image);

}  // namespace candela
