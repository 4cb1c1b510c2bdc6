#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "image/image.h"
#include "look/look.h"
#include "reference/film.h"

namespace candela::reference {

struct DisplaySettings {
  std::string_view curve = "agx";  // as --tonemap names them (passes/post/tonemap.h)
  double exposure_ev = 0;
  double agx_min_ev = agx_lowest_ev, agx_max_ev = agx_highest_ev;  // look/look.h
  int bits = 8;
  bool dither = true;                       // 8 bits alone
  bool alpha = false;                       // straight alpha as a fourth channel
  std::optional<uint32_t> behind_rgb = {};  // sRGB codes that the picture is laid over; without alpha
  uint32_t seed = 0;
  glm::ivec2 corner_px{0};  // of a part of a picture, whose dither is the whole's
};

// Exposed linear Rec.709 to linear display values, in double.
glm::dvec3 tone_mapped(std::string_view curve, glm::dvec3 c, double agx_min_ev = agx_lowest_ev,
                       double agx_max_ev = agx_highest_ev);
// Those, clipped to [0,1] and sRGB-encoded.
glm::dvec3 display_encoded(glm::dvec3 mapped, std::string_view curve);

// Automatic exposure in stops: what takes the mean log2 of the luminances between two percentiles of the film to the
// target; by sorting, in double. pixels: premultiplied.
double automatic_ev(std::span<const glm::dvec4> pixels, const AutoExposure& look);

// The film as the GPU's tone mapping makes it: exposure, curve, sRGB encoding, and the same dither.
DisplayImage display_image(const Film& film, const DisplaySettings& settings);
// The same of pixels with premultiplied alpha, rows of `width` from the top.
DisplayImage display_image(std::span<const glm::dvec4> pixels, int width, const DisplaySettings& settings);

}  // namespace candela::reference
