#include "plan/lamp_pool.h"

#include <gtest/gtest.h>

#include <numeric>

#include "base/rng.h"

namespace candela {
namespace {

constexpr uint32_t layer_px = 512;
constexpr uint64_t layer_bytes = uint64_t(layer_px) * layer_px * sizeof(float);

LampMap map_of(uint64_t number, uint32_t size_px) { return {size_px, Hash128{number, size_px}}; }

std::vector<LampMap> sorted(std::vector<LampMap> maps) {
  std::ranges::stable_sort(maps, std::ranges::greater(), &LampMap::size_px);
  return maps;
}

// Each texel belongs to one map at most.
void expect_apart(const std::vector<LampTile>& tiles, const std::vector<LampMap>& maps, uint32_t layers) {
  std::vector<int> taken(size_t(layers) * layer_px * layer_px / (64 * 64), -1);
  for (size_t m = 0; m < maps.size(); ++m) {
    EXPECT_EQ(tiles[m].origin_px % maps[m].size_px, glm::uvec2(0));
    for (uint32_t y = 0; y < maps[m].size_px; y += 64)
      for (uint32_t x = 0; x < maps[m].size_px; x += 64) {
        const glm::uvec2 at = (tiles[m].origin_px + glm::uvec2(x, y)) / 64u;
        ASSERT_LT(tiles[m].layer, layers);
        ASSERT_LT(std::max(at.x, at.y), layer_px / 64);
        int& owner = taken[(size_t(tiles[m].layer) * (layer_px / 64) + at.y) * (layer_px / 64) + at.x];
        EXPECT_EQ(owner, -1) << m;
        owner = int(m);
      }
  }
}

PlacedLamps placed(const LampPool& before, const std::vector<LampMap>& maps, uint64_t layers = 2) {
  PlacedLamps out;
  EXPECT_TRUE(place_lamps(before, maps, true, layer_px, layers * layer_bytes, out));
  return out;
}

}  // namespace

TEST(LampPool, DrawsWhatIsNewAndNothingElse) {
  const std::vector<LampMap> first = {map_of(1, 256), map_of(2, 128), map_of(3, 64)};
  const PlacedLamps a = placed({}, first);
  EXPECT_EQ(a.drawn, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_TRUE(a.pool.fresh);
  LampPool pool = a.pool;
  pool.fresh = false;
  // One left, one came, and one is of another size: the old one stays for later.
  const std::vector<LampMap> second = {map_of(4, 256), map_of(3, 128), map_of(2, 128)};
  const PlacedLamps b = placed(pool, second);
  EXPECT_EQ(b.drawn, (std::vector<uint32_t>{0, 1}));
  EXPECT_FALSE(b.pool.fresh);
  EXPECT_EQ(b.tiles[2].origin_px, a.tiles[1].origin_px);
  const PlacedLamps c = placed(b.pool, first);
  EXPECT_TRUE(c.drawn.empty());
  for (size_t m = 0; m < first.size(); ++m) EXPECT_EQ(c.tiles[m].origin_px, a.tiles[m].origin_px);
}

TEST(LampPool, PlacesWhatChangesForTheFrameAlone) {
  std::vector<LampMap> maps = {map_of(1, 256), map_of(2, 256)};
  maps[0].key.reset();
  const PlacedLamps a = placed({}, maps);
  EXPECT_EQ(a.drawn.size(), 2u);
  EXPECT_EQ(a.pool.maps.size(), 1u);
  const PlacedLamps b = placed(a.pool, maps);
  EXPECT_EQ(b.drawn, std::vector<uint32_t>{0});
  expect_apart(b.tiles, maps, b.pool.layers);
}

TEST(LampPool, DrawsTwoLikeMapsOnce) {
  const PlacedLamps a = placed({}, {map_of(1, 256), map_of(1, 256)});
  EXPECT_EQ(a.drawn, std::vector<uint32_t>{0});
  EXPECT_EQ(a.tiles[0].origin_px, a.tiles[1].origin_px);
}

TEST(LampPool, PutsTheNewOverWhatWasNotUsedForTheLongestTime) {
  // One layer, of four maps.
  LampPool pool;
  for (const uint64_t number : {1, 2, 3, 4}) pool = placed(pool, {map_of(number, 256)}, 1).pool;
  EXPECT_EQ(pool.maps.size(), 4u);
  pool = placed(pool, {map_of(1, 256)}, 1).pool;
  pool = placed(pool, {map_of(5, 256)}, 1).pool;
  EXPECT_TRUE(placed(pool, {map_of(1, 256)}, 1).drawn.empty());
  EXPECT_EQ(placed(pool, {map_of(2, 256)}, 1).drawn.size(), 1u);
  EXPECT_TRUE(placed(pool, {map_of(3, 256)}, 1).drawn.empty());
}

// One layer, of four maps: that of what moves makes room first, though it was used last.
TEST(LampPool, PutsTheNewOverWhatMovesFirst) {
  LampPool pool;
  for (const uint64_t number : {1, 2, 3}) pool = placed(pool, {map_of(number, 256)}, 1).pool;
  LampMap moves = map_of(4, 256);
  moves.passing = true;
  pool = placed(pool, {moves}, 1).pool;
  EXPECT_TRUE(placed(pool, {moves}, 1).drawn.empty()) << "as long as there is room";
  pool = placed(pool, {map_of(5, 256)}, 1).pool;
  for (const uint64_t number : {1, 2, 3}) EXPECT_TRUE(placed(pool, {map_of(number, 256)}, 1).drawn.empty()) << number;
  EXPECT_EQ(placed(pool, {moves}, 1).drawn.size(), 1u);
}

TEST(LampPool, AnyFrameThatFitsIsPlacedWhateverCameBefore) {
  Rng rng(31);
  LampPool pool;
  for (int frame = 0; frame < 200; ++frame) {
    std::vector<LampMap> maps;
    for (uint64_t texels = 0;;) {
      LampMap map = map_of(rng.next() % 40, 64u << rng.next() % 4);
      texels += uint64_t(map.size_px) * map.size_px;
      if (texels > 2 * uint64_t(layer_px) * layer_px) break;
      if (rng.next() % 8 == 0) map.key.reset();
      map.passing = rng.next() % 4 == 0;
      if (std::ranges::none_of(maps, [&](const LampMap& m) { return m.key && m.key == map.key; })) maps.push_back(map);
    }
    maps = sorted(maps);
    const PlacedLamps next = placed(pool, maps);
    ASSERT_EQ(next.tiles.size(), maps.size());
    expect_apart(next.tiles, maps, next.pool.layers);
    // What is not drawn was where it is read.
    for (uint32_t m = 0; m < maps.size(); ++m) {
      if (std::ranges::binary_search(next.drawn, m)) continue;
      ASSERT_TRUE(maps[m].key);
      EXPECT_TRUE(std::ranges::any_of(pool.maps, [&](const LampPool::Map& old) {
        return old.key == maps[m].key && old.size_px == maps[m].size_px &&
               old.tile.origin_px == next.tiles[m].origin_px && old.tile.layer == next.tiles[m].layer;
      }));
      EXPECT_FALSE(next.pool.fresh);
    }
    pool = next.pool;
  }
}

// Of all places that a map may take the first whose maps no frame has used for the longest time, counted one by one.
TEST(LampPool, TakesTheFirstOfThePlacesThatWereUnusedForTheLongestTime) {
  constexpr uint32_t side = layer_px / 64;
  constexpr uint64_t now = ~uint64_t(0);
  const auto place_of = [](glm::uvec2 at) {  // along the curve
    uint32_t place = 0;
    for (uint32_t bit = 0; bit < 3; ++bit) place |= (at.x >> bit & 1) << (2 * bit) | (at.y >> bit & 1) << (2 * bit + 1);
    return place;
  };
  Rng rng(7);
  LampPool pool;
  int taken = 0;
  for (int frame = 0; frame < 400; ++frame) {
    std::vector<LampMap> maps;
    for (int i = 0; i < 6; ++i) {
      maps.push_back(map_of(rng.next() % 300, 64u << rng.next() % 2));
      maps.back().passing = rng.next() % 4 == 0;
    }
    maps = sorted(maps);
    const PlacedLamps next = placed(pool, maps, 1);
    if (!next.pool.fresh) {
      std::vector<int> owner(side * side, -1);
      std::vector<uint64_t> used;
      for (const LampPool::Map& m : pool.maps) {
        const bool is_now = std::ranges::any_of(maps, [&](const LampMap& map) { return map.key == m.key; });
        for (uint32_t y = 0; y < m.size_px / 64; ++y)
          for (uint32_t x = 0; x < m.size_px / 64; ++x)
            owner[place_of(m.tile.origin_px / 64u + glm::uvec2(x, y))] = int(used.size());
        used.push_back(is_now ? now : m.passing ? 1 : 2 * m.used);  // of what moves it does not count
      }
      for (const uint32_t drawn : next.drawn) {
        const size_t run = size_t(maps[drawn].size_px / 64) * (maps[drawn].size_px / 64);
        size_t best = 0;
        uint64_t least = now;
        for (size_t first = 0; first < owner.size(); first += run) {
          uint64_t most = 0;
          for (size_t i = first; i < first + run; ++i)
            if (owner[i] >= 0) most = std::max(most, used[size_t(owner[i])]);
          if (most < least) least = most, best = first;
        }
        ASSERT_EQ(place_of(next.tiles[drawn].origin_px / 64u), best) << frame;
        for (size_t i = best; i < best + run; ++i)
          if (const int gone = owner[i]; gone >= 0) std::ranges::replace(owner, gone, -1);
        std::fill_n(owner.begin() + long(best), run, int(used.size()));
        used.push_back(now);
        ++taken;
      }
    }
    pool = next.pool;
  }
  EXPECT_GT(taken, 1000);
}

TEST(LampPool, GrowsWithTheFramesAsFarAsItMay) {
  const std::vector<LampMap> one = {map_of(1, 512)}, two = {map_of(1, 512), map_of(2, 512)};
  const PlacedLamps a = placed({}, {map_of(9, 64)}, 8);
  EXPECT_EQ(a.pool.layers, 1u);
  const PlacedLamps b = placed(a.pool, two, 8);
  EXPECT_EQ(b.pool.layers, 8u);
  EXPECT_TRUE(b.pool.fresh);
  EXPECT_EQ(placed(b.pool, one, 8).pool.layers, 8u) << "it never shrinks";
  EXPECT_TRUE(placed(b.pool, one, 8).drawn.empty());
  EXPECT_EQ(placed({}, two, 3).pool.layers, 3u);
  PlacedLamps other;
  EXPECT_FALSE(place_lamps({}, two, true, layer_px, layer_bytes, other)) << "two layers do not fit into one";
  ASSERT_TRUE(place_lamps(b.pool, two, false, layer_px, 8 * layer_bytes, other));
  EXPECT_TRUE(other.pool.fresh) << "an image of another kind";
}

}  // namespace candela
