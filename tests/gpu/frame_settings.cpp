#include <set>

#include "frame_fixture.h"

namespace candela::test {

// A session whose settings change makes the frames of sessions of their own.
class ChangedSettings : public FrameTest {
 protected:
  static Job job_with(const std::string& technique, const std::string& quality, int width,
                      std::vector<KnobSetting> settings = {}) {
    Job job = job_for(scene("street"), width, width * 2 / 3);
    job.technique = technique, job.quality = quality, job.settings = std::move(settings);
    return job;
  }
};

TEST_F(ChangedSettings, GiveTheBytesOfASessionOfTheirOwn) {
  const std::vector<Job> jobs = {job_with("clustered", "high", 48),
                                 job_with("visibility", "draft", 48),
                                 job_with("deferred-tiled", "normal", 24, {{"occlusion", "method", "traced"}}),
                                 job_with("ray", "high", 48, {{"occlusion", "rays", "4"}}),
                                 job_with("clustered", "high", 48, {{"supersample", "n", "2"}}),
                                 job_with("clustered", "high", 48)};
  const auto session = open(jobs.front());
  ASSERT_TRUE(session);
  std::set<Hash128> works;
  for (size_t i = 0; i < jobs.size(); ++i) {
    ASSERT_TRUE(session->set_settings(jobs[i])) << i;
    const auto work = session->work(0);
    ASSERT_TRUE(work) << i;
    EXPECT_EQ(works.insert(work->hash).second, i + 1 < jobs.size()) << i << ": the last does the work of the first";
    const FrameResult changed = render(*session, 0);
    const auto own = open(jobs[i]);
    ASSERT_TRUE(own);
    EXPECT_EQ(own->work(0)->hash, work->hash);
    EXPECT_EQ(images(changed), images(render(*own, 0))) << i;
  }
  EXPECT_FALSE(session->set_settings(job_with("no such technique", "high", 48)));
}

// Probes are drawn with the settings at hand.
TEST_F(ChangedSettings, DrawProbesAnew) {
  Job high = job_for(scene("spheres"), 32, 24);
  high.look = CANDELA_SOURCE_DIR "/bench/suites/probes.look.json";
  Job draft = high;
  draft.quality = "draft";
  const auto session = open(high);
  ASSERT_TRUE(session);
  render(*session, 0);
  ASSERT_TRUE(session->set_settings(draft));
  const FrameResult changed = render(*session, 0);
  const auto own = open(draft);
  ASSERT_TRUE(own);
  EXPECT_EQ(images(changed), images(render(*own, 0)));
}

}  // namespace candela::test
