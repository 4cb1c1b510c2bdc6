#pragma once
#include <span>

#include "base/knob.h"

namespace candela {

// How a picture with a shutter or a lens is made (passes/post/subframes.h).
struct SubframesKnobs {
  static constexpr std::string_view name = "subframes";
  int n = 16;
  int gather = 0;
  static std::span<const Knob> table();
};

}  // namespace candela
