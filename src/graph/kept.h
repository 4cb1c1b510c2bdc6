#pragma once
#include <cstdint>
#include <optional>
#include <set>

#include "base/hash.h"

namespace candela {

// The image that the frame's pooled one is a part of (GraphBuilder::pool).
struct PoolShape {
  uint32_t size_px = 0, layers = 0;
  bool filled = false;  // earlier frames left something in it
  bool operator==(const PoolShape&) const = default;
};

// What earlier frames left that this one may take or fill, by key: a hash of all that decides an image's content.
struct KeptKeys {
  std::set<Hash128> filled;  // the image is there
  std::set<Hash128> seen;    // a frame before had that content: this one fills an image for later ones
  std::optional<PoolShape> pool;
};

}  // namespace candela
