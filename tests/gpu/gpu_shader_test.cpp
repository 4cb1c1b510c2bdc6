#include <fstream>
#include <thread>

#include "base/files.h"
#include "glsl/shader_sources.h"
#include "gpu/pipelines.h"
#include "gpu/workgroup_size.h"
#include "gpu_fixture.h"

namespace candela::gpu::test {

namespace fs = std::filesystem;

// A folder of its own for each test, gone afterwards.
class Shaders : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / fmt::format("candela-shaders-{}-{}",
                                                     ::testing::UnitTest::GetInstance()->random_seed(),
                                                     ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder / "lib");
  }
  void TearDown() override { fs::remove_all(folder); }
  void write(const char* name, const std::string& text) { std::ofstream(folder / name) << text; }
  static std::vector<fs::path> files_below(const fs::path& root) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(root))
      if (entry.is_regular_file()) files.push_back(entry.path());
    return files;
  }
  fs::path folder;
};

TEST_F(Shaders, EveryEmbeddedShaderCompiles) {
  const glsl::ShaderCompiler compiler;
  for (const glsl::EmbeddedShader& shader : glsl::embedded_shaders()) {
    const std::string ending = fs::path(shader.name).extension().string();
    // lib/ holds pieces that name the stage they are for ("draw.frag.glsl").
    if (ending != ".vert" && ending != ".frag" && ending != ".comp") continue;
    const auto result = compiler.compile(std::string(shader.name));
    EXPECT_TRUE(result) << result.error().text();
  }
}

TEST_F(Shaders, ErrorsNameFileLineAndTheIncludingChain) {
  write("a.comp", "#version 460\n#include \"lib/b.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() { f(); }\n");
  write("lib/b.glsl", "\n#include \"lib/c.glsl\"\n");
  write("lib/c.glsl", "void f() {\n  int x = unknown_thing;\n}\n");
  const auto result = glsl::ShaderCompiler(folder).compile("a.comp");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::input);
  EXPECT_EQ(result.error().place, "lib/c.glsl:2, included by lib/b.glsl:2, included by a.comp:2");
  EXPECT_NE(result.error().message.find("unknown_thing"), std::string::npos) << result.error().message;

  write("lib/b.glsl", "#include \"lib/gone.glsl\"\n");
  const auto missing = glsl::ShaderCompiler(folder).compile("a.comp");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().text(), "lib/b.glsl:1, included by a.comp:2: cannot find \"lib/gone.glsl\"");
  const auto absent = glsl::ShaderCompiler(folder).compile("none.comp");
  ASSERT_FALSE(absent);
  EXPECT_NE(absent.error().text().find("none.comp: there is no such shader"), std::string::npos);
}

TEST_F(Shaders, IncludesAFileWithPragmaOnceOnce) {
  write("a.comp",
        "#version 460\n#include \"lib/b.glsl\"\n#include \"lib/b.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() { "
        "f(); }\n");
  write("lib/b.glsl", "#pragma once\nvoid f() {}\n");
  const auto result = glsl::ShaderCompiler(folder).compile("a.comp");
  EXPECT_TRUE(result) << result.error().text();
}

TEST_F(Shaders, ASecondCompileComesFromTheCacheAndADamagedFileIsMadeAgain) {
  write("a.comp", "#version 460\n#include \"lib/b.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() { f(); }\n");
  write("lib/b.glsl", "void f() {}\n");
  const fs::path cache = folder / "cache";
  const glsl::ShaderCompiler compiler(folder, cache);
  const auto first = compiler.compile("a.comp");
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_FALSE(first->from_cache);
  EXPECT_EQ(first->files, (std::vector<std::string>{"a.comp", "lib/b.glsl"}));
  const auto second = compiler.compile("a.comp");
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->from_cache);
  EXPECT_EQ(second->spirv, first->spirv);

  ASSERT_EQ(files_below(cache).size(), 1u);
  const fs::path file = files_below(cache)[0];
  {
    std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekp(40);
    damaged.put('\x55');
  }
  const auto third = compiler.compile("a.comp");
  ASSERT_TRUE(third);
  EXPECT_FALSE(third->from_cache);
  EXPECT_EQ(third->spirv, first->spirv);
  fs::resize_file(file, 7);
  EXPECT_FALSE(compiler.compile("a.comp")->from_cache);
  EXPECT_TRUE(compiler.compile("a.comp")->from_cache);

  write("lib/b.glsl", "void f() { }\n");  // an included file is part of the key
  EXPECT_FALSE(compiler.compile("a.comp")->from_cache);
}

TEST_F(Shaders, AWholeCacheFileUnderAnotherKeysNameIsNotTaken) {
  write("a.comp", "#version 460\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
  write("b.comp", "#version 460\nlayout(local_size_x = 2) in;\nvoid main() {}\n");
  const fs::path cache = folder / "cache";
  const glsl::ShaderCompiler compiler(folder, cache);
  ASSERT_TRUE(compiler.compile("a.comp"));
  const fs::path file_of_a = files_below(cache).at(0);
  const auto b = compiler.compile("b.comp");
  ASSERT_TRUE(b);
  for (const fs::path& file : files_below(cache))
    if (file != file_of_a) fs::copy_file(file_of_a, file, fs::copy_options::overwrite_existing);
  const auto again = compiler.compile("b.comp");
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->from_cache);
  EXPECT_EQ(again->spirv, b->spirv);
}

TEST_F(Shaders, WorkgroupSizeComesFromTheCodeAndItsConstants) {
  const glsl::ShaderCompiler compiler(shader_folder());
  EXPECT_EQ(workgroup_size(compiler.compile("fill.comp")->spirv, {}), (std::array<uint32_t, 3>{8, 4, 1}));
  const auto sized = compiler.compile("sized.comp");
  ASSERT_TRUE(sized) << sized.error().text();
  EXPECT_EQ(workgroup_size(sized->spirv, {}), (std::array<uint32_t, 3>{1, 2, 1}));
  const std::vector<SpecConstant> constants{{3, "X", 16}, {4, "Z", 5}};
  EXPECT_EQ(workgroup_size(sized->spirv, constants), (std::array<uint32_t, 3>{16, 2, 5}));
  EXPECT_EQ(workgroup_size(compiler.compile("flat.frag")->spirv, {}), (std::array<uint32_t, 3>{0, 0, 0}));
}

TEST_F(Shaders, PipelinesAreMadeOnceAndTheirCacheSurvivesDamage) {
  const auto device = Device::open({.validate = true});
  ASSERT_TRUE(device) << device.error().text();
  const std::vector<PipelineDesc> wanted{ComputePipelineDesc{.shader = "fill.comp"},
                                         GraphicsPipelineDesc{.vertex_shader = "fullscreen.vert",
                                                              .fragment_shader = "flat.frag",
                                                              .color_formats = {VK_FORMAT_R8G8B8A8_UNORM}}};
  for (int round = 0; round < 3; ++round) {
    Bindless bindless(**device, 256u << round);  // layouts of its own, so that the device's store has none of them yet
    Pipelines pipelines(**device, bindless, glsl::ShaderCompiler(shader_folder(), folder), folder);
    PrepareTimes times;
    const auto first = pipelines.get(wanted, times);
    ASSERT_TRUE(first) << first.error().text();
    EXPECT_EQ(times.pipelines, 2);
    EXPECT_EQ(times.shaders, 3);
    EXPECT_EQ(times.shaders_from_cache, round == 0 ? 0 : 3);
    EXPECT_EQ(pipelines.get(wanted, times).value(), *first);
    EXPECT_EQ(times.pipelines, 2);
    const fs::path file = pipelines.cache_file();
    ASSERT_TRUE(fs::exists(file));
    // Nothing new, so nothing is written. Other drivers may put into the data what differs from run to run.
    const auto long_ago = fs::file_time_type{} + std::chrono::hours(1);
    if (round == 0) fs::last_write_time(file, long_ago);
    if ((*device)->info().device_class == "lavapipe") EXPECT_EQ(fs::last_write_time(file) == long_ago, round < 2);
    if (round == 1) std::ofstream(file) << "not a pipeline cache at all, but long enough to look like one";
  }
  PrepareTimes times;
  Bindless bindless(**device);
  const auto missing = Pipelines(**device, bindless, glsl::ShaderCompiler(shader_folder()), {})
                           .get(std::vector<PipelineDesc>{ComputePipelineDesc{.shader = "none.comp"}}, times);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().place, "none.comp");
  EXPECT_EQ((*device)->validation_messages(), std::vector<std::string>{});
}

// But for the first passes, which the frame reaches before. Once: then they are known. Only where nothing validates.
TEST_F(Shaders, WhatACpusDriverDoesNotKnowIsCompiledAhead) {
  std::vector<PipelineDesc> wanted;
  for (int i = 0; i < 6; ++i) {
    const std::string name = fmt::format("n{}.comp", i);
    write(name.c_str(), "#version 460\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
    wanted.push_back(ComputePipelineDesc{.shader = name});
  }
  for (const bool validates : {true, false}) {
    const auto device = Device::open({.validate = validates});
    ASSERT_TRUE(device) << device.error().text();
    const bool ahead = !validates && (*device)->info().is_cpu && std::thread::hardware_concurrency() > 1;
    for (uint32_t round = 0; round < 2; ++round) {
      Bindless bindless(**device, 256u << round);  // layouts of its own, as above
      Pipelines pipelines(**device, bindless, glsl::ShaderCompiler(folder), folder);
      PrepareTimes times;
      ASSERT_TRUE(pipelines.get(wanted, times));
      EXPECT_EQ(pipelines.compiled_ahead(), ahead && round == 0 ? 4u : 0u) << validates << " " << round;
    }
  }
}

TEST_F(Shaders, PipelinesOutliveWhoMadeThem) {
  const auto device = Device::open({.validate = true});
  ASSERT_TRUE(device) << device.error().text();
  constexpr uint32_t textures = 4096;  // as no other test of this program has
  const std::vector<PipelineDesc> wanted{ComputePipelineDesc{.shader = "fill.comp"}};
  const auto made = [&](const std::vector<PipelineDesc>& descs, const fs::path& sources) {
    Bindless bindless(**device, textures);
    Pipelines pipelines(**device, bindless, glsl::ShaderCompiler(sources), {});
    PrepareTimes times;
    EXPECT_TRUE(pipelines.get(descs, times));
    return times.pipelines;
  };
  EXPECT_EQ(made(wanted, shader_folder()), 1);
  EXPECT_EQ(made(wanted, shader_folder()), 0) << "the device's store has it";
  // Another constant, and another text under the same name, are other pipelines.
  EXPECT_EQ(made({ComputePipelineDesc{.shader = "fill.comp", .constants = {{7, "OTHER", 1}}}}, shader_folder()), 1);
  std::string text;
  std::getline(std::ifstream(shader_folder() / "fill.comp"), text, '\0');
  std::ofstream(folder / "fill.comp") << text << "// changed\n";
  EXPECT_EQ(made(wanted, folder), 1);
  EXPECT_EQ(made(wanted, shader_folder()), 0);
  // Of those that nobody uses only so many are kept.
  for (uint32_t i = 0; i <= PipelineStore::most_idle; ++i)  // the last one is in use while it is kept
    made({ComputePipelineDesc{.shader = "fill.comp", .constants = {{7, "OTHER", 100 + i}}}}, shader_folder());
  EXPECT_EQ(made(wanted, shader_folder()), 1);
  EXPECT_EQ((*device)->validation_messages(), std::vector<std::string>{});
}

}  // namespace candela::gpu::test
