#include <set>

#include "frame_fixture.h"

namespace candela::test::frame_scenes {

class FrameScenes : public FrameTest {};

namespace {
constexpr WantedOutputs everything{.linear = true, .display = true};
}

// Every scene of the tree, all layers, linear and display, at 1 and 4 samples, under validation: no message, only
// finite pixels; and culling by the view's planes alone or by depth alone, which may change time only, changes no byte.
TEST_F(FrameScenes, RenderCleanAndFiniteWithAndWithoutCulling) {
  ASSERT_FALSE(scene_names().empty());
  for (const std::string& name : scene_names())
    for (const int samples : {1, 4}) {
      Job job = with_layers(job_for(scene(name), 64, 36, samples));
      const auto session = open(job, everything);
      ASSERT_TRUE(session) << name;
      const FrameResult result = render(*session, 0.4, true);
      for (const gpu::PassHash& hash : result.hashes)
        EXPECT_EQ(hash.nonfinite, 0u) << name << " " << hash.pass << " " << hash.resource;
      const Images with = images(result);
      std::set<std::string> layers;
      for (const Image& image : with) layers.insert(image.layer);
      EXPECT_EQ(layers.size(), 2 + job.layers.size()) << name;
      for (const char* layer : {"beauty", "depth", "normal", "albedo", "emission", "direct"})
        for (const float v : with[layer].values<float>()) ASSERT_TRUE(std::isfinite(v)) << name << " " << layer;
      size_t drawn = 0;
      for (const glm::vec4& p : with["beauty"].values<glm::vec4>()) drawn += p.w > 0 && p.x + p.y + p.z > 0;
      EXPECT_GT(drawn, 20u) << name;
      job.settings = {
          {"cull", "enabled", "0"}, {"occlusion_cull", "mode", "on"}, {"occlusion_cull", "first_share", "0.01"}};
      const Images otherwise = images_of(job, everything, 0.4);
      ASSERT_EQ(with.size(), otherwise.size());
      for (size_t i = 0; i < with.size(); ++i)
        EXPECT_TRUE(with.at(i) == otherwise.at(i)) << name << " " << with.at(i).layer << " differs by culling";
    }
}

// A layer asked for alone is the layer among all others: attachments and shader outputs fit for every choice of layers.
TEST_F(FrameScenes, EveryLayerAloneIsTheLayerAmongAll) {
  for (const std::string name : {"spheres", "unlit-box"}) {
    const Images all = images_of(with_layers(job_for(scene(name), 32, 18)));
    for (const std::string& layer : with_layers(Job{}).layers) {
      Job job = job_for(scene(name), 32, 18);
      job.layers = {layer};
      EXPECT_TRUE(images_of(job)[layer] == all[layer]) << name << " " << layer;
    }
  }
}

// Frame N alone, after other frames in the same session, and in a second session.
TEST_F(FrameScenes, AFrameIsTheSameHoweverItIsReached) {
  for (const std::string name : {"animated", "skinned", "morph", "alpha", "animation-pointer", "instanced"}) {
    const Job job = with_layers(job_for(scene(name), 96, 54, 4));
    const double time_s = 11 / 24.0;
    const auto alone = open(job, everything), sequence = open(job, everything);
    ASSERT_TRUE(alone && sequence) << name;
    const FrameResult first = render(*alone, time_s, true);
    const Images images_alone = images(first);
    for (const double other : {0.0, 1.7, 0.25}) render(*sequence, other, other > 1);
    const FrameResult later = render(*sequence, time_s, true);
    const FrameResult again = render(*sequence, time_s, true);
    EXPECT_EQ(first.plan_hash, later.plan_hash);
    for (const FrameResult* r : {&later, &again}) {
      EXPECT_EQ(images_alone, images(*r)) << name;
      ASSERT_EQ(first.hashes.size(), r->hashes.size());
      for (size_t i = 0; i < first.hashes.size(); ++i)
        EXPECT_EQ(first.hashes[i].hash, r->hashes[i].hash)
            << name << ": " << first.hashes[i].pass << " leaves another " << first.hashes[i].resource;
    }
  }
}

// The animation does move something, or the test above would show nothing.
TEST_F(FrameScenes, OtherTimesGiveOtherFrames) {
  const auto session = open(job_for(scene("animated"), 64, 36));
  ASSERT_TRUE(session);
  EXPECT_NE(images(render(*session, 0)), images(render(*session, 0.5)));
}

// The same objects 1,000 km from the origin: only positions in the file round (to 1/16 m in float, and the scene is
// made of multiples of that), the camera-relative arithmetic is the same. On lavapipe nothing differs at all.
TEST_F(FrameScenes, TheFarWorldLooksLikeTheNearOne) {
  for (const int samples : {1, 4}) {
    // The texels of shadow maps lie on a grid of the world's, which a move by other than their size shifts.
    const auto seen = [&](const char* name) {
      Job job = job_for(scene(name), 160, 90, samples);
      job.effects = "none";
      return images_of(job, everything);
    };
    const Images near_world = seen("near-world"), far_world = seen("far-world");
    double linear = 0;
    const auto a = near_world["beauty"].values<float>(), b = far_world["beauty"].values<float>();
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) linear = std::max(linear, double(std::abs(a[i] - b[i])));
    const auto c = near_world["display"].values<uint8_t>(), d = far_world["display"].values<uint8_t>();
    int codes = 0;
    for (size_t i = 0; i < c.size(); ++i) codes = std::max(codes, std::abs(int(c[i]) - int(d[i])));
    RecordProperty("largest_linear_difference_" + std::to_string(samples), fmt::format("{:g}", linear));
    EXPECT_LE(codes, 1) << samples << " samples";
    EXPECT_LE(linear, 1e-6) << samples << " samples";
  }
}

// With shadows too, but for what a texel of their maps decides: their edges.
TEST_F(FrameScenes, TheFarWorldsShadowsAreTheNearOnes) {
  const Image near_world = images_of(job_for(scene("near-world"), 160, 90))["beauty"],
              far_world = images_of(job_for(scene("far-world"), 160, 90))["beauty"];
  size_t other = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 160; ++x)
      other += glm::length(near_world.at<glm::vec4>(x, y) - far_world.at<glm::vec4>(x, y)) > 1e-3f;
  EXPECT_LT(other, size_t(160 * 90 / 200));
}

// More than one group of 256 items in a run, most of them outside the view, with several pipelines.
TEST_F(FrameScenes, CullingAThousandItemsChangesNoByte) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int meshes[] = {add_square_mesh(b, 0.4f, add_material(b, diffuse_material(0.8, 0.3, 0.1))),
                        add_square_mesh(b, 0.4f, add_material(b, unlit_material(0.1, 0.5, 0.9))),
                        add_square_mesh(b, 0.3f, add_material(b, [] {
                                          Json m = diffuse_material(0.2, 0.9, 0.3);
                                          m["alphaMode"] = "BLEND";
                                          m["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
                                          return m;
                                        }()))};
  for (int i = 0; i < 1200; ++i)
    add_node(b, {{"mesh", meshes[i % 3]}, {"translation", {(i % 40) - 20.0, (i / 40) - 15.0, -(i % 7) * 0.5}}});
  Job job = job_for(write(b), 96, 54, 4);
  look(job, {3, 2, 6}, {2, 1, 0}, 60);
  const Images with = images_of(job, everything);
  job.settings.push_back({"cull", "enabled", "0"});
  EXPECT_EQ(with, images_of(job, everything));
}

}  // namespace candela::test::frame_scenes
