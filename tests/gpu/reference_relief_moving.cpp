// Reliefs that move: by nodes, skins, morphs and instances, and by their own depth and heights.
#include "../unit/gltf_pointers.h"
#include "relief_fixture.h"

namespace candela::test::reference_relief {

TEST_F(ReferenceRelief, MovesWithItsSquare) {
  GltfBuilder b = hilly(deep, true, false);
  const int times = b.accessor<float>("SCALAR", {0, 1}), places = b.accessor<float>("VEC3", {0, 0, 0, 0.24f, 0, 0});
  b.json["animations"].push_back(
      {{"samplers", {{{"input", times}, {"output", places}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  Job job = seen_aslant(write(b));
  job.camera.eye = glm::dvec3(0.3, -0.2, 2), job.camera.target = glm::dvec3(0.3, -0.2, 0);
  job.layers = {"motion", "depth"};
  const Images images = images_of(job, {}, 0.5);
  const double px = height / (2 * std::tan(25 * std::numbers::pi / 180));
  size_t seen = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double z = images["depth"].at(x, y);
      if (z > 1e9) continue;
      ++seen;
      const glm::vec2 moved = images["motion"].at<glm::vec2>(x, y);
      ASSERT_NEAR(moved.x, 0.01 * px / z, 1e-4) << x << " " << y;
      ASSERT_NEAR(moved.y, 0, 1e-4) << x << " " << y;
    }
  EXPECT_GT(seen, 700u);
}

TEST_F(ReferenceRelief, MovesByItsDepthAndItsHeights) {
  GltfBuilder b = hilly(deep, true, false);
  b.use("KHR_texture_transform");
  b.json["materials"].back()["extensions"]["CANDELA_relief"]["heightTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 0}}};
  animate_pointers(b, {{"/materials/0/extensions/CANDELA_relief/depth", "SCALAR", {0.3f, 0.05f}},
                       {"/materials/0/extensions/CANDELA_relief/heightTexture/extensions/KHR_texture_transform/offset",
                        "VEC2",
                        {0, 0, 0.5f, 0.25f}}});
  Job job = seen_aslant(write(b));
  job.layers = {"motion", "depth"};
  constexpr double time_s = 0.5;
  const Images images = images_of(job, {}, time_s);
  const auto now = open_reference(job, time_s, {}), before = open_reference(job, time_s - job.motion_s, {});
  ASSERT_TRUE(now && before);
  const reference::World& world_now = *(*now)->world;
  const glm::dvec3 eye = *job.camera.eye;
  size_t seen = 0;
  double mean = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double z = images["depth"].at(x, y);
      if (z > 1e9) continue;
      const reference::CameraRay ray = world_now.camera_ray(glm::dvec2(x, y) + 0.5, width, height);
      const glm::dvec3 place = ray.direction * z;  // the camera's is the origin
      // What lies below the same place of the square at the time before.
      const Ray down{glm::vec3(place.x, place.y, 1 - eye.z), 0, {0, 0, -1}};
      const auto hit = reference::next_surface(*(*before)->world, down, true, nullptr, nullptr);
      if (!hit) continue;
      const glm::dvec3 was(place.x, place.y, 1 - eye.z - double(hit->t));
      const auto pixel = [&](glm::dvec3 p) {
        const glm::dvec4 clip = world_now.view().clip_from_relative * glm::dvec4(p, 1);
        return glm::dvec2(clip.x, -clip.y) / clip.w * 0.5 * glm::dvec2(width, height);
      };
      const glm::dvec2 expected = pixel(place) - pixel(was);
      const glm::vec2 moved = images["motion"].at<glm::vec2>(x, y);
      ASSERT_NEAR(moved.x, expected.x, 2e-3) << x << " " << y;
      ASSERT_NEAR(moved.y, expected.y, 2e-3) << x << " " << y;
      mean += glm::length(expected);
      ++seen;
    }
  EXPECT_GT(seen, 700u);
  EXPECT_GT(mean / double(seen), 0.1) << "it moves";
}

// Two joints bend the square about its diagonal, or a morph target does, or it is an instance that is turned and
// scaled.
GltfBuilder posed(const std::string& how) {
  GltfBuilder b = hilly(deep, how != "skinned", false);
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  if (how == "skinned") {
    primitive["attributes"]["JOINTS_0"] =
        b.accessor<uint8_t>("VEC4", std::vector<uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
    primitive["attributes"]["WEIGHTS_0"] = b.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    const int still = add_node(b, Json::object()), lifted = add_node(b, {{"translation", {0.1, 0.1, 0.3}}});
    b.json["skins"] = {{{"joints", {still, lifted}}}};
    b.json["nodes"][0]["skin"] = 0;
  } else if (how == "morphed") {
    primitive["targets"] = {{{"POSITION", b.accessor<float>("VEC3", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0.1f, 0.1f, 0.3f})}}};
    b.json["meshes"][0]["weights"] = {1};
  } else {
    b.use("EXT_mesh_gpu_instancing", true);
    b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {
        {"attributes",
         {{"TRANSLATION", b.accessor<float>("VEC3", {0, 0, 0, -0.4f, 0.7f, 0.4f})},
          {"ROTATION", b.accessor<float>("VEC4", {0, 0, 0, 1, 0.3f, 0.1f, 0, 0.9487f})},
          {"SCALE", b.accessor<float>("VEC3", {1, 1, 1, 0.5f, 0.7f, 0.4f})}}}};
  }
  return b;
}

TEST_F(ReferenceRelief, IsTheReferencesWhereItIsSkinnedMorphedOrAnInstance) {
  for (const char* how : {"skinned", "morphed", "instance"}) {
    const std::string file = write(posed(how));
    const Job job = seen_aslant(file);
    const Fit fit = fit_of(job, true_depths(job));
    EXPECT_GT(fit.seen, 700u) << how;
    EXPECT_LE(fit.missed, 4u) << how << ": outlines alone";
    EXPECT_LT(fit.rms, 2e-6) << how;
    for (const char* technique : {"clustered", "visibility", "ray"}) {
      Job shaded = job;
      shaded.technique = technique;
      const Pair pair = rendered(shaded, 1);
      size_t off = 0, seen = 0;
      for (size_t i = 0; i < pair.gpu.size(); ++i) {
        seen += pair.reference[i].w > 0;
        const double most = std::max({pair.reference[i].x, pair.reference[i].y, pair.reference[i].z, 1e-2});
        off += glm::length(glm::dvec3(pair.gpu[i] - pair.reference[i])) > 0.01 * most;
      }
      EXPECT_LE(double(off), 0.01 * double(seen)) << how << ", " << technique;
    }
  }
}

}  // namespace candela::test::reference_relief
