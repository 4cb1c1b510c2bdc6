#include <cmath>
#include <fstream>
#include <sstream>

#include "job/frame_choices.h"
#include "job/frame_knobs.h"
#include "passes/post/vignette.h"
#include "passes_fixture.h"
#include "techniques/frame.h"
#include "techniques/technique.h"

namespace candela::gpu::test {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// What a newcomer copies from the page is what is compiled here.
TEST(ExamplePass, IsThatOfThePage) {
  const std::string page = text_of(CANDELA_SOURCE_DIR "/src/README.md");
  const std::filesystem::path folder = CANDELA_SOURCE_DIR "/tests/example_pass";
  for (const char* file : {"passes/post/vignette.h", "passes/post/vignette.cpp", "shaders/vignette.comp"}) {
    const std::string text = text_of(folder / file);
    ASSERT_FALSE(text.empty()) << file;
    EXPECT_NE(page.find("\n" + text + "```\n"), std::string::npos) << file << " differs from src/README.md";
  }
}

TEST(ExamplePass, IsListedWithItsKnobsAndItsLayer) {
  const std::vector<std::string> passes = pass_names(), layers = layer_names();
  EXPECT_EQ(std::ranges::count(passes, "vignette"), 1);
  EXPECT_EQ(std::ranges::count(layers, "vignette"), 1);
  Job job;
  job.settings = {{"vignette", "power", "4"}};
  const auto knobs = frame_knobs(job);
  ASSERT_TRUE(knobs) << knobs.error().text();
  EXPECT_EQ(knobs->get<Vignette::Knobs>().power, 4);
  job.settings = {{"vignette", "power", "9"}};
  EXPECT_FALSE(frame_knobs(job));
  for (const KnobRow& row : knob_rows("high"))
    if (row.pass == "vignette") EXPECT_EQ(row.passes, std::vector<std::string>{"vignette"}) << row.knob;
}

// The page's shader beside those of the tests.
class RunExamplePass : public PassTest {
 protected:
  void SetUp() override {
    PassTest::SetUp();
    if (!device) return;
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / "example-pass-shaders";
    fs::create_directories(folder);
    for (const fs::path& from : {shader_folder(), fs::path(CANDELA_SOURCE_DIR "/tests/example_pass/shaders")})
      fs::copy(from, folder, fs::copy_options::recursive);
    runner = std::make_unique<FrameRunner>(*device, *bindless, glsl::ShaderCompiler(folder), fs::path{});
  }
};

// Against the formula in double; with strength 0 the pass is left out and the picture goes on as it is.
TEST_F(RunExamplePass, GivesTheFormula) {
  constexpr uint32_t width = 12, height = 6;
  for (const char* strength : {"0.75", "0"}) {
    Job job;
    job.settings = {{"vignette", "strength", strength}, {"vignette", "power", "3"}};
    const auto knobs = frame_knobs(job);
    ASSERT_TRUE(knobs) << knobs.error().text();
    const SceneFacts facts;
    const FrameRequest request;
    GraphBuilder builder;
    Frame frame{builder, facts, request, *knobs, {}, {}};
    const ImageHandle source = add_fill(builder, "linear", width, height, 2);
    ImageHandle linear = source;
    linear = newest(frame.add(Vignette{}, {linear, width, height}).color, linear);
    if (std::string_view(strength) == "0") {
      EXPECT_EQ(linear.resource, source.resource);
      ASSERT_EQ(builder.left_out().size(), 1u);
      EXPECT_EQ(builder.left_out()[0].reason, "vignette.strength is 0");
      continue;
    }
    const BufferHandle picture = add_readback(builder, "picture", linear, width * height * sizeof(glm::vec4));
    const CompiledGraph graph = compile_graph(builder);
    const auto pixels = values_of<glm::vec4>(*run(graph).readbacks.at(picture.resource));
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        const double r = std::hypot((x + 0.5) / width * 2 - 1, (y + 0.5) / height * 2 - 1) / std::sqrt(2.0);
        EXPECT_NEAR(pixels[y * width + x].x, 2 * (1 - 0.75 * std::pow(r, 3)), 1e-5) << x << ", " << y;
      }
  }
}

}  // namespace
}  // namespace candela::gpu::test
