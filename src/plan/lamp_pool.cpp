#include "plan/lamp_pool.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory_resource>

#include "base/check.h"
#include "base/room.h"
#include "base/scratch.h"

namespace candela {
namespace {

uint64_t spread_bits(uint32_t v) {
  uint64_t out = 0;
  for (uint32_t bit = 0; bit < 32; ++bit) out |= uint64_t(v >> bit & 1u) << (2 * bit);
  return out;
}
// The pool as squares of the least size, layer by layer along a Z-order curve: a map is a run of them that begins at a
// multiple of its length, and of each length of runs is known when what lies there was used last.
class Squares {
 public:
  Squares(const LampPool& pool, std::pmr::memory_resource* memory)
      : per_layer_(uint64_t(pool.layer_px / least_lamp_px) * (pool.layer_px / least_lamp_px)),
        owner_(size_t(per_layer_) * pool.layers, none, memory),
        used_(memory),
        least_(memory) {
    uint64_t runs = owner_.size(), all = 0, blocks = 0;
    for (Level& level : levels_) {
      level = {all, runs, blocks};
      all += runs, blocks += (runs + block - 1) / block, runs /= 4;
    }
    used_.assign(all, 0);
    least_.assign(blocks, 0);
  }
  static uint64_t length(uint32_t size_px) { return uint64_t(size_px / least_lamp_px) * (size_px / least_lamp_px); }
  // used: when it was used last, greater than 0.
  void put(uint64_t first, uint32_t size_px, uint32_t owner, uint64_t used) {
    const uint64_t run = length(size_px);
    std::fill_n(owner_.begin() + std::ptrdiff_t(first), run, owner);
    set_used(first, run, used);
  }
  void free(uint64_t first, uint32_t size_px) {
    const uint64_t run = length(size_px);
    std::fill_n(owner_.begin() + std::ptrdiff_t(first), run, none);
    set_used(first, run, 0);
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
  // Where a map of that size takes the place of what was not used for the longest time, the first of such places:
  // nothing, at best. What is used `now` stays; nothing: no run is free of that.
  std::optional<uint64_t> oldest(uint32_t size_px, uint64_t now) {
    const size_t l = size_t(std::bit_width(size_px / least_lamp_px) - 1);
    const Level& level = levels_[l];
    const auto block_of = [&](uint64_t b) {
      return std::span(used_).subspan(level.first + b * block, std::min(block, level.runs - b * block));
    };
    uint64_t found = 0, least = std::numeric_limits<uint64_t>::max();
    for (uint64_t b = 0; b * block < level.runs; ++b) {
      uint64_t& of_block = least_[level.first_block + b];
      if (of_block == unknown) of_block = *std::ranges::min_element(block_of(b));
      if (of_block < least) least = of_block, found = b;
    }
    if (least >= now) return std::nullopt;
    const auto used = block_of(found);
    return (found * block + uint64_t(std::ranges::find(used, least) - used.begin())) << (2 * l);
  }
  template <class Taken>
  void each_owner(uint64_t first, uint32_t size_px, Taken taken) const {
    uint32_t last = none;
    for (uint64_t i = first; i < first + length(size_px); ++i)
      if (owner_[i] != none && owner_[i] != last) taken(last = owner_[i]);
  }
  static constexpr uint32_t none = ~0u;

 private:
  static constexpr uint64_t block = 64, unknown = ~uint64_t(0);
  // Runs of 4^n squares.
  struct Level {
    uint64_t first = 0, runs = 0;  // of used_
    uint64_t first_block = 0;      // of least_
  };
  void set_used(uint64_t first, uint64_t run, uint64_t used) {
    uint64_t begin = first, end = first + run;
    std::fill(used_.begin() + std::ptrdiff_t(begin), used_.begin() + std::ptrdiff_t(end), used);
    forget_least(levels_[0], begin, end);
    for (size_t l = 1; l < levels_.size(); ++l) {
      const uint64_t below = levels_[l - 1].first;
      begin /= 4, end = std::min((end + 3) / 4, levels_[l].runs);
      for (uint64_t i = begin; i < end; ++i) {
        const uint64_t* of = &used_[below + 4 * i];
        used_[levels_[l].first + i] = std::max({of[0], of[1], of[2], of[3]});
      }
      forget_least(levels_[l], begin, end);
    }
  }
  void forget_least(const Level& level, uint64_t begin, uint64_t end) {
    for (uint64_t b = begin / block; b * block < end; ++b) least_[level.first_block + b] = unknown;
  }

  uint64_t per_layer_;
  ScratchVector<uint32_t> owner_;  // into LampPool::maps
  ScratchVector<uint64_t> used_;   // of each level's runs
  ScratchVector<uint64_t> least_;  // of each block of a level's runs
  std::array<Level, 16> levels_;
};

// Maps of a pool by their keys: a table with room for twice as many.
class Known {
 public:
  Known(size_t most, std::pmr::memory_resource* memory) : slots_(std::bit_ceil(2 * most + 2), Slot{}, memory) {}
  uint32_t* find(const Hash128& key) {
    for (size_t at = key.lo;; ++at) {
      Slot& slot = slots_[at & (slots_.size() - 1)];
      if (slot.map == empty) return nullptr;
      if (slot.map != erased && slot.key == key) return &slot.map;
    }
  }
  void set(const Hash128& key, uint32_t map) {
    if (uint32_t* const there = find(key)) {
      *there = map;
      return;
    }
    size_t at = key.lo;
    while (slots_[at & (slots_.size() - 1)].map != empty) ++at;
    slots_[at & (slots_.size() - 1)] = {key, map};
  }
  void erase(const Hash128& key) {
    if (uint32_t* const there = find(key)) *there = erased;
  }

 private:
  static constexpr uint32_t empty = ~0u, erased = ~0u - 1;
  struct Slot {
    Hash128 key{};
    uint32_t map = empty;
  };
  ScratchVector<Slot> slots_;
};

// False: the gaps are too small.
bool place(std::span<const LampMap> maps, PlacedLamps& out) {
  LampPool& pool = out.pool;
  out.tiles.clear(), out.drawn.clear();
  const uint64_t now = ++pool.frames;
  Scratch scratch;
  Known known(pool.maps.size() + maps.size(), &scratch);
  for (uint32_t m = 0; m < pool.maps.size(); ++m) known.set(pool.maps[m].key, m);
  for (const LampMap& map : maps)
    if (const uint32_t* const found = map.key ? known.find(*map.key) : nullptr) pool.maps[*found].used = now;
  // Odd: of what moves.
  const auto used_of = [&](const LampPool::Map& there) {
    return there.passing && there.used < now ? 1 : 2 * there.used;
  };
  Squares squares(pool, &scratch);
  for (uint32_t m = 0; m < pool.maps.size(); ++m)
    squares.put(squares.first_of(pool.maps[m].tile), pool.maps[m].size_px, m, used_of(pool.maps[m]));
  const size_t most = pool.maps.size() + maps.size();
  ScratchVector<uint8_t> gone(most, uint8_t(0), &scratch), of_frame(most, uint8_t(0), &scratch);
  ScratchVector<uint32_t> over(&scratch);
  for (uint32_t i = 0; i < maps.size(); ++i) {
    const LampMap& map = maps[i];
    if (const uint32_t* const found = map.key ? known.find(*map.key) : nullptr) {
      out.tiles.push_back(pool.maps[*found].tile);
      continue;
    }
    const auto first = squares.oldest(map.size_px, 2 * now);
    if (!first) return false;
    over.clear();
    squares.each_owner(*first, map.size_px, [&](uint32_t m) { over.push_back(m); });
    for (const uint32_t m : over) {
      squares.free(squares.first_of(pool.maps[m].tile), pool.maps[m].size_px);
      known.erase(pool.maps[m].key);
      gone[m] = 1;
    }
    const uint32_t added = uint32_t(pool.maps.size());
    pool.maps.push_back({map.key.value_or(Hash128{}), map.size_px, squares.tile_at(*first), now, map.passing});
    of_frame[added] = !map.key;
    if (map.key) known.set(*map.key, added);
    squares.put(*first, map.size_px, added, 2 * now);
    out.tiles.push_back(pool.maps[added].tile);
    out.drawn.push_back(i);
  }
  // What has no key is of no use to later frames.
  size_t left = 0;
  for (size_t m = 0; m < pool.maps.size(); ++m)
    if (!gone[m] && !of_frame[m]) pool.maps[left++] = pool.maps[m];
  pool.maps.resize(left);
  return true;
}

}  // namespace

void copy_pool(const LampPool& from, LampPool& to) {
  make_room(to.maps, from.maps.size());
  to = from;
}

bool place_lamps(const LampPool& before, std::span<const LampMap> maps, bool floats, uint32_t layer_px,
                 uint64_t most_bytes, PlacedLamps& placed) {
  const uint64_t layer_texels = uint64_t(layer_px) * layer_px, layer_bytes = layer_texels * sizeof(float);
  uint64_t texels = 0;
  for (const LampMap& map : maps) texels += uint64_t(map.size_px) * map.size_px;
  const uint64_t most_layers = std::min<uint64_t>(most_bytes / layer_bytes, std::numeric_limits<uint16_t>::max());
  if (texels > most_layers * layer_texels) return false;
  LampPool& pool = placed.pool;
  make_room(pool.maps, before.maps.size() + maps.size());
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
