#pragma once
#include <optional>

#include "session/session.h"

namespace candela {

// How the pixels of a frame's picture that show something lie between black and white; a fraction of them is looked at,
// evenly spaced, but for is_black, which is of all.
struct PictureTones {
  double clipped = 0;     // share with a channel at white
  double seen = 0;        // share above code 8 of 255
  bool is_black = false;  // no channel of any pixel is above 0
};
// Absent for frames without a picture of light, and where nothing is covered.
std::optional<PictureTones> tones_of(const FrameResult& frame, const Job& job);

}  // namespace candela
