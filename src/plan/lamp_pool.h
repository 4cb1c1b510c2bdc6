#pragma once
#include <optional>
#include <span>
#include <vector>

#include "base/hash.h"
#include "plan/lamp_faces.h"

namespace candela {

// The layered image in which shadow maps of point and spot lights outlive frames, as a value: which maps are in it, by
// hashes of all that decides their texels, and where. So a film draws the maps of standing lights once for each size,
// whatever the camera does. Where a map lies changes no picture.
struct LampPool {
  struct Map {
    Hash128 key;
    uint32_t size_px = 0;
    LampTile tile;
    uint64_t used = 0;     // the last of the pool's frames that reads it
    bool passing = false;  // as of LampMap
  };
  uint32_t layer_px = 0, layers = 0;
  bool floats = false;  // what the image is of: plain floats, or depths
  bool fresh = true;    // the image is to be made
  uint64_t frames = 0;  // that were placed in it
  std::vector<Map> maps;
  void forget() { layer_px = layers = 0, floats = false, fresh = true, frames = 0, maps.clear(); }
};

// With room for some more maps (base/room.h).
void copy_pool(const LampPool& from, LampPool& to);

// What planning knows of earlier frames' maps.
struct KeptLamps {
  const LampPool& pool;
  uint64_t most_bytes = 0;  // of the image
};

// A frame's maps as they are to be placed. Without a key: of something that changes from frame to frame. passing: of
// something that moves, so that later frames hardly want it; it is the first to make room for others.
struct LampMap {
  uint32_t size_px = 0;
  std::optional<Hash128> key;
  bool passing = false;
};
struct PlacedLamps {
  LampPool pool;                // once the frame is drawn
  std::vector<LampTile> tiles;  // of each map
  std::vector<uint32_t> drawn;  // maps that are to be drawn, in their order
};
// Finds the maps that are there, and places the others where nothing is, or over maps that no frame used for the
// longest time; where gaps are too small, all of them anew. The image has the least number of layers that holds four
// times the frame's maps, in powers of two, as far as `most_bytes` reach, and never shrinks; it is made anew where it
// is to grow. False: not even the frame's own maps fit. maps: the largest first. layer_px: side of a layer, at least
// that of a map.
// placed: whatever it held, its memory is used again.
bool place_lamps(const LampPool& before, std::span<const LampMap> maps, bool floats, uint32_t layer_px,
                 uint64_t most_bytes, PlacedLamps& placed);

}  // namespace candela
