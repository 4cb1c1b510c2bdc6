#pragma once
#include <set>

#include "base/hash.h"

namespace candela {

// What earlier frames left that this one may take or fill, by key: a hash of all that decides an image's content.
struct KeptKeys {
  std::set<Hash128> filled;  // the image is there
  std::set<Hash128> seen;    // a frame before had that content: this one fills an image for later ones
};

}  // namespace candela
