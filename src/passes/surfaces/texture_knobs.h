#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"
#include "scene/survey.h"

namespace candela {

// How the textures of materials are filtered: the knobs `textures.*`, shared by all passes that sample them.
struct TextureKnobs {
  static constexpr std::string_view name = "textures";
  int anisotropy = 16;
  static std::span<const Knob> table();
  static bool matter(const SceneFacts& facts);  // without textures they do nothing
};

}  // namespace candela
