#include "frame_fixture.h"

namespace candela::test {

// Frames that do not end in the time that a job gives them.
class FrameTimeout : public FrameTest {};

// A timed session draws its first frame once before it is timed, into maps that later frames keep. Where that run does
// not end in time the error names its passes; the device is waited for, and another session draws the frame.
TEST_F(FrameTimeout, InTheWarmUpNamesThePasses) {
  Job job = job_for(scene("street-dense"), 96, 54, 4);
  job.settings = {{"sun", "size_px", "512"}};
  RunSettings settings;
  settings.validate = true, settings.timed = true;
  settings.kept_bytes = uint64_t(64) << 20;
  const std::filesystem::path folder = ::testing::TempDir() + "candela_timeouts";
  std::filesystem::remove_all(folder);
  settings.timeout_folder = folder, settings.command = "candela render 'a scene.glb'";
  for (const double timeout_s : {1e-6, 600.0}) {
    settings.timeout_s = timeout_s;
    auto session = Session::open(job, {}, settings);
    ASSERT_TRUE(session) << session.error().text();
    for (int frame = 0; frame < 2; ++frame) {
      const auto result = (*session)->render(frame);
      ASSERT_EQ(result.has_value(), timeout_s == 600) << (result ? "in time" : result.error().text());
      if (result) continue;
      EXPECT_EQ(result.error().kind, ErrorKind::device);
      EXPECT_NE(result.error().message.find("did not end within"), std::string::npos) << result.error().text();
      EXPECT_NE(result.error().message.find("the device had come to the pass "), std::string::npos)
          << result.error().text();
      EXPECT_NE(result.error().message.find("not finished: "), std::string::npos) << result.error().text();
      // What shows why is kept, of each frame apart.
      const auto kept = folder / (frame == 0 ? "candela-timeout" : "candela-timeout-2");
      EXPECT_NE(result.error().message.find(kept.string() + " holds"), std::string::npos) << result.error().text();
      const auto text_of = [&](const char* name) {
        std::ifstream file(kept / name);
        return std::string(std::istreambuf_iterator<char>(file), {});
      };
      EXPECT_EQ(text_of("command.sh"), settings.command + "\n");
      EXPECT_NE(text_of("job.json").find("\"size\":\"96x54\""), std::string::npos) << text_of("job.json");
      EXPECT_NE(text_of("versions.txt").find((*session)->device().info().driver), std::string::npos);
      EXPECT_NE(text_of("plan.txt").find("shade_forward"), std::string::npos);
      EXPECT_NE(text_of("log.txt").find("did not end within"), std::string::npos);
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace candela::test
