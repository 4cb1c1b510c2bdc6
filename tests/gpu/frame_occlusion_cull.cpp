#include "frame_fixture.h"

namespace candela::test::frame_occlusion_cull {

// Frames with occlusion culling (passes/geometry/occlusion_cull.h) against the same frames without.
class OcclusionCulling : public FrameTest {
 protected:
  static constexpr WantedOutputs everything{.linear = true, .display = true};
  static Job culled(Job job, const std::string& mode, double fraction = 0.01) {
    job.settings.push_back({"occlusion_cull", "mode", mode});
    job.settings.push_back({"occlusion_cull", "first_share", fmt::format("{}", fraction)});
    return job;
  }
  // A wall that hides most of what is behind it, over and under which some is seen: opaque, unlit, masked and mirrored
  // squares behind and before it, blended ones among them.
  static std::string hall() {
    GltfBuilder b = empty_scene();
    use_materials(b);
    const int wall = add_square_mesh(b, 2, add_material(b, diffuse_material(0.6, 0.5, 0.4)));
    const auto with_mode = [&](Json m, const char* mode, double alpha) {
      m["alphaMode"] = mode;
      m["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
      return add_material(b, m);
    };
    const int meshes[] = {add_square_mesh(b, 0.15f, add_material(b, diffuse_material(0.8, 0.3, 0.1))),
                          add_square_mesh(b, 0.1f, add_material(b, unlit_material(0.1, 0.5, 0.9))),
                          add_square_mesh(b, 0.12f, with_mode(diffuse_material(0.3, 0.8, 0.2), "MASK", 0.9)),
                          add_square_mesh(b, 0.2f, with_mode(diffuse_material(0.2, 0.9, 0.3), "BLEND", 0.4))};
    add_node(b, {{"mesh", wall}});
    for (int i = 0; i < 720; ++i) {
      const double z = i % 20 == 7 ? 0.5 : -0.3 - 0.4 * (i % 11);
      add_node(b, {{"mesh", meshes[i % 4]},
                   {"translation", {(i % 36) * 0.2 - 3.6, (i / 36) * 0.25 - 2.5, z}},
                   {"scale", {i % 3 == 0 ? -1 : 1, 1, 1}}});
    }
    return write(b);
  }
  static Job in_hall(int samples) {
    Job job = job_for(hall(), 96, 54, samples);
    look(job, {0.4, 0.2, 5}, {0, 0, 0}, 50);
    return job;
  }
  // As the note of the frame says: in view, drawn first, after, hidden.
  static std::vector<int> counts(const FrameResult& result) {
    for (const std::string& note : result.notes)
      if (note.starts_with("occlusion culling")) {
        std::vector<int> numbers;
        for (size_t at = 0; at < note.size(); ++at)
          if (std::isdigit(note[at])) {
            numbers.push_back(std::stoi(note.substr(at)));
            while (at < note.size() && std::isdigit(note[at])) ++at;
          }
        return numbers;
      }
    return {};
  }
  // The counts of the frame with it.
  std::vector<int> expect_same(const Job& job, double fraction, const std::string& what) {
    const Images without = images_of(culled(job, "off"), everything, 0.7);
    const auto session = open(culled(job, "on", fraction), everything);
    if (!session) return {0, 0, 0, 0};
    const FrameResult result = render(*session, 0.7);
    const Images with = images(result);
    EXPECT_EQ(with.size(), without.size());
    for (size_t i = 0; i < with.size(); ++i)
      EXPECT_TRUE(with.at(i) == without.at(i)) << what << ": " << with.at(i).layer << " differs";
    std::vector<int> n = counts(result);
    EXPECT_EQ(n.size(), 4u) << what;
    n.resize(4);
    return n;
  }
};

TEST_F(OcclusionCulling, HidesItemsAndChangesNoByteWithAnyTechnique) {
  for (const auto& [technique, samples] :
       {std::pair("clustered", 4), {"forward-plus", 1}, {"deferred-clustered", 1}, {"visibility", 4}}) {
    Job job = in_hall(samples);
    job.technique = technique;
    const std::vector<int> n = expect_same(job, 0.01, technique);
    EXPECT_GT(n[0], 600) << technique;
    EXPECT_GT(n[3], 250) << technique;
    EXPECT_LE(n[1] + n[2], n[0]) << technique;
  }
}

TEST_F(OcclusionCulling, ChangesNoLayer) { EXPECT_GT(expect_same(with_layers(in_hall(4)), 0.01, "layers")[3], 250); }

// All are drawn first, or none.
TEST_F(OcclusionCulling, AnyFirstPhaseGivesTheSameBytes) {
  const std::vector<int> all = expect_same(in_hall(1), 0, "all"), none = expect_same(in_hall(1), 1, "none");
  EXPECT_GT(all[1], 400);
  EXPECT_GT(all[3], 250);
  EXPECT_EQ(none[1], 0);
  EXPECT_EQ(none[3], 0);
}

// Each picture of a supersampled frame has depths of its own; masks by sample; glass and blended surfaces together.
TEST_F(OcclusionCulling, ChangesNoByteOfSupersampledAndBlendedFrames) {
  Job super = in_hall(1);
  super.settings = {{"supersample", "n", "2"}};
  EXPECT_GT(expect_same(super, 0.01, "supersampled")[3], 250);
  Job masks = job_for(scene("alpha"), 64, 36, 4);
  masks.settings = {{"masks", "by_sample", "1"}};
  expect_same(masks, 0.01, "masks by sample");
  Job blended = in_hall(1), glass = job_for(scene("glass"), 64, 36);
  blended.transparency = "layers", glass.transparency = "phenomenological";
  EXPECT_GT(expect_same(blended, 0.01, "layers")[3], 250);
  expect_same(glass, 0.01, "phenomenological");
}

// Boxes around the camera and through its near plane.
TEST_F(OcclusionCulling, KeepsWhatReachesTheNearPlane) {
  for (const double z : {0.02, -1.5}) {
    Job job = in_hall(1);
    look(job, {0.3, 0.1, z}, {0.5, 0.1, z - 1}, 70);
    expect_same(job, 0.01, std::to_string(z));
  }
}

// Small scenes do without, with a reason, and so do rays of the camera.
TEST_F(OcclusionCulling, IsLeftOutWhereItDoesNotPay) {
  const auto reason = [](const Job& job) {
    const auto session = open(job);
    const FrameResult result = render(*session);
    for (const LeftOut& pass : result.plan->left_out)
      if (pass.pass == "occlusion_cull") return pass.reason;
    return std::string();
  };
  const Job job = job_for(scene("spheres"), 32, 18);
  EXPECT_NE(reason(job).find("too few"), std::string::npos) << reason(job);
  Job rays = culled(job, "on");
  rays.technique = "ray";
  EXPECT_NE(reason(rays).find("rays"), std::string::npos);
}

}  // namespace candela::test::frame_occlusion_cull
