#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"
#include "scene/survey.h"

namespace candela {

// Reflection probes: the knobs `probes.*`, shared by what takes their images and the passes that read them.
struct ProbeKnobs {
  static constexpr std::string_view name = "probes";
  int size_px = 256;
  static std::span<const Knob> table();
  static bool matter(const SceneFacts& facts);  // without probes they do nothing
  bool operator==(const ProbeKnobs&) const = default;
};

}  // namespace candela
