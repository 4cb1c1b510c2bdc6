#include <deque>

#include "frame_fixture.h"
#include "shared/scene.h"

namespace candela::test {

// Of what a frame uploads, only what the device does not hold is sent.
class WhatIsSent : public FrameTest {
 protected:
  static constexpr int squares = 400;
  // Squares and lights, of which two squares move, far apart in every table.
  static Job mostly_still() {
    GltfBuilder b = empty_scene();
    use_materials(b);
    const int mesh = add_square_mesh(b, 0.1, add_material(b, diffuse_material(0.6, 0.4, 0.2)));
    for (int i = 0; i < squares; ++i)
      add_node(b, {{"mesh", mesh}, {"translation", {0.2 * (i % 20) - 2, 0.2 * (i / 20) - 2, 0}}});
    for (int i = 0; i < 40; ++i)
      add_light(b, {{"type", "point"}, {"intensity", 1}, {"range", 2}}, {{"translation", {0.1 * i - 2, 0, 0.5}}});
    const int times = b.accessor<float>("SCALAR", {0, 1});
    const int places = b.accessor<float>("VEC3", {0, 0, 0, 0, 0, 0.3f});
    b.json["animations"] = {{{"samplers", {{{"input", times}, {"output", places}}}},
                             {"channels",
                              {{{"sampler", 0}, {"target", {{"node", 5}, {"path", "translation"}}}},
                               {{"sampler", 0}, {"target", {{"node", 395}, {"path", "translation"}}}}}}}};
    Job job = job_for(write(b), 32, 24);
    look(job, {0, 0, 4}, {0, 0, 0}, 60);
    return job;
  }
  // Of a fresh session.
  const Images& alone(const Job& job, double time_s) {
    const auto found = alone_.find(time_s);
    return found != alone_.end() ? found->second : alone_.emplace(time_s, images_of(job, {}, time_s)).first->second;
  }
  // Frames in this order, as many begun at once as `most`: what each sent. Their pictures are those of fresh sessions.
  std::vector<uint64_t> sent(const Job& job, const std::vector<double>& times, size_t most) {
    std::vector<uint64_t> bytes;
    const auto session = open(job);
    if (!session) return bytes;
    std::deque<std::pair<double, FrameTicket>> begun;
    const auto finish = [&] {
      const auto result = session->finish(begun.front().second);
      ASSERT_TRUE(result) << result.error().text();
      EXPECT_EQ(images(*result), alone(job, begun.front().first)) << "at " << begun.front().first << " s";
      bytes.push_back(result->timings.uploaded_bytes);
      begun.pop_front();
    };
    for (const double time_s : times) {
      const auto ticket = session->begin(time_s);
      EXPECT_TRUE(ticket) << ticket.error().text();
      if (!ticket) return bytes;
      begun.emplace_back(time_s, *ticket);
      if (begun.size() == most) finish();
    }
    while (!begun.empty()) finish();
    return bytes;
  }

 private:
  std::map<double, Images> alone_;  // by time, of the test's job
};

TEST_F(WhatIsSent, IsNothingForAFrameThatIsThere) {
  for (const size_t most : {1u, 2u, 3u}) {
    const std::vector<uint64_t> bytes = sent(mostly_still(), std::vector<double>(6, 0.0), most);
    ASSERT_EQ(bytes.size(), 6u);
    for (size_t frame = 0; frame < 6; ++frame)  // each frame in flight has buffers of its own
      if (frame < most)
        EXPECT_GT(bytes[frame], squares * sizeof(shared::Item)) << frame;
      else
        EXPECT_EQ(bytes[frame], 0u) << frame << ", " << most << " in flight";
  }
}

TEST_F(WhatIsSent, IsWhatMovesAndLittleMore) {
  for (const size_t most : {1u, 2u}) {
    const std::vector<uint64_t> bytes = sent(mostly_still(), {0, 0.25, 0.5, 0.75, 1, 1}, most);
    ASSERT_EQ(bytes.size(), 6u);
    for (size_t frame = most; frame < 5; ++frame) {
      EXPECT_GT(bytes[frame], 0u) << frame;
      EXPECT_LT(bytes[frame], 3072u) << frame << ": two pieces of each table in which the squares stand";
    }
    EXPECT_EQ(bytes[5] == 0, most == 1) << "the buffers of two in flight held the frame of 0.75 s";
  }
}

// Skins, morphs, and bytes of any frame over those of any other.
TEST_F(WhatIsSent, LeavesThePicturesAsTheyAreInAnyOrder) {
  Job job = job_for(scene("animated"), 32, 18);
  for (const size_t most : {1u, 2u, 3u}) {
    const std::vector<uint64_t> bytes = sent(job, {0.5, 0, 1.25, 1.25, 1.25, 1.25, 0, 0.5, 2}, most);
    ASSERT_EQ(bytes.size(), 9u);
    EXPECT_LT(bytes[5], bytes[0] / 100) << "it was sent for each of those in flight before";
  }
}

// The trees of what rays meet lie in one buffer, of which squares that move a little change a part.
TEST_F(WhatIsSent, IsAPartOfTheTreesForRays) {
  Job job = mostly_still();
  job.settings = {{"local", "method", "traced"}};
  for (const size_t most : {1u, 2u, 3u}) {
    const std::vector<uint64_t> bytes = sent(job, {0.5, 0.54, 0.58, 0.62, 0.62, 0.62, 0.62, 0.5}, most);
    ASSERT_EQ(bytes.size(), 8u);
    EXPECT_GT(bytes[0], squares * 64u) << "triangles and nodes";
    EXPECT_GT(bytes[3], 0u);
    EXPECT_LT(bytes[3], bytes[0] / 2) << most << " in flight";
    EXPECT_EQ(bytes[6], 0u);
  }
}

TEST_F(WhatIsSent, IsCountedFromTheStart) {
  const auto session = open(mostly_still());
  ASSERT_TRUE(session);
  EXPECT_GE(session->opening().uploaded_bytes, 4 * 3 * sizeof(float) + 6 * sizeof(uint32_t)) << "a square";
}

}  // namespace candela::test
