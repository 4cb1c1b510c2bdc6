#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "base/error.h"

namespace candela {

// What stands where there is no sky (--background).
struct BackgroundChoice {
  // Of the scene: linear radiance, and 1; or all 0, with which pictures are transparent there.
  std::array<float, 4> linear{0, 0, 0, 0};
  // Of the display: sRGB codes, red highest, that tone-mapped pictures (PNG, video) are laid over, exactly as they are;
  // linear pictures stay transparent.
  std::optional<uint32_t> display_rgb = {};
  bool transparent() const { return linear[3] == 0; }
};

// "transparent"; "R,G,B", linear values of at least 0; "#rgb", "#rrggbb" or the name of a colour (CSS). Errors (usage).
Expected<BackgroundChoice> parse_background(const std::string& text);

}  // namespace candela
