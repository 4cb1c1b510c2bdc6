#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"
#include "scene/survey.h"

namespace candela {

// Image-based light: the knobs `ibl.*`, shared by what filters the sky and the passes that read it.
enum class IblMethod : int { split, lobe, sampled };
struct IblKnobs {
  static constexpr std::string_view name = "ibl";
  int method = int(IblMethod::lobe);
  int lights = 32;
  int size_px = 512;
  int filter_samples = 64;
  int irradiance_px = 32;
  int pixel_samples = 1024;
  int stretched = 48;
  int mirror_taps = 8;
  static std::span<const Knob> table();
  static bool matter(const SceneFacts& facts);  // without image-based light they do nothing
  bool operator==(const IblKnobs&) const = default;
};

}  // namespace candela
