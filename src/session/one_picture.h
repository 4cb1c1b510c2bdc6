#pragma once
#include <vector>

#include "session/session.h"

namespace candela {

// What a picture of several frames (plan/subframes.h) gives: the last one's outputs, the times, notes and warnings of
// all of them, and a hash of their plans. frames: at least one, in their order.
FrameResult one_picture(std::vector<FrameResult> frames);

}  // namespace candela
