#pragma once
#include <string_view>

#include "image/image.h"
#include "reference/film.h"

namespace candela::reference {

struct DisplaySettings {
  std::string_view curve = "agx";  // none, agx, reinhard, aces, neutral, rec709
  double exposure_ev = 0;
  int bits = 8;
  bool dither = true;  // 8 bits alone
  bool alpha = false;  // straight alpha as a fourth channel
  uint32_t seed = 0;
};

// Exposed linear Rec.709 to linear display values (TECHNIQUES 15.2), in double.
glm::dvec3 tone_mapped(std::string_view curve, glm::dvec3 c);
// Those, clipped to [0,1] and sRGB-encoded.
glm::dvec3 display_encoded(glm::dvec3 mapped);

// The film as the GPU's tone mapping makes it: exposure, curve, sRGB encoding, and the same dither.
DisplayImage display_image(const Film& film, const DisplaySettings& settings);

}  // namespace candela::reference
