#include <gtest/gtest.h>

#include <filesystem>

#include "program.h"

namespace candela::test::cli_city {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

// The night of the film city, with all its lights, cars, people and the blob: a frame has the same bytes alone, in
// order, backwards and in shards.
TEST(CityFilm, AFrameIsTheSameAloneInOrderAndInShards) {
  const TestFolder folder;
  ASSERT_EQ(candela({"make-scene", "city", "-o", folder / "city.glb"}).code, 0);
  const auto film = [&](const std::string& into, const std::string& frames, const Arguments& more = {}) {
    Arguments words = {"sequence",
                       folder / "city.glb",
                       "--size",
                       "64x36",
                       "--quality",
                       "draft",
                       "--frames",
                       frames,
                       "--fps",
                       "24",
                       "--quiet",
                       "-o",
                       folder / (into + "/%04d.png")};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
  };
  film("alone", "200");
  film("order", "198-201");
  film("back", "201,200,199");
  film("shards", "198-201", {"--shard", "1/2"});
  film("shards", "198-201", {"--shard", "2/2"});
  const std::string alone = bytes_of(folder / "alone/0200.png");
  ASSERT_FALSE(alone.empty());
  for (const char* into : {"order", "back", "shards"}) {
    EXPECT_TRUE(bytes_of(folder / (std::string(into) + "/0200.png")) == alone) << into;
    EXPECT_TRUE(bytes_of(folder / (std::string(into) + "/0199.png")) == bytes_of(folder / "order/0199.png")) << into;
  }
  EXPECT_NE(bytes_of(folder / "order/0199.png"), alone);
}

}  // namespace candela::test::cli_city
