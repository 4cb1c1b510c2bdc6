#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"
#include "scene/survey.h"

namespace candela {

// How the shading of surfaces stands for what lies between pixels: the knobs `surfaces.*`, shared by what shades them.
struct SurfaceKnobs {
  static constexpr std::string_view name = "surfaces";
  enum : int { off, normals, maps };
  int specular_aa = off;
  static std::span<const Knob> table();
  static bool matter(const SceneFacts& facts);  // where no surface takes light they do nothing
};

}  // namespace candela
