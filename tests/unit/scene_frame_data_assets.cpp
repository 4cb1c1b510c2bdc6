#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "gltf/gltf.h"
#include "scene/deformation_bounds.h"
#include "scene/frame_data.h"
#include "scene/survey.h"

namespace candela {
namespace {

constexpr const char* assets = CANDELA_SOURCE_DIR "/../shared/assets";

// As the device makes it: float sums of morphs, then the blended float matrix or the item's transform.
glm::vec3 relative_position(const MeshSection& s, size_t v, const FrameData& frame, const DrawItem& item) {
  glm::vec3 p = s.position[v];
  glm::mat4 m = frame.relative_from_local[item.transform];
  if (item.deformed >= 0) {
    const Deformation& d = frame.deformations[size_t(item.deformed)];
    for (uint32_t t = 0; t < d.weight_count; ++t)
      if (!s.morph[t].position.empty()) p += frame.morph_weights[d.first_weight + t] * s.morph[t].position[v];
    if (d.joint_count > 0) {
      m = glm::mat4(0.0f);
      for (int i = 0; i < 4; ++i) {
        m += s.weights0[v][i] * frame.joint_matrices[d.first_joint + s.joints0[v][i]];
        if (!s.joints1.empty()) m += s.weights1[v][i] * frame.joint_matrices[d.first_joint + s.joints1[v][i]];
      }
    }
  }
  return glm::vec3(m * glm::vec4(p, 1));
}

// Number of vertices outside their item's bounds; big sections are sampled.
size_t vertices_outside(const Scene& scene, const FrameData& frame) {
  size_t outside = 0;
  for (const DrawItem& item : frame.items) {
    const MeshSection& s = scene.meshes[item.mesh].sections[item.section];
    const size_t step = 1 + s.index.size() / 20000;
    for (size_t i = 0; i < s.index.size(); i += step) {
      const glm::vec3 p = relative_position(s, s.index[i], frame, item);
      const bool inside = glm::all(glm::greaterThanEqual(p, item.bounds_relative.min)) &&
                          glm::all(glm::lessThanEqual(p, item.bounds_relative.max));
      outside += !inside;
    }
  }
  return outside;
}

void check_at(const Scene& scene, const AnimationChoice& all, double time_s, const std::string& name) {
  const Pose pose = evaluate_pose(scene, all, time_s);
  const DAabb bounds = world_bounds(scene, pose);
  const Expected<View> view = make_view(scene, pose, {}, 320, 180, bounds);
  ASSERT_TRUE(view) << name << ": " << view.error().text();
  const FrameData frame = make_frame_data(scene, pose, *view);
  EXPECT_EQ(vertices_outside(scene, frame), 0u) << name << " at " << time_s << " s";
  for (const DrawItem& item : frame.items) EXPECT_TRUE(std::isfinite(item.bounds_relative.max.x)) << name;
  EXPECT_EQ(survey(scene, pose, frame, false).draw_items, frame.items.size());
}

// Every real scene that loads, before, within and past its animations: bounds hold, and there is a view.
TEST(FrameDataAssets, BoundsHoldForRealScenesAtEveryTime) {
  if (!std::filesystem::is_directory(assets)) GTEST_SKIP() << "the folder shared/assets is absent";
  size_t scenes = 0, deformed = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(assets)) {
    const std::string ending = entry.path().extension().string(), name = entry.path().string();
    if ((ending != ".gltf" && ending != ".glb") || name.find("/malformed/") != std::string::npos) continue;
    Expected<Scene> scene = load_gltf(entry.path());
    if (!scene) continue;  // what the loader refuses is its own tests' matter
    ++scenes;
    prepare_deformation_bounds(*scene);
    const AnimationChoice all = *choose_animations(*scene, "all");
    double end_s = 0;
    for (const Animation& animation : scene->animations) end_s = std::max(end_s, animation.end_s);
    for (double time_s : {-1.0, 0.0, 0.37 * end_s, 0.81 * end_s, end_s + 1}) {
      check_at(*scene, all, time_s, name);
      if (end_s == 0) break;
    }
    for (const Mesh& mesh : scene->meshes)
      for (const MeshSection& section : mesh.sections) deformed += section.deformation_bounds != nullptr;
  }
  std::printf("%zu scenes, %zu skinned or morphed sections\n", scenes, deformed);
  EXPECT_GT(scenes, 0u);
}

}  // namespace
}  // namespace candela
