#include "session/changed_ranges.h"

#include <gtest/gtest.h>

#include <random>

namespace candela::test {
namespace {

std::vector<std::byte> pattern(size_t size) {
  std::vector<std::byte> bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = std::byte(uint8_t(i * 37 + i / 256));
  return bytes;
}

std::vector<ByteRange> ranges_of(std::span<const std::byte> held, std::span<const std::byte> bytes) {
  std::vector<ByteRange> ranges = {{7, 7}};  // of another row
  changed_ranges(held, bytes, ranges);
  return ranges;
}

}  // namespace

TEST(ChangedRanges, AreWholePiecesAndNeighboursAreOne) {
  const std::vector<std::byte> held = pattern(1500);
  std::vector<std::byte> bytes = held;
  EXPECT_TRUE(ranges_of(held, bytes).empty());
  EXPECT_TRUE(ranges_of(held, {}).empty());
  EXPECT_TRUE(ranges_of(held, std::span(bytes).first(700)).empty()) << "what is held behind them does not matter";
  for (const size_t at : {256u, 700u, 1499u}) bytes[at] ^= std::byte(1);
  EXPECT_EQ(ranges_of(held, bytes), (std::vector<ByteRange>{{256, 512}, {1280, 220}}));
  EXPECT_EQ(ranges_of({}, bytes), (std::vector<ByteRange>{{0, 1500}}));
  EXPECT_EQ(ranges_of(held, pattern(1600)), (std::vector<ByteRange>{{1280, 320}})) << "they are longer";
}

// Whatever was held, copying the ranges leaves the bytes there.
TEST(ChangedRanges, AreAllThatDiffers) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::byte> held = pattern(random() % 3000), bytes = pattern(random() % 3000);
    for (uint32_t i = random() % 5; i > 0 && !bytes.empty(); --i) bytes[random() % bytes.size()] ^= std::byte(0x10);
    size_t end = 0;
    const std::vector<ByteRange> ranges = ranges_of(held, bytes);
    held.resize(std::max(held.size(), bytes.size()));
    for (const ByteRange& range : ranges) {
      ASSERT_TRUE(range.count > 0 && (end == 0 || range.first > end)) << "in order and apart";
      end = range.first + range.count;
      ASSERT_LE(end, bytes.size());
      std::copy_n(bytes.begin() + ptrdiff_t(range.first), range.count, held.begin() + ptrdiff_t(range.first));
    }
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), held.begin()));
  }
}

}  // namespace candela::test
