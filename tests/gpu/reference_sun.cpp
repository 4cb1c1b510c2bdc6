// Shadows of the sun against traced hard ones, at the pixels' centres. A shadow map is wrong in two ways: it darkens
// what is lit (acne), or lights what is in shadow (detachment). Both are counted, printed and kept in the test's XML.
#include <glm/gtc/quaternion.hpp>

#include "reference/bsdf.h"
#include "reference/visibility.h"
#include "reference_parity.h"
#include "testscenes/make_scene.h"

namespace candela::test {
namespace {

struct Agreement {
  size_t facing = 0, acne = 0, detached = 0, in_shadow = 0;
  double wrong() const { return double(acne + detached) / double(facing); }
};

}  // namespace

class ReferenceSun : public ReferenceParity {
 protected:
  // A copy of a scene whose only light is a sun that shines along `direction`.
  static std::string under_sun(const std::filesystem::path& scene_file, const std::vector<std::byte>& bytes,
                               glm::dvec3 direction) {
    std::vector<std::byte> binary;
    Json json = read_json(bytes, binary);
    for (Json& node : json["nodes"])
      if (node.contains("extensions"))
        node["extensions"].erase("KHR_lights_punctual"), node["extensions"].erase("CANDELA_light_instances");
    json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 3}}};
    const glm::dquat turn(glm::dvec3(0, 0, -1), glm::normalize(direction));
    Json node = {{"rotation", {turn.x, turn.y, turn.z, turn.w}}};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    json["nodes"].push_back(node);
    json["scenes"][json.value("scene", size_t{0})]["nodes"].push_back(json["nodes"].size() - 1);
    json["extensionsUsed"].push_back("KHR_lights_punctual");
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path folder =
        std::filesystem::path(::testing::TempDir()) / fmt::format("candela_sun_{}", info->name());
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    std::filesystem::create_directories(folder);
    if (std::filesystem::exists(scene_file))
      for (const auto& entry : std::filesystem::directory_iterator(scene_file.parent_path()))
        if (entry.path() != scene_file)
          std::filesystem::copy(entry.path(), folder / entry.path().filename(),
                                std::filesystem::copy_options::recursive, ignored);
    write_scene(folder / scene_file.filename(), json, binary);
    return folder / scene_file.filename();
  }

  static Agreement compared(Job job) {
    job.layers = {"shadow", "normal"};
    const Images images = images_of(job);
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return {};
    const reference::World& world = *(*frame)->world;
    Agreement out;
    for (int y = 0; y < job.height_px; ++y)
      for (int x = 0; x < job.width_px; ++x) {
        const reference::CameraRay camera = world.camera_ray(glm::dvec2(x, y) + 0.5, job.width_px, job.height_px);
        const Ray ray = reference::rounded(camera);
        std::optional<Hit> hit = reference::next_surface(world, ray, true, nullptr, nullptr);
        while (hit && world.is_blended(hit->item)) {
          const Hit passed = *hit;
          hit = reference::next_surface(world, ray, true, &passed, nullptr);
        }
        if (!hit) continue;
        const reference::Surface surface = world.surface(*hit, camera.origin, camera.direction);
        const glm::dvec3 l = -world.punctual_lights()[0].direction;
        // Both must see the shading normal face the light: one reads its map from level 0, the other a mip.
        const glm::dvec3 mapped(images["normal"].at<glm::vec4>(x, y));
        if (surface.unlit || !(glm::dot(surface.normal, l) > 0) || !(glm::dot(mapped, l) > 0)) continue;
        ++out.facing;
        const bool is_lit =
            reference::is_open(surface, l) && reference::transmittance(world, world.accel().surface(*hit), l,
                                                                       std::numeric_limits<double>::infinity()) > 0.5;
        const double map = double(images["shadow"].at<float>(x, y));
        out.in_shadow += !is_lit;
        out.acne += is_lit && map < 0.5;
        out.detached += !is_lit && map > 0.5;
      }
    const std::string line =
        fmt::format("{} points face the sun, {} of them in shadow: {:.3f} % wrongly dark, {:.3f} % wrongly lit",
                    out.facing, out.in_shadow, 100.0 * double(out.acne) / double(out.facing),
                    100.0 * double(out.detached) / double(out.facing));
    fmt::print("{}\n", line);
    RecordProperty("agreement", line);
    return out;
  }
};

TEST_F(ReferenceSun, SponzaAgreesWithTracedShadows) {
  const std::filesystem::path file = CANDELA_SOURCE_DIR "/../shared/assets/scenes/Sponza/Sponza.gltf";
  const auto bytes = read_file(file);
  if (!bytes) GTEST_SKIP() << "Sponza is not here";
  Job job = job_for(under_sun(file, *bytes, {0.25, -1, 0.35}), 320, 180);
  look(job, {-9, 1.5, 0}, {0, 2, 0}, 60);
  const Agreement agreement = compared(job);
  EXPECT_GT(agreement.in_shadow, agreement.facing / 20);
  EXPECT_LT(agreement.wrong(), 0.02);
}

TEST_F(ReferenceSun, TheStreetByDayAgreesWithTracedShadows) {
  const auto bytes = make_scene_bytes("street", 1, 64);
  ASSERT_TRUE(bytes);
  const Agreement agreement = compared(job_for(under_sun("street.glb", *bytes, {0.8, -0.5, -0.35}), 320, 180));
  EXPECT_GT(agreement.in_shadow, agreement.facing / 50);
  EXPECT_LT(agreement.wrong(), 0.02);
}

}  // namespace candela::test
