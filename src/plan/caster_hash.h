#pragma once
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "base/hash.h"
#include "passes/shared/views.h"
#include "passes/surfaces/relief_knobs.h"
#include "passes/surfaces/texture_knobs.h"
#include "plan/frame_upload.h"
#include "scene/pose.h"

namespace candela {

// A hash of everything that decides the depth of what casts shadows, whatever the view: items with their transforms and
// geometry, and of masked ones the mask. Nothing when something that casts is deformed: that changes from frame to
// frame. What neither casts nor masks (blended surfaces, colours) is not in it. Transforms are relative to the camera,
// so a camera that moves changes it.
std::optional<Hash128> caster_hash(const DrawList& draws, const FrameUpload& upload, const Pose& pose,
                                   const TextureKnobs& textures, const ReliefKnobs& relief = {});

// A hash of what decides the depth of one thing that casts shadows, as seen from a place in the world: the same
// wherever the camera is. Sums tell sets of things apart, in any order.
struct CasterHash {
  uint64_t low = 0, high = 0;
  bool deformed = false;  // it changes from frame to frame
  void add(const CasterHash& other) {
    low += other.low, high += other.high;
    deformed |= other.deformed;
  }
};
struct CasterHashes {
  std::pmr::vector<CasterHash> items;     // posed by the host, in the order of drawing; zeros: it casts none
  std::pmr::vector<CasterHash> clusters;  // of item_clusters()
  explicit CasterHashes(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : items(memory), clusters(memory) {}
};
void caster_hashes(const FrameData& data, const DrawList& draws, const FrameUpload& upload, const Pose& pose,
                   CasterHashes& hashes);

// The key of the image that these views draw of those casters.
Hash128 depth_views_key(const Hash128& casters, const ViewImage& image);

}  // namespace candela
