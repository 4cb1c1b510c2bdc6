// Shadows and occlusion that shading traces, against the CPU's rays at the same points: no pixel may differ but where
// the two stand at an edge, on either side of a rounding.
#include <fstream>

#include "base/rng.h"
#include "reference/integrator.h"
#include "shadow_agreement.h"
#include "testscenes/make_scene.h"

namespace candela::test {

namespace {

// A cube from -1 to 1 with flat sides.
void add_box(GltfBuilder& b, int material, Json node) {
  std::vector<float> positions, normals;
  std::vector<uint32_t> indices;
  for (int side = 0; side < 6; ++side) {
    glm::vec3 n(0), u(0), v(0);
    n[side / 2] = side % 2 ? -1.0f : 1.0f, u[(side / 2 + 1) % 3] = 1, v = glm::cross(n, u);
    const uint32_t first = uint32_t(positions.size() / 3);
    for (const glm::vec2 at : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
      for (int c = 0; c < 3; ++c) positions.push_back((n + u * at.x + v * at.y)[c]), normals.push_back(n[c]);
    for (const uint32_t i : {0, 1, 2, 0, 2, 3}) indices.push_back(first + i);
  }
  Json& p =
      b.primitive({{"POSITION", b.accessor<float>("VEC3", positions)}, {"NORMAL", b.accessor<float>("VEC3", normals)}});
  p["indices"] = b.accessor<uint32_t>("SCALAR", indices);
  p["material"] = material;
  node["mesh"] = int(b.json["meshes"].size()) - 1;
  add_node(b, node);
}

}  // namespace

class ReferenceTraced : public ReferenceShadows {
 protected:
  static Job traced(Job job) {
    for (const auto& [pass, knob] : {std::pair("sun", "mode"), std::pair("local", "method")})
      job.settings.push_back({pass, knob, "traced"});
    return job;
  }
  static ShadowAgreement suns(const Job& job) {
    return compared(traced(job), "shadow_sun", &reference::World::directional);
  }
  static ShadowAgreement lamps(const Job& job) {
    return compared(traced(job), "shadow_local", &reference::World::tree_punctual);
  }
  // most_wrong: at outlines and in holes of masks, where the two see different surfaces
  // (docs/understanding/shadows.md).
  static void expect_exact(const ShadowAgreement& a, size_t most_wrong = 0) {
    fmt::print("{} wrong, {} of them where both see the same surface, as {} points do\n", a.acne + a.detached,
               a.wrong_inside, a.same_surface);
    EXPECT_GT(a.same_surface, a.facing * 9 / 10);
    EXPECT_GT(a.in_shadow, a.facing / 60);
    EXPECT_EQ(a.wrong_inside, 0u);
    EXPECT_LE(a.acne + a.detached, most_wrong);
  }
  static std::string street(int lights) {
    const auto bytes = make_scene_bytes("street", 1, lights);
    EXPECT_TRUE(bytes);
    const std::filesystem::path file = folder() / "street.glb";
    if (bytes)
      std::ofstream(file, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes->data()), std::streamsize(bytes->size()));
    return file;
  }
};

TEST_F(ReferenceTraced, TheStreetByDay) {
  const auto bytes = make_scene_bytes("street", 1, 64);
  ASSERT_TRUE(bytes);
  expect_exact(suns(job_for(under("street.glb", *bytes, {{"type", "directional"}, {"intensity", 3}},
                                  {{"rotation", rotation_between({0, 0, -1}, {0.8, -0.5, -0.35})}}),
                            320, 180)));
}

TEST_F(ReferenceTraced, TheStreetByNight) { expect_exact(lamps(job_for(street(64), 320, 180))); }

TEST_F(ReferenceTraced, SponzaUnderASunAndUnderALamp) {
  const std::filesystem::path file = CANDELA_SOURCE_DIR "/../shared/assets/scenes/Sponza/Sponza.gltf";
  const auto bytes = read_file(file);
  if (!bytes) GTEST_SKIP() << "the folder shared/assets is absent";
  Job job = job_for(under(file, *bytes, {{"type", "directional"}, {"intensity", 3}},
                          {{"rotation", rotation_between({0, 0, -1}, {0.25, -1, 0.35})}}),
                    160, 90);
  look(job, {-9, 1.5, 0}, {0, 2, 0}, 60);
  expect_exact(suns(job), 30);
  job.scene = under(file, *bytes, {{"type", "point"}, {"intensity", 500}}, {{"translation", {-1, 2.5, 0.3}}});
  expect_exact(lamps(job), 48);
}

// A card of leaves before a wall: holes of masks let light through, and blended glass a part of it.
TEST_F(ReferenceTraced, MasksAndGlassLetLightThroughAsTheyDoOnTheCpu) {
  expect_exact(suns(job_for(scene("alpha"), 320, 180)));
}

// A node turned over by a negative scale, another that leans, a lamp inside of a wall, and one that glows around its
// lamp.
TEST_F(ReferenceTraced, MirroredNodesAndLampsInWalls) {
  GltfBuilder b = empty_scene();
  const int grey = add_material(b, diffuse_material(0.5, 0.5, 0.5));
  Json glow = diffuse_material(0.5, 0.5, 0.5);
  glow["emissiveFactor"] = {1, 1, 1};
  const int glowing = add_material(b, glow);
  const auto box = [&](int material, const Json& node) { add_box(b, material, node); };
  box(grey, {{"translation", {0, -1, 0}}, {"scale", {6, 0.1, 6}}});
  box(grey, {{"translation", {-1.5, 0, 0}}, {"scale", {-0.5, 0.7, 0.4}}});
  box(grey, {{"translation", {1.2, -0.2, -0.8}}, {"scale", {0.4, -0.6, 0.5}}, {"rotation", {0.3, 0.1, 0.2, 0.927}}});
  box(grey, {{"translation", {0, 0, -3}}, {"scale", {3, 2, 0.2}}});
  box(glowing, {{"translation", {0.3, 1.2, 0.4}}, {"scale", {0.1, 0.1, 0.1}}});
  const auto lamp = [&](Json at) { add_light(b, {{"type", "point"}, {"intensity", 50}}, {{"translation", at}}); };
  lamp({0.3, 1.2, 0.4}), lamp({0.5, 0.5, -3}), lamp({-1.5, 0.1, 0}), lamp({2, 1, 1});
  Job job = job_for(write(b), 240, 135);
  look(job, {0.5, 1.5, 5}, {0, -0.2, 0}, 50);
  expect_exact(lamps(job));
}

TEST_F(ReferenceTraced, OcclusionTendsToTheTracedTerm) {
  Job job = job_for(street(16), 160, 90);
  job.layers = {"occlusion"};
  const auto drawn = [&](const char* rays) {
    Job with = job;
    with.settings = {{"occlusion", "method", "traced"}, {"occlusion", "rays", rays}};
    return images_of(with)["occlusion"].values<float>();
  };
  auto frame = open_reference(job, 0, {});
  ASSERT_TRUE(frame);
  const reference::World& world = *(*frame)->world;
  const Occlusion occlusion = world.occlusion();
  std::vector<double> truth;
  for (int y = 0; y < job.height_px; ++y)
    for (int x = 0; x < job.width_px; ++x) {
      const reference::CameraRay camera = world.camera_ray(glm::dvec2(x, y) + 0.5, job.width_px, job.height_px);
      const auto hit = reference::next_surface(world, reference::rounded(camera), true, nullptr, nullptr);
      truth.push_back(-1);
      if (!hit || world.is_blended(hit->item)) continue;
      const reference::Surface surface = world.surface(*hit, camera.origin, camera.direction);
      if (surface.unlit) continue;
      const SurfacePoint point = world.accel().surface(*hit);
      constexpr int side = 24;
      double open = 0;
      Rng rng(uint64_t(y * job.width_px + x));
      for (int i = 0; i < side * side; ++i) {
        const glm::dvec2 u((i % side + rng.uniform()) / side, (i / side + rng.uniform()) / side);
        open += reference::near_visibility(world, point, reference::cosine_direction(surface.geometric, u), occlusion);
      }
      truth.back() = 1 - occlusion.strength * (1 - open / (side * side));
    }
  double before = 1;
  for (const char* rays : {"4", "16", "64", "256"}) {
    const std::vector<float> open = drawn(rays);
    ASSERT_EQ(open.size(), truth.size());
    double sum = 0, bias = 0, count = 0;
    for (size_t i = 0; i < truth.size(); ++i)
      if (truth[i] >= 0) {
        const double e = double(open[i]) - truth[i];
        sum += e * e, bias += e, ++count;
      }
    const double rmse = std::sqrt(sum / count);
    fmt::print("{} rays: RMSE {:.4f}, bias {:.5f}\n", rays, rmse, bias / count);
    EXPECT_LT(rmse, before * 0.7) << rays;
    EXPECT_LT(std::abs(bias / count), 0.004) << rays;
    before = rmse;
  }
  EXPECT_LT(before, 0.02);
}

}  // namespace candela::test
