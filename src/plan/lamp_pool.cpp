#include "plan/lamp_pool.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <memory_resource>

#include "base/check.h"
#include "base/scratch.h"

namespace candela {
namespace {

uint64_t spread_bits(uint32_t v) {
  uint64_t out = 0;
  for (uint32_t bit = 0; bit < 32; ++bit) out |= uint64_t(v >> bit & 1u) << (2 * bit);
  return out;
}
// The pool as squares of the least size, layer by layer along a Z-order curve: a map is a run of them that begins at a
// multiple of its length.
class Squares {
 public:
  Squares(const LampPool& pool, std::pmr::memory_resource* memory)
      : per_layer_(uint64_t(pool.layer_px / least_lamp_px) * (pool.layer_px / least_lamp_px)),
        owner_(size_t(per_layer_) * pool.layers, none, memory) {}
  static uint64_t length(uint32_t size_px) { return uint64_t(size_px / least_lamp_px) * (size_px / least_lamp_px); }
  void put(uint64_t first, uint32_t size_px, uint32_t owner) {
    std::fill_n(owner_.begin() + std::ptrdiff_t(first), length(size_px), owner);
  }
  uint64_t first_of(const LampTile& tile) const {
    return tile.layer * per_layer_ +
           (spread_bits(tile.origin_px.x / least_lamp_px) | spread_bits(tile.origin_px.y / least_lamp_px) << 1);
  }
  LampTile tile_at(uint64_t first) const {
    const uint64_t in_layer = first % per_layer_;
    return {glm::uvec2(every_second_bit(in_layer), every_second_bit(in_layer >> 1)) * least_lamp_px,
            uint32_t(first / per_layer_)};
  }
  // Where a map of that size takes the place of what was not used for the longest time: nothing, at best. used_of: of
  // an owner, greater than 0. What is used `now` stays; nothing: no run is free of that.
  template <class UsedOf>
  std::optional<uint64_t> oldest(uint32_t size_px, uint64_t now, UsedOf used_of) const {
    const uint64_t run = length(size_px);
    std::optional<uint64_t> best;
    uint64_t best_used = now;
    for (uint64_t first = 0; first + run <= owner_.size() && best_used > 0; first += run) {
      uint64_t used = 0;
      for (uint64_t i = first; i < first + run && used < best_used; ++i)
        if (owner_[i] != none) used = std::max(used, used_of(owner_[i]));
      if (used < best_used) best = first, best_used = used;
    }
    return best;
  }
  template <class Taken>
  void each_owner(uint64_t first, uint32_t size_px, Taken taken) const {
    uint32_t last = none;
    for (uint64_t i = first; i < first + length(size_px); ++i)
      if (owner_[i] != none && owner_[i] != last) taken(last = owner_[i]);
  }
  static constexpr uint32_t none = ~0u;

 private:
  uint64_t per_layer_;
  ScratchVector<uint32_t> owner_;  // into LampPool::maps
};

// False: the gaps are too small.
bool place(std::span<const LampMap> maps, PlacedLamps& out) {
  LampPool& pool = out.pool;
  out.tiles.clear(), out.drawn.clear();
  const uint64_t now = ++pool.frames;
  Scratch scratch;
  Squares squares(pool, &scratch);
  std::pmr::map<Hash128, uint32_t> known(&scratch);
  for (uint32_t m = 0; m < pool.maps.size(); ++m) {
    squares.put(squares.first_of(pool.maps[m].tile), pool.maps[m].size_px, m);
    known[pool.maps[m].key] = m;
  }
  for (const LampMap& map : maps)
    if (const auto found = map.key ? known.find(*map.key) : known.end(); found != known.end())
      pool.maps[found->second].used = now;
  ScratchVector<bool> gone(pool.maps.size(), false, &scratch), of_frame(pool.maps.size(), false, &scratch);
  ScratchVector<uint32_t> over(&scratch);
  for (uint32_t i = 0; i < maps.size(); ++i) {
    const LampMap& map = maps[i];
    if (const auto found = map.key ? known.find(*map.key) : known.end(); found != known.end()) {
      out.tiles.push_back(pool.maps[found->second].tile);
      continue;
    }
    // Odd: of what moves.
    const auto used_of = [&](uint32_t m) {
      const LampPool::Map& there = pool.maps[m];
      return there.passing && there.used < now ? 1 : 2 * there.used;
    };
    const auto first = squares.oldest(map.size_px, 2 * now, used_of);
    if (!first) return false;
    over.clear();
    squares.each_owner(*first, map.size_px, [&](uint32_t m) { over.push_back(m); });
    for (const uint32_t m : over) {
      squares.put(squares.first_of(pool.maps[m].tile), pool.maps[m].size_px, Squares::none);
      known.erase(pool.maps[m].key);
      gone[m] = true;
    }
    const uint32_t added = uint32_t(pool.maps.size());
    pool.maps.push_back({map.key.value_or(Hash128{}), map.size_px, squares.tile_at(*first), now, map.passing});
    gone.push_back(false), of_frame.push_back(!map.key);
    if (map.key) known[*map.key] = added;
    squares.put(*first, map.size_px, added);
    out.tiles.push_back(pool.maps[added].tile);
    out.drawn.push_back(i);
  }
  // What has no key is of no use to later frames.
  for (size_t m = pool.maps.size(); m-- > 0;)
    if (gone[m] || of_frame[m]) pool.maps.erase(pool.maps.begin() + std::ptrdiff_t(m));
  return true;
}

}  // namespace

bool place_lamps(const LampPool& before, std::span<const LampMap> maps, bool floats, uint32_t layer_px,
                 uint64_t most_bytes, PlacedLamps& placed) {
  const uint64_t layer_texels = uint64_t(layer_px) * layer_px, layer_bytes = layer_texels * sizeof(float);
  uint64_t texels = 0;
  for (const LampMap& map : maps) texels += uint64_t(map.size_px) * map.size_px;
  const uint64_t most_layers = std::min<uint64_t>(most_bytes / layer_bytes, std::numeric_limits<uint16_t>::max());
  if (texels > most_layers * layer_texels) return false;
  LampPool& pool = placed.pool;
  pool = before;
  pool.fresh = false;
  const auto empty = [&] { pool.maps.clear(), pool.fresh = true; };
  if (pool.layer_px != layer_px || pool.floats != floats) pool.layers = 0;
  const uint64_t wanted = std::min(std::bit_ceil((4 * texels + layer_texels - 1) / layer_texels), most_layers);
  if (pool.layers < wanted || pool.layers > most_layers) {
    pool.layers = uint32_t(wanted), pool.layer_px = layer_px, pool.floats = floats;
    empty();
  }
  const uint64_t frames = pool.frames;
  if (place(maps, placed)) return true;
  pool.maps.clear(), pool.frames = frames;
  CHECK(place(maps, placed));  // the largest first, without gaps
  return true;
}

}  // namespace candela
