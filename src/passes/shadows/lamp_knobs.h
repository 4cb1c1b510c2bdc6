#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"
#include "scene/survey.h"

namespace candela {

// Shadow maps of point and spot lights: the knobs `local.*`, shared by the choice of the lights and the passes that
// draw and read the maps.
struct LampKnobs {
  static constexpr std::string_view name = "local";
  static constexpr int maps = 0, by_voxels = 1, by_rays = 2, hard = 0, pcss = 1;
  int method = maps;
  int soft = hard;
  int samples = 16;
  int lights = 256;  // none, marked_alone
  static constexpr int none = 0, marked_alone = -1;
  int budget_mb = 128;
  int size_px = 1024;
  int pixel_places = 9;
  int draws = 1 << 21;
  bool traced() const { return method != maps; }  // cells keep what rays find
  static bool matter(const SceneFacts& facts);    // without point and spot lights they do nothing
  static std::span<const Knob> table();
};

}  // namespace candela
