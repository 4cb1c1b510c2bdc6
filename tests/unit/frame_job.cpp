#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "job/background.h"
#include "job/job.h"
#include "session/timings.h"

namespace candela {
namespace {

Job rich_job() {
  Job job;
  job.scene = "a \"quoted\" name.glb";
  job.animation = "Walk";
  job.camera = {.eye = glm::dvec3(1.1, -2, 1e6 + 0.1), .target = glm::dvec3(0), .yfov_deg = 33.3, .camera = {}};
  job.width_px = 33, job.height_px = 17, job.samples = 1;
  job.quality = "exact";
  job.transparency = "weighted";
  job.variant = "beach", job.up = "z";
  job.region = PixelRect{-3, 2, 7, 5};
  job.overscan = {12.5, true};
  job.light_groups = {{"key", {"Sun", "Lamp*"}}, {"fill", {"Fill"}}};
  job.settings = {{"cull", "enabled", "0"}, {"a", "b", "-1.5"}};
  job.sky = "sky.hdr";
  job.look = "look.json";
  job.exposure_ev = 0.1f;
  job.tonemap = "neutral";
  job.layers = {"depth", "normal"};
  job.background = "0.1,0.2,0.3";
  job.seed = UINT64_MAX;
  job.exr_float = true, job.exr_compression = ExrCompression::piz, job.png_bits = 16, job.dither = false;
  job.timings_in_metadata = true, job.allow_nonfinite = true, job.view = "heatmap_waste";
  return job;
}

// The time before is part of the picture, by a layer or by a view alone.
TEST(JobJson, HoldsTheTimeOfMotion) {
  for (const bool layer : {false, true}) {
    Job job;
    job.motion_s = 1.0 / 60;
    if (layer)
      job.layers = {"motion"};
    else
      job.view = "motion";
    const auto again = job_from_json(job_json(job));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->motion_s, job.motion_s) << layer;
  }
}

TEST(JobJson, RoundTripsEveryMember) {
  for (const Job& job : {Job{}, rich_job()}) {
    const std::string text = job_json(job);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const auto again = job_from_json(text);
    ASSERT_TRUE(again) << again.error().text();
    EXPECT_EQ(job_json(*again), text);
  }
  const Job again = *job_from_json(job_json(rich_job()));
  EXPECT_EQ(again.camera.eye->z, 1e6 + 0.1);
  EXPECT_EQ(again.exposure_ev, 0.1f);
  EXPECT_EQ(again.seed, UINT64_MAX);
  EXPECT_EQ(again.variant, "beach");
  EXPECT_EQ(again.settings.size(), 2u);
}

// Each member changes the text: a member that is forgotten here would make two jobs look like one to --resume.
TEST(JobJson, TellsApartJobsThatDifferInOneMember) {
  std::set<std::string> texts;
  const auto add = [&](auto change) {
    Job job;
    change(job);
    EXPECT_TRUE(texts.insert(job_json(job)).second) << job_json(job);
  };
  add([](Job&) {});
  add([](Job& j) { j.scene = "x"; });
  add([](Job& j) { j.animation = "x"; });
  add([](Job& j) { j.camera.camera = "x"; });
  add([](Job& j) { j.region = PixelRect{0, 0, 1, 1}; });
  add([](Job& j) { j.overscan = {1, false}; });
  add([](Job& j) { j.overscan = {1, true}; });
  add([](Job& j) { j.light_groups = {{"x", {"y"}}}; });
  add([](Job& j) { j.camera.eye = glm::dvec3(1); });
  add([](Job& j) { j.camera.target = glm::dvec3(1); });
  add([](Job& j) { j.camera.yfov_deg = 1; });
  add([](Job& j) { j.width_px = 1; });
  add([](Job& j) { j.height_px = 1; });
  add([](Job& j) { j.samples = 1; });
  add([](Job& j) { j.technique = "x"; });
  add([](Job& j) { j.quality = "x"; });
  add([](Job& j) { j.settings = {{"a", "b", "c"}}; });
  add([](Job& j) { j.sky = "x"; });
  add([](Job& j) { j.look = "x"; });
  add([](Job& j) { j.exposure_ev = 1; });
  add([](Job& j) { j.tonemap = "x"; });
  add([](Job& j) { j.view = "x"; });
  add([](Job& j) { j.layers = {"x"}; });
  add([](Job& j) { j.background = "x"; });
  add([](Job& j) { j.up = "z"; });
  add([](Job& j) { j.seed = 1; });
  add([](Job& j) { j.exr_float = true; });
  add([](Job& j) { j.exr_compression = ExrCompression::none; });
  add([](Job& j) { j.png_bits = 16; });
  add([](Job& j) { j.dither = false; });
  add([](Job& j) { j.timings_in_metadata = true; });
  add([](Job& j) { j.allow_nonfinite = true; });
}

TEST(Sizes, HaveNamesToo) {
  const std::pair<const char*, std::pair<int, int>> sizes[] = {
      {"7x5", {7, 5}},         {"720p", {1280, 720}}, {"1080p", {1920, 1080}}, {"1440p", {2560, 1440}},
      {"2160p", {3840, 2160}}, {"4k", {3840, 2160}},  {"4K", {3840, 2160}},    {"8k", {7680, 4320}}};
  for (const auto& [text, size] : sizes) {
    const auto parsed = parse_size(text);
    ASSERT_TRUE(parsed) << text;
    EXPECT_EQ(*parsed, size) << text;
  }
  for (const char* text : {"", "p", "1080", "1080i", "4kx2k", "1080p "}) {
    const auto parsed = parse_size(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_NE(parsed.error().message.find("1080p"), std::string::npos);
  }
}

TEST(Backgrounds, AreColoursOfTheDisplayOrOfTheScene) {
  const auto display = [](const char* text) {
    const auto background = parse_background(text);
    EXPECT_TRUE(background && background->transparent()) << text;
    return background ? background->display_rgb : std::nullopt;
  };
  EXPECT_EQ(display("white"), 0xffffffu);
  EXPECT_EQ(display("Grey"), 0x808080u);
  EXPECT_EQ(display("#fff"), 0xffffffu);
  EXPECT_EQ(display("#1aF"), 0x11aaffu);
  EXPECT_EQ(display("#1e90ff"), 0x1e90ffu);
  EXPECT_EQ(display("transparent"), std::nullopt);
  const auto scene = parse_background("0.5,0,12");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->linear, (std::array<float, 4>{0.5f, 0, 12, 1}));
  EXPECT_FALSE(scene->transparent() || scene->display_rgb);
}

TEST(JobJson, NamesWhatIsWrong) {
  const auto message = [](const char* text) {
    const auto job = job_from_json(text);
    return job ? std::string() : job.error().text();
  };
  EXPECT_NE(message(R"({"tonemapp": "agx"})").find("did you mean 'tonemap'"), std::string::npos);
  EXPECT_NE(message(R"({"size": "12by13"})").find("/size"), std::string::npos);
  for (const char* text :
       {"[]", "{", R"({"samples": "4"})", R"({"samples": 4.5})", R"({"eye": [1, 2]})", R"({"seed": -1})",
        R"({"dither": 1})", R"({"set": ["a"]})", R"({"layers": "depth"})", R"({"exr-type": "double"})",
        R"({"exr-compression": "lz4"})", R"({"png-bits": 99999999999})"})
    EXPECT_FALSE(message(text).empty()) << text;
}

TEST(FrameIdentity, DependsOnWhatDecidesThePicture) {
  const std::string content = Hash128{1, 2}.hex();
  const Hash128 base = frame_identity(Job{}, content, "device", 0.5);
  Job other;
  other.seed = 1;
  EXPECT_NE(frame_identity(other, content, "device", 0.5), base);
  EXPECT_NE(frame_identity(Job{}, Hash128{1, 3}.hex(), "device", 0.5), base);
  EXPECT_NE(frame_identity(Job{}, content, "device 2", 0.5), base);
  EXPECT_NE(frame_identity(Job{}, content, "device", std::nextafter(0.5, 1.0)), base);
  Job moved;
  moved.scene = "elsewhere/scene.glb";
  EXPECT_EQ(frame_identity(moved, content, "device", 0.5), base);
}

TEST(CheckJob, SuggestsTheNearestName) {
  Job job;
  job.tonemap = "agxx";
  EXPECT_NE(check_job(job).error().message.find("did you mean 'agx'"), std::string::npos);
  job = {};
  job.layers = {"dpeth"};
  EXPECT_NE(check_job(job).error().message.find("did you mean 'depth'"), std::string::npos);
  job = {};
  job.technique = "raytrace";
  EXPECT_NE(check_job(job).error().message.find("brute-force"), std::string::npos);
  job = {};
  job.light_groups = {{"lamps", {"Lamp*"}}};
  job.view = "light_lmaps";
  EXPECT_NE(check_job(job).error().message.find("did you mean 'light_lamps'"), std::string::npos);
  EXPECT_NE(check_job(job).error().message.find("light_rest"), std::string::npos);
  for (const char* view : {"light_lamps", "light_rest", "depth"}) {
    job.view = view;
    EXPECT_TRUE(check_job(job)) << view;
  }
  job.light_groups.clear(), job.view = "light_lamps";
  EXPECT_FALSE(check_job(job));
  EXPECT_TRUE(check_job(Job{}));
}

TEST(CheckJob, RefusesValuesOutOfRange) {
  const auto refused = [](auto change) {
    Job job;
    change(job);
    const auto checked = check_job(job);
    return !checked && checked.error().kind == ErrorKind::usage;
  };
  EXPECT_TRUE(refused([](Job& j) { j.width_px = 0; }));
  EXPECT_TRUE(refused([](Job& j) { j.height_px = 20000; }));
  EXPECT_TRUE(refused([](Job& j) { j.samples = 3; }));
  EXPECT_TRUE(refused([](Job& j) { j.png_bits = 12; }));
  EXPECT_TRUE(refused([](Job& j) { j.exposure_ev = NAN; }));
  EXPECT_TRUE(refused([](Job& j) { j.camera.eye = glm::dvec3(0); }));
  EXPECT_TRUE(refused([](Job& j) { j.camera.yfov_deg = 180; }));
  EXPECT_TRUE(refused([](Job& j) { j.background = "1,2"; }));
  for (const char* color : {"#12", "#12345", "#gggggg", "whitest", "fff", "-1,0,0", "1,2,3,4", ""})
    EXPECT_TRUE(refused([&](Job& j) { j.background = color; })) << color;
  EXPECT_TRUE(refused([](Job& j) { j.up = "w"; }));
  EXPECT_TRUE(refused([](Job& j) { j.background = "1,2,nan"; }));
  EXPECT_TRUE(refused([](Job& j) { j.settings = {{"nopass", "x", "1"}}; }));
}

TEST(Trace, HasALaneForEachOfItsNames) {
  const std::vector<Timings::Span> spans = {{"load", "cpu", 10, 5}, {"shade", "gpu", 20, 3}, {"encode", "cpu", 30, 4}};
  const auto j = nlohmann::json::parse(trace_json(spans));
  int lanes = 0, complete = 0;
  for (const auto& event : j["traceEvents"]) (event["ph"] == "M" ? lanes : complete)++;
  EXPECT_EQ(lanes, 2);
  EXPECT_EQ(complete, 3);
}

TEST(TimingSums, AddUpByStage) {
  Timings timings;
  timings.add("load", 1);
  timings.add("wait", 2);
  timings.add("load", 3);
  EXPECT_EQ(timings.total("load"), 4);
  EXPECT_EQ(timings.cpu_ms.size(), 2u);
}

}  // namespace
}  // namespace candela
