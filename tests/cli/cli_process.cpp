#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "base/files.h"
#include "image/exr.h"
#include "program.h"

// What the system may do to the program: closed streams, limits, signals.
namespace candela::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

// candela behind a piece of shell, which has it as "$0" and the arguments as "$@".
Ended candela_in_shell(const std::string& shell, Arguments arguments) {
  arguments.insert(arguments.begin(), {"sh", "-c", shell, CANDELA_PROGRAM});
  return run_program(std::move(arguments));
}

TEST(ClosedStreams, NoLogLineLandsInAPicture) {
  TestFolder folder;
  // Every frame is blank, which is a warning for each.
  const Ended ended = candela_in_shell(
      "exec \"$0\" \"$@\" <&- >&- 2>&-",
      {"sequence", scene("unlit-box"), "--frames", "0-19", "--size", "16x16", "--eye", "0,0,100", "--target", "0,0,200",
       "--exr-compression", "none", "-o", folder / "%02d.exr", "-o", folder / "%02d.png"});
  ASSERT_EQ(ended.code, 0);
  ASSERT_EQ(files_in(folder.path()).size(), 40u);
  for (int frame = 0; frame < 20; ++frame) {
    const auto bytes = read_file(folder / (std::to_string(frame / 10) + std::to_string(frame % 10) + ".exr"));
    const auto image = decode_exr(*bytes, "frame", true);
    EXPECT_TRUE(image) << image.error().text();
  }
  EXPECT_EQ(candela_in_shell("exec \"$0\" \"$@\" >&-", {"list", "knobs"}).code, 5);
}

TEST(Resume, AFileWithBytesAfterItsEndIsDamaged) {
  TestFolder folder;
  const Arguments arguments = {
      "sequence", scene("unlit-box"), "--frames", "0-2",    "--size", "16x16", "-o", folder / "%d.exr",
      "-o",       folder / "%d.png",  "--resume", "--quiet"};
  ASSERT_EQ(candela(arguments).code, 0);
  const std::string exr = bytes_of(folder / "0.exr"), png = bytes_of(folder / "1.png");
  std::ofstream(folder / "0.exr", std::ios::app) << "warning: the frame is blank\n";
  std::ofstream(folder / "1.png", std::ios::app) << "w";
  ASSERT_EQ(candela(arguments).code, 0);
  EXPECT_TRUE(bytes_of(folder / "0.exr") == exr);
  EXPECT_TRUE(bytes_of(folder / "1.png") == png);
}

TEST(Limits, AFileSizeLimitIsExitFive) {
  TestFolder folder;
  const Arguments common = {scene("unlit-box"), "--size", "128x72", "--exr-compression", "none", "-o",
                            folder / "a.exr"};
  Arguments traced = {"reference", "--spp", "1"}, drawn = {"render"};
  traced.insert(traced.end(), common.begin(), common.end());
  drawn.insert(drawn.end(), common.begin(), common.end());
  const Ended file = candela_in_shell("ulimit -f 8; exec \"$0\" \"$@\"", traced);
  EXPECT_EQ(file.code, 5) << file.err;
  EXPECT_NE(file.err.find("File too large"), std::string::npos) << file.err;
  // The driver's memory is a file as well.
  const Ended driver = candela_in_shell("ulimit -f 8; exec \"$0\" \"$@\"", drawn);
  EXPECT_EQ(driver.code, 5) << driver.err;
  EXPECT_NE(driver.err.find("error: "), std::string::npos) << driver.err;
  EXPECT_TRUE(files_in(folder.path()).empty());
}

// A small stack is no obstacle, and a driver that gets too few addresses ends in a message.
TEST(Limits, SmallStacksAndAddressSpaces) {
  TestFolder folder;
  const Arguments render = {"render", scene("unlit-box"), "--size", "16x16", "--quiet", "-o", folder / "a.png"};
  const Ended stack = candela_in_shell("ulimit -s 64; exec \"$0\" \"$@\"", render);
  EXPECT_EQ(stack.code, 0) << stack.err;
  fs::remove(folder / "a.png");
  for (const char* limit : {"200000", "300000"}) {
    const Ended small =
        candela_in_shell(std::string("ulimit -c 0; ulimit -v ") + limit + "; exec \"$0\" \"$@\"", render);
    EXPECT_EQ(small.code, 6) << limit << small.err;
    EXPECT_NE(small.err.find("memory ran out"), std::string::npos) << small.err;
  }
  EXPECT_TRUE(files_in(folder.path()).empty());
}

// What was judged stays, and a line says how to go on.
TEST(Interrupts, GoldenCheckSaysHowToGoOn) {
  TestFolder folder;
  const std::string root = folder / "golden";
  fs::copy_file(scene("unlit-box"), folder / "a.glb");
  for (const char* name : {"a", "b", "c", "d", "e", "f"})
    ASSERT_EQ(candela({"golden", "add", "a.glb", "--size", "16x16", "--name", name, "--quiet"}, folder.path()).code, 0);
  const std::string err = folder / "err";
  const int process = start_candela({"golden", "check", "--root", root}, folder / "out", err);
  for (int i = 0; i < 600 && bytes_of(err).find("a: identical") == std::string::npos; ++i) usleep(10'000);
  kill(process, SIGTERM);
  int status = 0;
  waitpid(process, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << bytes_of(err);
  EXPECT_NE(bytes_of(err).find("the same command with --from-golden "), std::string::npos) << bytes_of(err);
  EXPECT_NE(bytes_of(folder / "out").find("not looked at: interrupted"), std::string::npos);
  EXPECT_EQ(candela({"golden", "check", "--root", root, "--from-golden", "f", "--quiet"}).code, 0);
}

// A file of many small parts takes at most 40 times its size.
TEST(Limits, ManyMaterialsFitIntoMemory) {
  TestFolder folder;
  std::string text = R"({"asset":{"version":"2.0"},"nodes":[{}],"scenes":[{"nodes":[0]}],"materials":[{})";
  for (int i = 0; i < 50'000; ++i)
    text +=
        R"(,{"name":"m)" + std::to_string(i) +
        R"(","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0.125,1],"metallicFactor":0,"roughnessFactor":0.5}})";
  std::ofstream(folder / "many.gltf") << text << "]}";
  const Ended ended = candela_in_shell(
      "ulimit -c 0; ulimit -v " + std::to_string(text.size() * 40 >> 10) + "; unset GLIBC_TUNABLES; exec \"$0\" \"$@\"",
      {"facts", folder / "many.gltf"});
  EXPECT_EQ(ended.code, 0) << ended.err;
}

// Starts candela and sends a signal once it holds signals (its handler is in place); how it ended, as waitpid says.
int interrupted_once_held(const Arguments& arguments, const std::string& err, int signal) {
  const int process = start_candela(arguments, "/dev/null", err);
  const auto holds = [&] {
    std::ifstream file("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(file, line);)
      if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1) != 0;
    return true;  // it has ended
  };
  while (!holds()) usleep(1'000);
  kill(process, signal);
  int status = 0;
  waitpid(process, &status, 0);
  return status;
}

TEST(Interrupts, SheetWritesNothingAndSaysSo) {
  TestFolder folder;
  ASSERT_EQ(candela({"render", scene("unlit-box"), "--size", "64x36", "--quiet", "-o", folder / "a.png"}).code, 0);
  Arguments arguments{"sheet"};
  arguments.insert(arguments.end(), 1000, folder / "a.png");
  arguments.insert(arguments.end(), {"-o", folder / "sheet.png", "--tile", "8x8"});
  const int status = interrupted_once_held(arguments, folder / "err", SIGINT);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << status << bytes_of(folder / "err");
  EXPECT_NE(bytes_of(folder / "err").find("the same command begins again"), std::string::npos);
  EXPECT_EQ(files_in(folder.path()), (Arguments{"a.png", "err"}));
}

TEST(Interrupts, MakeSceneLeavesAWholeSceneOrNone) {
  TestFolder folder;
  const Arguments arguments{"make-scene", "light-field", "--lights", "20000", "-o", folder / "a.glb"};
  const int status = interrupted_once_held(arguments, folder / "err", SIGINT);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << status << bytes_of(folder / "err");
  EXPECT_NE(bytes_of(folder / "err").find("interrupted, but the scene is whole"), std::string::npos);
  const std::string interrupted = bytes_of(folder / "a.glb");
  ASSERT_EQ(candela(arguments).code, 0);
  EXPECT_TRUE(interrupted == bytes_of(folder / "a.glb"));
  // A kill leaves no half scene under the name that was asked for, and the same command makes it.
  fs::remove(folder / "a.glb");
  const int killed = interrupted_once_held(arguments, folder / "err", SIGKILL);
  EXPECT_TRUE(WIFSIGNALED(killed));
  EXPECT_TRUE(!fs::exists(folder / "a.glb") || bytes_of(folder / "a.glb") == interrupted);
  EXPECT_EQ(candela({"make-scene", "light-field", "-o", folder / "a.glb"}).code, 0);
  for (const std::string& name : files_in(folder.path())) EXPECT_NE(name[0], '.') << name;
}

TEST(Names, TheLongestLegalOneIsWrittenAndALongerOneRefusedBeforeRendering) {
  TestFolder folder;
  const std::string name = std::string(251, 'n') + ".png";
  const Ended fits = candela({"render", scene("unlit-box"), "--size", "16x16", "-o", folder / name});
  EXPECT_EQ(fits.code, 0) << fits.err;
  const Ended longer = candela({"render", scene("unlit-box"), "--size", "16x16", "-o", folder / ("n" + name)});
  EXPECT_EQ(longer.code, 5) << longer.err;
  EXPECT_EQ(longer.err.find("device"), std::string::npos) << longer.err;
}

TEST(Video, NoEndLeavesATemporaryForEver) {
  if (run_program({"ffmpeg", "-version"}).code != 0) GTEST_SKIP() << "ffmpeg is not installed";
  TestFolder folder;
  const Arguments endless = {"sequence", scene("animated"), "--frames", "0-9999",        "--size",
                             "64x36",    "--quiet",         "--video",  folder / "a.mp4"};
  ASSERT_TRUE(candela_killed_after(endless, 900, SIGHUP));
  for (const std::string& name : files_in(folder.path())) EXPECT_EQ(name, "a.mp4.frames");
  ASSERT_TRUE(candela_killed_after(endless, 900, SIGKILL));
  // ffmpeg has the last word on what it was given; then a temporary lies there.
  ASSERT_EQ(candela({"sequence", scene("animated"), "--frames", "0-1", "--size", "64x36", "--quiet", "--video",
                     folder / "a.mp4"})
                .code,
            0);
  EXPECT_EQ(files_in(folder.path()), (Arguments{"a.mp4"}));
}

Arguments film_of_200(const std::string& video) {
  return {"sequence",  scene("animated"), "--frames", "0-199",   "--size", "64x36",
          "--quality", "draft",           "--quiet",  "--video", video};
}

size_t frames_beside(const std::string& video) {
  return fs::exists(video + ".frames") ? size_t(std::ranges::count_if(files_in(video + ".frames"),
                                                                      [](const std::string& n) { return n[0] != '.'; }))
                                       : 0;
}

// However a run ends, frames that were made are made no more, and the film is the one of an uninterrupted run.
TEST(Video, GoesOnFromTheFramesThatAreThere) {
  if (run_program({"ffmpeg", "-version"}).code != 0) GTEST_SKIP() << "ffmpeg is not installed";
  TestFolder folder;
  const std::string whole = folder / "whole.mp4", film = folder / "film.mp4";
  ASSERT_EQ(candela(film_of_200(whole)).code, 0);
  Arguments again = film_of_200(film);
  again.insert(again.end(), {"--resume", "--json"});
  size_t there = 0;
  for (const auto& [frame, signal] : std::vector<std::pair<int, int>>{{33, SIGKILL}, {80, SIGINT}, {120, SIGKILL}}) {
    const std::string file = film + ".frames/" + std::to_string(1000000 + frame).substr(1) + ".png";
    ASSERT_TRUE(candela_killed_once_written(again, file, signal)) << frame;
    EXPECT_FALSE(fs::exists(film));
    EXPECT_GT(frames_beside(film), std::max(there, size_t(frame)));
    there = frames_beside(film);
  }
  const Ended ended = candela(again);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json result = Json::parse(ended.out);
  EXPECT_EQ(result["skipped"], there);
  EXPECT_EQ(result["rendered"], 200 - there);
  EXPECT_EQ(bytes_of(film), bytes_of(whole));
  EXPECT_EQ(files_in(folder.path()), (Arguments{"film.mp4", "whole.mp4"}));
}

// A frame that is damaged, or of another picture, is made again; those that a killed run left out of order are used.
TEST(Video, TakesNoFrameThatIsNotOfThisFilm) {
  if (run_program({"ffmpeg", "-version"}).code != 0) GTEST_SKIP() << "ffmpeg is not installed";
  TestFolder folder;
  const std::string film = folder / "film.mp4", kept = film + ".frames/";
  const auto sequence = [&](const std::string& to, const Arguments& more) {
    Arguments words = {"sequence", scene("animated"), "--frames", "0-5", "--size", "64x36", "--json", "--quiet"};
    words.insert(words.end(), {"--video", to});
    words.insert(words.end(), more.begin(), more.end());
    return candela(words);
  };
  ASSERT_EQ(sequence(folder / "whole.mp4", {}).code, 0);
  ASSERT_EQ(
      candela({"sequence", scene("animated"), "--frames", "1-4", "--size", "64x36", "-o", kept + "%06d.png"}).code, 0);
  ASSERT_EQ(candela({"sequence", scene("animated"), "--frames", "5", "--size", "64x36", "--exposure", "1", "-o",
                     kept + "%06d.png"})
                .code,
            0);
  fs::resize_file(kept + "000001.png", fs::file_size(kept + "000001.png") / 2);
  const Ended ended = sequence(film, {"--resume"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(Json::parse(ended.out)["skipped"], 3);
  EXPECT_EQ(bytes_of(film), bytes_of(folder / "whole.mp4"));
  EXPECT_FALSE(fs::exists(kept));
}

// With PNG files of its own a film needs no others, and these stay.
TEST(Video, GoesOnFromItsOwnPngFiles) {
  if (run_program({"ffmpeg", "-version"}).code != 0) GTEST_SKIP() << "ffmpeg is not installed";
  TestFolder folder;
  const Arguments words = {"sequence",       scene("animated"), "--frames", "0-5",     "--size",         "64x36",
                           "--json",         "--quiet",         "--resume", "--video", folder / "a.mp4", "-o",
                           folder / "%d.png"};
  ASSERT_EQ(candela(words).code, 0);
  const std::string whole = bytes_of(folder / "a.mp4");
  fs::remove(folder / "a.mp4"), fs::remove(folder / "3.png");
  const Ended ended = candela(words);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(Json::parse(ended.out)["rendered"], 1);
  EXPECT_EQ(bytes_of(folder / "a.mp4"), whole);
  EXPECT_EQ(files_in(folder.path()), (Arguments{"0.png", "1.png", "2.png", "3.png", "4.png", "5.png", "a.mp4"}));
}

}  // namespace
}  // namespace candela::test
