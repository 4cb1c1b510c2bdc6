#pragma once
#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "base/hash.h"

namespace candela {

// The image that the frame's pooled one is a part of (GraphBuilder::pool).
struct PoolShape {
  uint32_t size_px = 0, layers = 0;
  bool filled = false;  // earlier frames left something in it
  bool operator==(const PoolShape&) const = default;
};

// A few keys.
class KeySet {
 public:
  KeySet() = default;
  KeySet(std::initializer_list<Hash128> keys) : keys_(keys) {}
  bool contains(const Hash128& key) const { return std::ranges::find(keys_, key) != keys_.end(); }
  void insert(const Hash128& key) {
    if (!contains(key)) keys_.push_back(key);
  }
  void clear() { keys_.clear(); }
  bool empty() const { return keys_.empty(); }

 private:
  std::vector<Hash128> keys_;
};

// What earlier frames left that this one may take or fill, by key: a hash of all that decides an image's content.
struct KeptKeys {
  KeySet filled;  // the image is there
  KeySet seen;    // a frame before had that content: this one fills an image for later ones
  std::optional<PoolShape> pool;
};

}  // namespace candela
