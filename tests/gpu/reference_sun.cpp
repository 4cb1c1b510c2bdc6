// Shadows of the sun against traced hard ones (shadow_agreement.h).
#include "shadow_agreement.h"
#include "testscenes/make_scene.h"

namespace candela::test {

class ReferenceSun : public ReferenceShadows {
 protected:
  static ShadowAgreement compared(const Job& job) {
    return ReferenceShadows::compared(job, "shadow_sun", &reference::World::directional);
  }
  // A copy of a scene whose only light is a sun that shines along `direction`.
  static std::string under_sun(const std::filesystem::path& scene_file, const std::vector<std::byte>& bytes,
                               glm::dvec3 direction) {
    return under(scene_file, bytes, {{"type", "directional"}, {"intensity", 3}},
                 {{"rotation", rotation_between({0, 0, -1}, direction)}});
  }
};

TEST_F(ReferenceSun, SponzaAgreesWithTracedShadows) {
  const std::filesystem::path file = CANDELA_SOURCE_DIR "/../shared/assets/scenes/Sponza/Sponza.gltf";
  const auto bytes = read_file(file);
  if (!bytes) GTEST_SKIP() << "the folder shared/assets is absent";
  Job job = job_for(under_sun(file, *bytes, {0.25, -1, 0.35}), 320, 180);
  look(job, {-9, 1.5, 0}, {0, 2, 0}, 60);
  const ShadowAgreement agreement = compared(job);
  EXPECT_GT(agreement.in_shadow, agreement.facing / 20);
  EXPECT_LT(agreement.wrong(), 0.02);
}

TEST_F(ReferenceSun, TheStreetByDayAgreesWithTracedShadows) {
  const auto bytes = make_scene_bytes("street", 1, 64);
  ASSERT_TRUE(bytes);
  const ShadowAgreement agreement = compared(job_for(under_sun("street.glb", *bytes, {0.8, -0.5, -0.35}), 320, 180));
  EXPECT_GT(agreement.in_shadow, agreement.facing / 50);
  EXPECT_LT(agreement.wrong(), 0.02);
}

}  // namespace candela::test
