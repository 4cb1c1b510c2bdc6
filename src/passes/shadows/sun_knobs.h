#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"

namespace candela {

// Shadow maps of directional lights: the knobs `sun.*`, shared by the fit of the cascades and the passes that draw and
// read them.
enum class SunMode : int { off, single, cascades, voxels, traced };
inline bool sends_rays(SunMode mode) { return mode == SunMode::voxels || mode == SunMode::traced; }
struct SunKnobs {
  static constexpr std::string_view name = "sun";
  static constexpr int hard = 0, pcss = 1;
  int mode = int(SunMode::cascades);
  int soft = pcss;
  int samples = 16;
  float soft_from_deg = 1;
  int cascades = 5;
  int size_px = 2048;
  int single_px = 4096;
  float distance = 1;
  float split_lambda = 0.9f;
  int tight = 0;
  int skip_served = 1;
  float least_texels = 1;
  int lights = 4;
  int draws = 1 << 21;
  static std::span<const Knob> table();
};

}  // namespace candela
