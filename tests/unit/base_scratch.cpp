#include "base/scratch.h"

#include <gtest/gtest.h>

#include <numeric>

#include "base/reused.h"
#include "base/rng.h"

namespace candela {

TEST(Scratch, TheSecondTimeIsInTheSameBlock) {
  const void* places[3];
  for (const void*& place : places) {
    const Scratch around;
    Scratch scratch;
    ScratchVector<double> values(1000, 1.0, &scratch);
    place = values.data();
    EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0), 1000);
  }
  EXPECT_EQ(places[1], places[2]) << "the first one was too large for the block that there was";
}

// A vector of an outer scratch that grows while an inner one is alive keeps what it has when that ends.
TEST(Scratch, WhatGrowsMeanwhileStays) {
  for (int round = 0; round < 3; ++round) {
    Scratch outer;
    ScratchVector<int> kept(&outer);
    kept.push_back(-1);
    {
      Scratch inner;
      ScratchVector<int> passing(100, 7, &inner);
      for (int i = 0; i < 5000; ++i) kept.push_back(i);
      passing.resize(3000, 8);
    }
    Scratch later;
    const ScratchVector<int> over(20000, 9, &later);
    ASSERT_EQ(kept.size(), 5001u);
    for (int i = 0; i < 5000; ++i) ASSERT_EQ(kept[size_t(i) + 1], i);
  }
}

// Vectors of several depths, in any order.
void nest(Rng& rng, int depth) {
  Scratch scratch;
  std::vector<ScratchVector<uint32_t>> all;
  for (int i = 0; i < 4; ++i) all.emplace_back(&scratch);
  for (int step = 0; step < 12; ++step) {
    const size_t which = rng.next() % all.size();
    for (uint64_t i = rng.next() % 200; i > 0; --i) all[which].push_back(uint32_t(which * 1000000 + all[which].size()));
    if (rng.next() % 5 == 0) all[which] = ScratchVector<uint32_t>(&scratch);
    if (depth < 4 && rng.next() % 3 == 0) nest(rng, depth + 1);
    for (size_t v = 0; v < all.size(); ++v)
      for (size_t i = 0; i < all[v].size(); ++i) ASSERT_EQ(all[v][i], v * 1000000 + i);
  }
}
TEST(Scratch, NoTwoShareAPlace) {
  Rng rng(5);
  for (int round = 0; round < 40; ++round) nest(rng, 0);
}

TEST(Scratch, PlacesAreAligned) {
  Scratch scratch;
  const ScratchVector<char> odd(3, 'a', &scratch);
  const ScratchVector<double> values(3, 1.0, &scratch);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(values.data()) % alignof(double), 0u);
  struct alignas(64) Wide {
    char bytes[64];
  };
  const ScratchVector<Wide> wide(2, &scratch);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(wide.data()) % 64, 0u);
}

TEST(Notes, KeepTheirMemoryAndNothingElse) {
  Notes notes;
  notes.add("{} lights, a line that is longer than a short string", 1);
  notes.extend(" and {}", "more");
  notes.push_back("second");
  EXPECT_EQ(notes.size(), 2u);
  const char* const place = notes[0].data();
  notes.clear();
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(notes.begin(), notes.end());
  notes.add("{}", 7);
  EXPECT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes.front(), "7");
  EXPECT_EQ(notes[0].data(), place);
}

TEST(Reused, IsNotThereAfterReset) {
  Reused<std::vector<int>> value;
  EXPECT_FALSE(value);
  value.emplace().assign(100, 1);
  EXPECT_TRUE(value);
  value.reset();
  EXPECT_FALSE(value);
  EXPECT_GE(value.emplace().capacity(), 100u);
}

}  // namespace candela
