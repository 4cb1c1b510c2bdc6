#pragma once
#include <cstdint>
#include <glm/glm.hpp>

#include "look/look.h"

namespace candela {

// What changes from frame to frame while the plan stays as it is. Passes read it where they record, and no declaration
// depends on it: a frame whose plan is an earlier one's (plan/planned_graph.h) only fills these in again.
struct FrameValues {
  double time_s = 0;
  uint32_t noise_seed = 0;   // FrameRequest's
  uint32_t subframe = 0;     // which of the picture's frames (SubframePart)
  glm::dvec2 offset_px{0};   // of its samples against the middles of pixels, right and down
  float motion_share = 0;    // FrameRequest's
  float exposure = 1;        // of linear pictures inside the frame, as they are shown
  float radiance_scale = 1;  // from these to radiance
  float stored_scale = 1;    // the same, rounded as files are scaled
  float agx_min_ev = 0, agx_max_ev = 0;
  float blended_near_m = 0, blended_far_m = 0;  // between which depths along the view axis blended surfaces lie
  float volumetric_reach_m = 0;                 // of a ray, beyond which no lamp's light in the air is left
  uint32_t light_count = 0;                     // as uploaded or posed
  uint32_t metaball_blocks = 0;
  Bloom bloom;
  AutoExposure auto_exposure;
  Occlusion occlusion;
  Volumetric volumetric;
  static const FrameValues none;
};
inline const FrameValues FrameValues::none{};

// A value that a pass records with: a constant, or one of FrameValues, as it is then. What refers to FrameValues must
// not outlive them.
template <class T>
class Live {
 public:
  Live() = default;
  Live(T constant) : constant_(std::move(constant)) {}
  static Live of(const T& of_frame) {
    Live live;
    live.of_frame_ = &of_frame;
    return live;
  }
  const T& operator*() const { return of_frame_ ? *of_frame_ : constant_; }
  const T* operator->() const { return &**this; }

 private:
  T constant_{};
  const T* of_frame_ = nullptr;
};

}  // namespace candela
