// What sequence and render write from a frame that the device packed, against the same frame read back as texels.
#include "base/files.h"
#include "frame_fixture.h"
#include "image/io.h"
#include "render/outputs.h"

namespace candela::test {

class FrameFiles : public FrameTest {
 protected:
  struct Written {
    FloatImage exr;
    std::vector<std::byte> png;
    std::vector<std::string> warnings;
    uint64_t read_back = 0;  // bytes
  };
  static Written written(const Job& job, WantedOutputs wanted) {
    Written out;
    const auto session = open(job, wanted);
    if (!session) return out;
    FrameResult frame = render(*session);
    for (const auto& [resource, readback] : frame.readbacks) out.read_back += readback->bytes().size();
    const std::string stem = ::testing::TempDir() + "candela_files_" + (wanted.files ? "packed" : "texels");
    std::vector<std::filesystem::path> paths;
    if (wanted.linear) paths.push_back(stem + ".exr");
    if (wanted.display) paths.push_back(stem + ".png");
    const auto done = write_outputs(frame, job, *session, 0, FrameRate{}, paths);
    EXPECT_TRUE(done) << done.error().text();
    out.warnings = frame.warnings;
    if (wanted.linear) out.exr = read_image(stem + ".exr").value_or(FloatImage{});
    if (wanted.display) out.png = read_file(stem + ".png").value_or(std::vector<std::byte>{});
    for (const auto& path : paths) std::filesystem::remove(path);
    return out;
  }
  static std::string text_of(const FloatImage& image, const std::string& name) {
    for (const MetadataEntry& entry : image.metadata)
      if (entry.name == name) return entry.text;
    return "absent";
  }
  static void expect_same(const Job& job, const std::string& of) {
    const Written packed = written(job, {.linear = true, .display = true, .display_bits = job.png_bits, .files = true});
    const Written texels = written(job, {.linear = true, .display = true, .display_bits = job.png_bits});
    EXPECT_EQ(packed.png, texels.png) << of;
    EXPECT_FALSE(packed.png.empty()) << of;
    EXPECT_EQ(packed.warnings, texels.warnings) << of;
    EXPECT_EQ(text_of(packed.exr, "candela:clamped"), text_of(texels.exr, "candela:clamped")) << of;
    EXPECT_EQ(text_of(packed.exr, "candela:identity"), text_of(texels.exr, "candela:identity")) << of;
    ASSERT_EQ(packed.exr.channels.size(), texels.exr.channels.size()) << of;
    for (size_t i = 0; i < packed.exr.channels.size(); ++i) {
      const Channel &a = packed.exr.channels[i], &b = texels.exr.channels[i];
      EXPECT_EQ(a.name, b.name) << of;
      EXPECT_EQ(a.type, b.type) << of << " " << a.name;
      EXPECT_EQ(a.u, b.u) << of << " " << a.name;
      ASSERT_EQ(a.f.size(), b.f.size()) << of << " " << a.name;
      EXPECT_EQ(a.f.empty() ? 0 : std::memcmp(a.f.data(), b.f.data(), a.f.size() * 4), 0) << of << " " << a.name;
    }
  }
};

TEST_F(FrameFiles, HoldTheSameWhereverTheyArePacked) {
  for (const bool exact : {false, true})
    for (const int bits : {8, 16}) {
      Job job = with_layers(job_for(scene("alpha"), exact ? 61 : 63, 35, 4));
      job.exr_float = exact;
      job.png_bits = bits;
      job.exposure_ev = 1.3;  // which linear pictures carry, and files do not
      job.background = bits == 8 ? "transparent" : "0.1,0.2,0.3";
      expect_same(job, fmt::format("{} bits, {}", bits, exact ? "float" : "half"));
    }
}

// Brighter than halves: counted in the picture and in each layer that holds it.
TEST_F(FrameFiles, WhatHalvesDoNotHoldIsCountedAlike) {
  Job job = job_for(scene("unlit-box"), 63, 35);
  job.exposure_ev = 4;
  job.layers = {"emission", "direct"};
  job.background = "1e5,1,70000";
  expect_same(job, "a bright background");
  const Written packed = written(job, {.linear = true, .files = true});
  EXPECT_NE(text_of(packed.exr, "candela:clamped"), "absent");
}

TEST_F(FrameFiles, ALayerForTheScreenAloneIsInNoExr) {
  Job job = job_for(scene("spheres"), 63, 35);
  job.view = "heatmap_lights";
  expect_same(job, "a view");
  job.layers = {"heatmap_lights", "depth"};
  expect_same(job, "a view that is a layer too");
}

TEST_F(FrameFiles, NothingElseIsReadBack) {
  constexpr uint64_t width = 64, height = 36, counts = sizeof(shared::PackCounts);
  Job job = job_for(scene("alpha"), width, height);
  job.background = "0,0,0";
  EXPECT_EQ(written(job, {.linear = false, .display = true, .files = true}).read_back, width * height * 3 + 2 * counts);
  EXPECT_EQ(written(job, {.linear = true, .files = true}).read_back, width * height * 8 + counts);
  job.exr_float = true;
  EXPECT_EQ(written(job, {.linear = true, .files = true}).read_back, width * height * 16 + counts);
  job.allow_nonfinite = true;
  EXPECT_EQ(written(job, {.linear = false, .display = true, .files = true}).read_back, width * height * 3 + counts);
}

}  // namespace candela::test
