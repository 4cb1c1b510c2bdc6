// Films whose plan stays: frames share a graph, ask the heap for nothing, and are the same as alone.
#include "frame_fixture.h"

namespace candela::test {

class FrameSteady : public FrameTest {
 protected:
  static std::unique_ptr<Session> open_film(const Job& job, const WantedOutputs& wanted = {}, bool validate = false) {
    RunSettings settings;
    settings.validate = validate;  // the layer has memory of its own
    settings.kept_bytes = uint64_t(64) << 20;
    auto session = Session::open(job, wanted, settings);
    EXPECT_TRUE(session) << session.error().text();
    return session ? std::move(*session) : nullptr;
  }
  static constexpr double frame_s = 1.0 / 24;
};

TEST_F(FrameSteady, AsksTheHeapForNothing) {
  const std::pair<std::string, std::string> films[] = {{"animated", "clustered"}, {"animated", "visibility"},
                                                       {"skinned", "clustered"},  {"metaballs", "clustered"},
                                                       {"glass", "clustered"},    {"spheres", "deferred-clustered"}};
  for (const auto& [name, technique] : films) {
    Job job = job_for(scene(name), 24, 16);
    job.technique = technique;
    const auto session = open_film(job, {.linear = true, .display = true, .files = true});
    ASSERT_TRUE(session);
    std::shared_ptr<const FramePlan> last;
    int steady = 0;
    for (int frame = 0; frame < 8; ++frame) {
      // Of bodies whose blocks come and go the buffers have met every size after a few frames.
      const FrameResult result = render(*session, (name == "metaballs" ? frame % 4 : frame) * frame_s);
      // The first frames of a plan find out how much memory they need, and where images outlive frames these come.
      if (frame >= 5 && result.plan == last) {
        EXPECT_EQ(result.timings.heap_allocations, 0u) << name << " " << technique << " frame " << frame;
        ++steady;
      }
      last = result.plan;
    }
    EXPECT_GE(steady, 2) << name << " " << technique << ": plans are made anew";
  }
}

TEST_F(FrameSteady, CountsWhatIsAsked) {
  const auto session = open_film(job_for(scene("spheres"), 48, 32));
  ASSERT_TRUE(session);
  EXPECT_GT(render(*session).timings.heap_allocations, 1000u) << "a plan is made";
}

// Numbers of the look that recording reads are those of the frame, whatever plan it shares.
TEST_F(FrameSteady, IsTheSameAsAlone) {
  Job job = job_for(scene("animated"), 48, 32);
  job.exr_float = true, job.tonemap = "agx";
  job.look = look_file(R"({
    "exposure": {"ev": {"keys": [[0, -1], [1, 2]]}, "auto": {"target": {"keys": [[0, 0.1], [1, 0.4]]}}},
    "bloom": {"strength": {"keys": [[0, 0.02], [1, 0.9]]}, "threshold": {"keys": [[0, 0], [1, 0.5]]}},
    "tone_mapping": {"agx_min_ev": {"keys": [[0, -12], [1, -8]]}},
    "occlusion": {"strength": {"keys": [[0, 0.2], [1, 1]]}},
    "volumetric": {"phi": {"keys": [[0, 0.5], [1, 3]]}, "tau": {"keys": [[0, 0.01], [1, 0.2]]}},
    "fog": {"scattering": {"keys": [[0, 0.01], [1, 0.1]]}}
  })");
  const WantedOutputs wanted{.linear = true, .display = true};
  for (const std::string technique : {"clustered", "visibility"}) {
    job.technique = technique;
    const auto film = open_film(job, wanted, true);
    ASSERT_TRUE(film);
    std::vector<Images> frames;
    std::shared_ptr<const FramePlan> last;
    int shared = 0;
    for (int frame = 0; frame < 5; ++frame) {
      const FrameResult result = render(*film, frame * 0.2);
      frames.push_back(images(result));
      shared += result.plan == last;
      last = result.plan;
    }
    EXPECT_GE(shared, 2) << technique;
    for (const int frame : {3, 4}) {
      const auto alone = open_film(job, wanted, true);
      ASSERT_TRUE(alone);
      EXPECT_EQ(images(render(*alone, frame * 0.2)), frames[size_t(frame)]) << technique << " frame " << frame;
      EXPECT_NE(frames[size_t(frame)], frames[size_t(frame) - 1]);
    }
  }
}

// Lamps that move, and maps of lamps that come into view and go, are no other frame to plan.
TEST_F(FrameSteady, LampsThatComeAndGoShareAPlan) {
  for (const std::string technique : {"clustered", "visibility"}) {
    Job job = job_for(scene("street"), 96, 64);
    job.technique = technique;
    job.settings = {{"local", "lights", "64"}};
    const auto film = open_film(job);
    ASSERT_TRUE(film);
    std::vector<Images> frames;
    std::vector<std::shared_ptr<const FramePlan>> plans;
    for (int frame = 0; frame < 8; ++frame) {
      const FrameResult result = render(*film, 1 + frame * frame_s);
      frames.push_back(images(result));
      if (std::ranges::find(plans, result.plan) == plans.end()) plans.push_back(result.plan);
    }
    EXPECT_LE(plans.size(), 3u) << technique;  // the first, with maps from before, and one more
    const auto alone = open_film(job);
    ASSERT_TRUE(alone);
    EXPECT_EQ(images(render(*alone, 1 + 7 * frame_s)), frames[7]) << technique;
  }
}

// The frames of a picture with a shutter go to and fro between two plans.
TEST_F(FrameSteady, PicturesOfSeveralFramesKeepBothPlans) {
  Job job = job_for(scene("animated"), 24, 16);
  job.shutter_s = frame_s / 2;
  job.settings = {{"subframes", "n", "5"}};
  const auto session = open_film(job);
  ASSERT_TRUE(session);
  std::vector<Images> pictures;
  for (int frame = 0; frame < 5; ++frame) {
    const FrameResult result = render(*session, frame * frame_s);
    pictures.push_back(images(result));
    if (frame >= 3) EXPECT_EQ(result.timings.heap_allocations, 0u) << frame;
  }
  const auto alone = open_film(job);
  ASSERT_TRUE(alone);
  EXPECT_EQ(images(render(*alone, 4 * frame_s)), pictures[4]);
}

}  // namespace candela::test
