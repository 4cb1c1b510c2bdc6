#include <gtest/gtest.h>

#include <filesystem>

#include "program.h"

namespace candela::test::cli_films {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

// Frame 200 of a film has the same bytes alone, in order, backwards and in shards.
void expect_the_same_frames(const std::string& scene) {
  const TestFolder folder;
  const std::string file = folder / (scene + ".glb");
  ASSERT_EQ(candela({"make-scene", scene, "-o", file}).code, 0);
  const auto film = [&](const std::string& into, const std::string& frames, const Arguments& more = {}) {
    Arguments words = {"sequence",
                       file,
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

// The night of the city, with all its lights, cars, people and the blob.
TEST(CityFilm, AFrameIsTheSameAloneInOrderAndInShards) { expect_the_same_frames("city"); }

// The wall of the cave, whose relief moves, and the lamps that pass it.
TEST(CaveFilm, AFrameIsTheSameAloneInOrderAndInShards) { expect_the_same_frames("cave-film"); }

}  // namespace candela::test::cli_films
