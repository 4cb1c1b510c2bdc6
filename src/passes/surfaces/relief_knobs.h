#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"
#include "scene/survey.h"

namespace candela {

// How rays meet the reliefs of materials (CANDELA_relief): the knobs `relief.*`, shared by all that draws surfaces or
// traces rays (shaders/lib/relief.glsl).
struct ReliefKnobs {
  static constexpr std::string_view name = "relief";
  int steps = 64, refinements = 6, light_steps = 0, by_sample = 0;
  static std::span<const Knob> table();
  static bool matter(const SceneFacts& facts);  // without reliefs they do nothing
};

}  // namespace candela
