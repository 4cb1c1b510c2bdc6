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
    }
  }
}

}  // namespace candela::test
