#pragma once
#include <glm/glm.hpp>
#include <span>
#include <string_view>

#include "passes/shared/pass.h"

namespace candela {

// How light in fog is resolved: the knobs `fog.*`.
struct FogKnobs {
  static constexpr std::string_view name = "fog";
  static constexpr int froxels = 0, march = 1, pixels = 2;
  int method = froxels;
  int grid = 3;  // into fog_grids
  static constexpr int near_lamps = 1;
  int last = near_lamps;  // where the slice in which a surface stands is summed for itself
  int steps = 128;        // of a ray that a pixel follows
  int march_steps = 64;   // at most, of a texel's ray
  float march_loss = 0.025f;
  int march_px = 2;         // a texel's side
  int local_shadows = 1;    // points of a slice at which a lamp's maps are asked
  int sun_points = 4;       // of a slice, at which a sun's maps are asked
  int sky_directions = 16;  // of the transmittance before the sky
  static std::span<const Knob> table();
  // FogMedium::nodes in a picture of this size.
  glm::uvec3 nodes(uint32_t width_px, uint32_t height_px) const;
};

// Whether any light comes out of the fog that must be summed.
Need fog_light_needed(const SceneFacts& facts, const FrameRequest& request);

}  // namespace candela
