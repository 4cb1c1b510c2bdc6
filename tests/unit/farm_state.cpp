#include "farm/farm_state.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/files.h"
#include "base/json.h"
#include "farm/writers.h"
#include "image/io.h"
#include "image/seal.h"
#include "render/outputs.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

RunRecord run(std::optional<int> code, const std::string& node = "n1") {
  return {.node = node, .updated_s = 1, .code = code};
}
ShardState shard(std::vector<RunRecord> runs) {
  return {.stage = ShardStage::failed, .frames = 1, .missing = {0}, .runs = std::move(runs)};
}

TEST(FarmRemedy, FollowsTheExitCode) {
  using Kind = Remedy::Kind;
  for (const int code : {2, 3, 7}) EXPECT_EQ(remedy_of(shard({run(code)})).kind, Kind::never) << code;
  for (const int code : {0, 1, 4, 5, 6, 127, 143}) EXPECT_EQ(remedy_of(shard({run(code)})).kind, Kind::again) << code;
  EXPECT_EQ(remedy_of(shard({})), Remedy());
  EXPECT_EQ(remedy_of(shard({run(5)})), Remedy());
  EXPECT_EQ(remedy_of(shard({run(4, "n1")})).exclude, std::set<std::string>{"n1"});
  EXPECT_EQ(remedy_of(shard({run(6)})).memory_factor, 2);
  EXPECT_EQ(remedy_of(shard({run(std::nullopt)})).memory_factor, 2);
  // What was learnt in earlier runs still holds.
  const Remedy both = remedy_of(shard({run(4, "n1"), run(6, "n2"), run(4, "n2"), run(6, "n3"), run(5)}));
  EXPECT_EQ(both.exclude, (std::set<std::string>{"n1", "n2"}));
  EXPECT_EQ(both.memory_factor, 4);
  ShardState running = shard({run(4)});
  running.stage = ShardStage::running;
  EXPECT_EQ(remedy_of(running).kind, Kind::wait);
  // A name that no engine gives is no word of a command.
  EXPECT_TRUE(remedy_of(shard({run(4, "n1 $(x)")})).exclude.empty());
}

class Farm : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("candela-farm-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
    job.name = "film";
    job.folder = folder / "job";
    job.work = folder;
    job.program = "candela";
    job.scene = "scene.glb";
    job.frames = "0-9";
    job.fps = "24";
    job.outputs = {"out/%02d.png"};
    job.arguments = {"scene.glb", "--frames", "0-9", "-o", "out/%02d.png"};
    job.shards = 3;
    fs::create_directories(folder / "out");
  }
  void TearDown() override { fs::remove_all(folder); }

  // A file whose header and length are right; its last byte is not.
  void put(int64_t frame, const std::string& device) {
    DisplayImage picture{.width = 1, .height = 1};
    picture.pixels.resize(3);
    const std::string identity =
        file_identity(job.job, "c0", device, "d", job.rate().seconds(frame), frame, job.rate());
    const fs::path file = job.files(frame)[0];
    ASSERT_TRUE(write_png(file, picture, {{identity_name, identity}, {std::string(seal_name), open_seal()}}));
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(-1, std::ios::end);
    stream.put('x');
  }
  void record(int index, std::optional<int> code, const std::string& device = "gpu") {
    RunRecorder recorder(farm_records(job.folder), {index, job.shards});
    recorder.opened("c0", device, "d", 3);
    recorder.progress(2, 1);
    if (code) recorder.end(*code, *code ? "it failed" : "");
  }

  fs::path folder;
  FarmJob job;
};

TEST_F(Farm, AJobIsReadAsItWasWritten) {
  job.name = "x";
  job.video = "film.mp4";
  job.engine_options = {"partition=a"};
  job.needs = {.cpus = 3, .memory_mb = 5, .gpus = 1, .minutes = 7};
  job.job.settings = {{"lights", "cap", "255"}};
  job.job.exposure_ev = -0.4f;
  ASSERT_TRUE(write_farm_job(job));
  ASSERT_TRUE(write_farm_job(job));  // the same again
  const auto read = read_farm_job(job.folder);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(farm_job_json(*read), farm_job_json(job));
  job.frames = "0-8";
  const auto other = write_farm_job(job);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().kind, ErrorKind::usage);
  std::ofstream(farm_job_file(job.folder)) << R"({"name": 3})";
  EXPECT_EQ(read_farm_job(job.folder).error().kind, ErrorKind::input);
  EXPECT_EQ(read_farm_job(folder).error().kind, ErrorKind::usage);
  // As many shards as nobody has frames for are refused before anything is made for them.
  job.frames = "0-9", job.shards = 1'000'000'000;
  std::ofstream(farm_job_file(job.folder)) << farm_job_json(job);
  EXPECT_EQ(read_farm_job(job.folder).error().kind, ErrorKind::input);
}

TEST_F(Farm, CountsWhatIsThereByWhatFilesSayThatTheyHold) {
  ASSERT_TRUE(write_farm_job(job));
  for (int frame = 0; frame < 10; ++frame) put(frame, "gpu");
  auto state = look_at_farm(job, {});
  ASSERT_TRUE(state);
  EXPECT_EQ(state->done, 0u) << "nobody has said yet on which device";
  record(1, 0);
  EXPECT_TRUE(look_at_farm(job, {})->complete());
  put(4, "another");  // shard 2 of 3: frames 1, 4, 7
  fs::remove(job.files(5)[0]);
  state = look_at_farm(job, {});
  EXPECT_EQ(state->done, 8u);
  EXPECT_EQ(state->missing, 1u);
  EXPECT_EQ(state->damaged, 1u) << "of another device";
  EXPECT_EQ(state->shards[1].damaged, std::vector<int64_t>{4});
  EXPECT_EQ(state->shards[1].missing, std::vector<int64_t>{4});
  EXPECT_EQ(state->shards[2].missing, std::vector<int64_t>{5});
  record(2, 4);
  state = look_at_farm(job, {});
  EXPECT_EQ(state->shards[1].stage, ShardStage::failed);
  EXPECT_EQ(state->failed, 0u);
  EXPECT_EQ(state->damaged, 1u);
  fs::remove(job.files(4)[0]);
  EXPECT_EQ(look_at_farm(job, {})->failed, 1u);
  put(4, "another");
  fs::resize_file(job.files(6)[0], fs::file_size(job.files(6)[0]) - 1);
  EXPECT_EQ(look_at_farm(job, {})->damaged, 2u) << "a shorter file";
  put(6, "gpu");
  record(3, std::nullopt);
  EXPECT_EQ(look_at_farm(job, {})->shards[2].stage, ShardStage::running);
  EXPECT_EQ(look_at_farm(job, {.lost_after_s = 0})->shards[2].stage, ShardStage::failed);
  record(1, 0, "another");
  EXPECT_EQ(look_at_farm(job, {})->done, 9u) << "two devices";
  EXPECT_EQ(look_at_farm(job, {.frames = FrameLook::whole})->done, 0u) << "none is a picture";
  job.shards = 4;
  EXPECT_TRUE(look_at_farm(job, {})->shards[1].runs.empty()) << "records of other shards";
}

TEST_F(Farm, ARunIsDeadWithItsProcess) {
  ASSERT_TRUE(write_farm_job(job));
  record(1, std::nullopt);
  const fs::path file = fs::directory_iterator(farm_records(job.folder))->path();
  const auto change = [&](const char* key, const nlohmann::json& value) {
    auto j = nlohmann::json::parse(std::ifstream(file));
    j[key] = value;
    std::ofstream(file) << j;
  };
  const auto stage = [&] { return look_at_farm(job, {})->shards[0].stage; };
  EXPECT_EQ(stage(), ShardStage::running);
  const ProcessIdentity self = this_process();
  EXPECT_EQ(life_of(self), Life::alive);
  change("process_start", "1");
  EXPECT_EQ(stage(), ShardStage::failed) << "the number of a process comes again";
  change("boot", "another");
  EXPECT_EQ(stage(), ShardStage::running) << "nobody here knows";
  change("updated", unix_seconds() + 86400);
  EXPECT_EQ(stage(), ShardStage::failed) << "dated ahead";
  change("updated", unix_seconds() - 86400);
  EXPECT_EQ(stage(), ShardStage::running) << "the file is new, whatever its writer's clock says";
  fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_EQ(stage(), ShardStage::failed);
}

TEST_F(Farm, CopiesOfARecordChangeNoRate) {
  ASSERT_TRUE(write_farm_job(job));
  record(1, 0);
  record(2, std::nullopt);
  const auto before = look_at_farm(job, {});
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(farm_records(job.folder))) files.push_back(entry.path());
  for (const fs::path& file : files) fs::copy_file(file, file.parent_path() / ("copy-" + file.filename().string()));
  const auto after = look_at_farm(job, {});
  EXPECT_GT(before->rendered_per_s, 0);
  EXPECT_EQ(before->rendered_per_s, after->rendered_per_s);
  EXPECT_EQ(after->shards[0].runs.size(), 1u);
  EXPECT_EQ(after->shards[1].runs.size(), 1u);
}

TEST_F(Farm, TakesNoRecordFromAFileThatIsNone) {
  ASSERT_TRUE(write_farm_job(job));
  std::ofstream(farm_records(job.folder) / "1of3-x-1-1.json") << "{";
  std::ofstream(farm_records(job.folder) / "2of3-x-1-1.json") << R"({"shard": "two"})";
  EXPECT_TRUE(read_run_records(farm_records(job.folder)).empty());
}

TEST_F(Farm, SlurmOptionsAreLinesOfTheirOwn) {
  job.engine_options = {"partition=night"};
  EXPECT_NE(slurm_file(job)->front().text.find("\n#SBATCH --partition=night\n"), std::string::npos);
  for (const char* wrong : {"", "-p x", "a=1\ntouch x", "array=1-9", "mem=3"}) {
    job.engine_options = {wrong};
    EXPECT_FALSE(slurm_file(job)) << wrong;
  }
  job.engine_options.clear();
  job.work = "a\nb";
  EXPECT_FALSE(make_file(job));
  EXPECT_TRUE(shell_file(job));
}

}  // namespace
}  // namespace candela
