#pragma once
#include "base/hash.h"
#include "graph/plan.h"

namespace candela {

// Whether an image that could be kept from frame to frame is worth it, or here (gpu/kept_image.h).
// unknown: no frame before had that content. seen: one had, so that this frame fills an image for later ones.
enum class KeptState { unknown, seen, filled };

// A frame's use of an image that is kept under a key, a hash of all that decides its content.
struct KeptUse {
  Hash128 key;
  ImageDesc desc;
  int resource = -1;     // the import in the plan; -1: an image of this frame alone
  bool to_fill = false;  // this frame makes it
};

}  // namespace candela
