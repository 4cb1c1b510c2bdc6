#include <gtest/gtest.h>

#include "reference/accel.h"
#include "scene/gltf.h"
#include "scene/make_scene.h"
#include "scene/view.h"

namespace candela {
namespace {

TEST(Bvh, MeetsTheFloorOfAGeneratedScene) {
  const auto bytes = make_scene_bytes("street", 1, 0);
  ASSERT_TRUE(bytes);
  const auto scene = load_gltf_from_memory(*bytes, "street.glb", ".");
  ASSERT_TRUE(scene);
  const Pose pose = evaluate_pose(*scene, {}, 0);
  const auto view = make_view(*scene, pose, {}, 64, 64, world_bounds(*scene, pose));
  ASSERT_TRUE(view);
  const FrameData frame = make_frame_data(*scene, pose, *view);
  const Accel accel(*scene, pose, frame);
  const glm::vec3 ahead = glm::transpose(glm::dmat3(view->view_from_relative)) * glm::dvec3(0, -0.1, -1);
  const auto hit = accel.closest({glm::vec3(0), 0, ahead});
  ASSERT_TRUE(hit);
  EXPECT_FALSE(hit->back);
}

}  // namespace
}  // namespace candela
