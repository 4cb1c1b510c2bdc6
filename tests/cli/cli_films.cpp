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

bool without_ffmpeg() { return run_program({"ffmpeg", "-version"}).code != 0; }

Ended see_through_film(const std::string& film, const Arguments& more) {
  Arguments words = {"sequence", scene("unlit-box"), "--frames", "0-1", "--size", "64x36", "--quiet"};
  words.insert(words.end(), {"--video", film});
  words.insert(words.end(), more.begin(), more.end());
  return candela(words);
}

// The film holds the picture's pixels with their alpha, and one of frames that are there is the same film.
TEST(Film, KeepsAlphaWhereItsCodecHasIt) {
  if (without_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const TestFolder folder;
  const std::string frames = folder / "frames/%04d.png", film = folder / "film.mkv", again = folder / "again.mkv";
  const Ended made = see_through_film(film, {"--video-codec", "ffv1", "-o", frames});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(made.err, "");
  const std::string still = folder / "still.png";
  ASSERT_EQ(run_program({"ffmpeg", "-v", "error", "-i", film, "-frames:v", "1", "-pix_fmt", "rgba", still}).code, 0);
  const Ended same = candela({"compare", still, folder / "frames/0000.png", "--limit", "differing=0", "--json"});
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  ASSERT_EQ(candela({"film", frames, "-o", again, "--video-codec", "ffv1"}).code, 0);
  EXPECT_TRUE(bytes_of(again) == bytes_of(film));
}

TEST(Film, SaysThatH264LosesAlpha) {
  if (without_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const TestFolder folder;
  const Ended lost = see_through_film(folder / "a.mp4", {});
  EXPECT_EQ(lost.code, 0);
  EXPECT_NE(lost.err.find("H.264 has no alpha"), std::string::npos) << lost.err;
  EXPECT_EQ(see_through_film(folder / "b.mp4", {"--background", "white"}).err, "");
}

// Frames that have gone are named; the film is of those that are there.
TEST(Film, IsMadeOfWhatIsThere) {
  if (without_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const TestFolder folder;
  ASSERT_EQ(candela({"sequence", scene("unlit-box"), "--frames", "0-4", "--size", "64x36", "--quiet", "-o",
                     folder / "frames/%04d.png"})
                .code,
            0);
  fs::remove(folder / "frames/0002.png");
  const Ended ended = candela({"film", folder / "frames", "-o", folder / "a.mov", "--video-codec", "prores4444"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.err.find("frames 2 are missing"), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("4 frames, 64x36"), std::string::npos) << ended.err;
}

}  // namespace candela::test::cli_films
