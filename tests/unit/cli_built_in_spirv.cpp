#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "base/files.h"
#include "bench/scene_store.h"
#include "cli/golden_manifest.h"
#include "glsl/built_in_spirv.h"
#include "glsl/shader_compiler.h"
#include "glsl/shader_sources.h"
#include "plan/plan_frame.h"
#include "plan/posed_scene.h"
#include "plan/probe_image.h"
#include "testscenes/make_scene.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
const fs::path source = CANDELA_SOURCE_DIR;

std::vector<std::string> listed() {
  const auto text = read_file(source / "shaders/built_in.txt");
  EXPECT_TRUE(text);
  return glsl::listed_shaders({reinterpret_cast<const char*>(text->data()), text->size()});
}

class PlannedShaders {
 public:
  std::set<std::string> names;

  void add(const Job& job, const WantedOutputs& wanted, double time_s) {
    const auto scene = load_scene(job);
    ASSERT_TRUE(scene) << scene.error().text();
    add(job, *scene, wanted, time_s);
  }
  void add(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s) {
    const auto frame = plan_frame(job, scene, wanted, time_s);
    ASSERT_TRUE(frame) << job.scene << ": " << frame.error().text();
    add(frame->graph().plan);
    if (frame->facts.probes == 0) return;
    const auto probe = plan_frame(probe_job(job, frame->probes), scene, WantedOutputs{}, time_s);
    ASSERT_TRUE(probe) << job.scene << ": " << probe.error().text();
    add(probe->graph().plan);
  }

 private:
  void add(const FramePlan& plan) {
    for (const PipelineDesc& desc : plan.pipelines)
      if (const auto* compute = std::get_if<ComputePipelineDesc>(&desc)) {
        names.insert(compute->shader);
      } else {
        const auto& graphics = std::get<GraphicsPipelineDesc>(desc);
        names.insert(graphics.vertex_shader);
        if (!graphics.fragment_shader.empty()) names.insert(graphics.fragment_shader);
      }
  }
};

WantedOutputs files_of(bool exr) { return {.linear = exr, .display = !exr, .files = true}; }

}  // namespace

// A test of plans: what it finds missing costs time at the first use of the shader, and nothing else.
TEST(BuiltInSpirv, HoldsWhatPlansOfGoldensAndGeneratedScenesHold) {
  PlannedShaders planned;
  SceneStore made;
  const auto goldens = read_goldens(source / "golden", source / ".." / "shared" / "assets", "");
  ASSERT_TRUE(goldens) << goldens.error().text();
  for (const GoldenManifest& golden : *goldens) {
    if (golden.missing_assets) continue;
    Job job = golden.job;
    // Variants of a knob, method or layer that somebody has to ask for are compiled when they do.
    if (!job.settings.empty() || job.transparency != "auto" || job.shading != Job{}.shading || job.view != Job{}.view)
      continue;
    for (std::string* file : {&job.scene, &job.sky}) {
      if (!file->starts_with(made_prefix)) continue;
      const auto scene = made.generated(file->substr(made_prefix.size()), 1, 0);
      ASSERT_TRUE(scene) << scene.error().text();
      *file = file == &job.sky ? sky_beside(*scene).string() : *scene;
    }
    planned.add(job, files_of(golden.exr), golden.time_s);
  }
  for (const std::string_view name : scene_names()) {
    Job job;
    job.width_px = 64, job.height_px = 36;
    const auto file = made.generated(std::string(name), 1, 0);
    ASSERT_TRUE(file) << file.error().text();
    job.scene = *file;
    const auto scene = load_scene(job);
    ASSERT_TRUE(scene) << scene.error().text();
    for (const char* quality : {"draft", "normal", "high"})
      for (const bool exr : {false, true}) {
        job.quality = quality;
        planned.add(job, *scene, files_of(exr), 0);
      }
  }
  const glsl::ShaderCompiler compiler({}, {}, glsl::built_in_spirv());
  const std::vector<std::string> list = listed();
  std::string missing;
  for (const std::string& name : planned.names) {
    if (std::ranges::find(list, name) == list.end())
      missing += name + "\n";
    else
      EXPECT_TRUE(compiler.compile(name).value().built_in) << name << " is listed and not built in";
  }
  EXPECT_TRUE(missing.empty()) << "add these lines to shaders/built_in.txt and build again:\n" << missing;
}

TEST(BuiltInSpirv, IsWhatGlslangMakesOfTheEmbeddedSources) {
  const glsl::ShaderCompiler with({}, {}, glsl::built_in_spirv()), without;
  const std::vector<std::string> list = listed();
  ASSERT_GT(list.size(), 40u);
  for (size_t i = 0; i < list.size(); i += 3) {  // a sample: one rule made them all
    const auto built_in = with.compile(list[i]), compiled = without.compile(list[i]);
    ASSERT_TRUE(built_in && compiled) << list[i];
    EXPECT_TRUE(built_in->built_in) << list[i];
    EXPECT_FALSE(compiled->built_in) << list[i];
    EXPECT_EQ(built_in->spirv, compiled->spirv) << list[i];
    EXPECT_EQ(built_in->files, compiled->files) << list[i];
  }
}

TEST(BuiltInSpirv, AnEditedShaderIsCompiledAndNotTakenFromTheTable) {
  const fs::path folder = fs::path(::testing::TempDir()) / "candela-edited-shaders";
  fs::create_directories(folder / "lib");
  const glsl::ShaderCompiler compiler(folder, {}, glsl::built_in_spirv());
  const auto before = compiler.compile("light_scan.comp");
  ASSERT_TRUE(before) << before.error().text();
  EXPECT_TRUE(before->built_in);
  for (const glsl::EmbeddedShader& shader : glsl::embedded_shaders())
    if (shader.name == "light_scan.comp") {
      std::string text(shader.text);
      const size_t at = text.find("256");
      ASSERT_NE(at, std::string::npos);
      std::ofstream(folder / "light_scan.comp") << text.replace(at, 3, "128");
    }
  const auto edited = compiler.compile("light_scan.comp");
  ASSERT_TRUE(edited) << edited.error().text();
  EXPECT_FALSE(edited->built_in);
  EXPECT_NE(edited->spirv, before->spirv);
  // What it includes and what is defined are part of the key as well.
  EXPECT_FALSE(compiler.compile("tonemap.comp#NO_SUCH_NAME=1")->built_in);
  fs::remove_all(folder);
}

TEST(BuiltInSpirv, ATableGivesWhatWasPutInUnderItsKey) {
  std::vector<std::pair<Hash128, std::vector<uint32_t>>> shaders;
  for (uint32_t i = 0; i < 37; ++i)
    shaders.emplace_back(hash128(fmt::format("{}", i)), std::vector<uint32_t>(i + 1, i));
  shaders.push_back(shaders[5]);
  const std::vector<std::byte> table = glsl::spirv_table(shaders);
  for (const auto& [key, words] : shaders) EXPECT_EQ(glsl::find_spirv(table, key), words);
  EXPECT_FALSE(glsl::find_spirv(table, hash128("37")));
  EXPECT_FALSE(glsl::find_spirv({}, hash128("1")));
  EXPECT_FALSE(glsl::find_spirv(glsl::spirv_table({}), hash128("1")));
}

}  // namespace candela::cli
