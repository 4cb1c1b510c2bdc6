#pragma once
#include "reference/bsdf.h"
#include "reference/visibility.h"
#include "reference_parity.h"

namespace candela::test {

// Shadow maps against traced hard shadows, at the pixels' centres. A map is wrong in two ways: it darkens what is lit
// (acne), or lights what is in shadow (detachment).
struct ShadowAgreement {
  size_t facing = 0, acne = 0, detached = 0, in_shadow = 0;
  // Where both see the same surface, by its depth: not at outlines and holes of masks.
  size_t same_surface = 0, wrong_inside = 0;
  double wrong() const { return double(acne + detached) / double(facing); }
};

class ReferenceShadows : public ReferenceParity {
 protected:
  // An empty folder of the running test's own.
  static std::filesystem::path folder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path made = std::filesystem::path(::testing::TempDir()) /
                                       fmt::format("candela_{}_{}", info->test_suite_name(), info->name());
    std::error_code ignored;
    std::filesystem::remove_all(made, ignored);
    std::filesystem::create_directories(made);
    return made;
  }
  // A copy of a scene, with the files beside it, whose only light is this one, at a node of its own.
  static std::string under(const std::filesystem::path& scene_file, const std::vector<std::byte>& bytes,
                           const Json& light, Json node) {
    std::vector<std::byte> binary;
    Json json = read_json(bytes, binary);
    for (Json& other : json["nodes"])
      if (other.contains("extensions"))
        other["extensions"].erase("KHR_lights_punctual"), other["extensions"].erase("CANDELA_light_instances");
    json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    json["nodes"].push_back(node);
    json["scenes"][json.value("scene", size_t{0})]["nodes"].push_back(json["nodes"].size() - 1);
    json["extensionsUsed"].push_back("KHR_lights_punctual");
    const std::filesystem::path made = folder();
    std::error_code ignored;
    if (std::filesystem::exists(scene_file))
      for (const auto& entry : std::filesystem::directory_iterator(scene_file.parent_path()))
        if (entry.path() != scene_file)
          std::filesystem::copy(entry.path(), made / entry.path().filename(), std::filesystem::copy_options::recursive,
                                ignored);
    write_scene(made / scene_file.filename(), json, binary);
    return made / scene_file.filename();
  }

  // `lights` of the world, each weighed by its illuminance and cosine: the layer is wrong where it is off by more than
  // half. Counted, printed and kept in the test's XML.
  static ShadowAgreement compared(Job job, const std::string& layer,
                                  const std::vector<uint32_t>& (reference::World::*lights)() const) {
    job.layers = {layer, "normal", "depth"};
    const Images images = images_of(job);
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return {};
    const reference::World& world = *(*frame)->world;
    ShadowAgreement out;
    for (int y = 0; y < job.height_px; ++y)
      for (int x = 0; x < job.width_px; ++x) {
        const reference::CameraRay camera = world.camera_ray(glm::dvec2(x, y) + 0.5, job.width_px, job.height_px);
        const std::optional<Hit> hit = nearest_opaque(world, camera);
        if (!hit) continue;
        const reference::Surface surface = world.surface(*hit, camera.origin, camera.direction);
        if (surface.unlit) continue;
        const SurfacePoint point = world.accel().surface(*hit);
        // Both must see the shading normal face the light: one reads its map from level 0, the other a mip.
        const glm::dvec3 mapped(images["normal"].at<glm::vec4>(x, y));
        double all = 0, open = 0;
        for (const uint32_t index : (world.*lights)()) {
          const reference::Arrival a = reference::arriving(world.punctual_lights()[index], surface.position);
          const double weight = glm::dot(a.illuminance, glm::dvec3(0.2126, 0.7152, 0.0722)) *
                                std::max(glm::dot(surface.normal, a.l), 0.0);
          if (!(weight > 0) || !(glm::dot(mapped, a.l) > 0)) continue;
          all += weight;
          const bool lamp = std::isfinite(a.distance_m);
          if (reference::is_open(surface, a.l) &&
              reference::transmittance(world, point, a.l, a.distance_m, nullptr, lamp) > 0.5)
            open += weight;
        }
        if (!(all > 0)) continue;
        const double map = double(images[layer].at<float>(x, y)), truth = open / all;
        ++out.facing;
        out.in_shadow += truth < 0.5;
        out.acne += map < truth - 0.5;
        out.detached += map > truth + 0.5;
        const double depth = double(images["depth"].at<float>(x, y)), seen = double(hit->t);
        const bool same = std::abs(depth - seen) < 1e-4 * seen;
        out.same_surface += same;
        out.wrong_inside += same && std::abs(map - truth) > 0.5;
      }
    const std::string line =
        fmt::format("{} points face a light, {} of them mostly in shadow: {:.3f} % wrongly dark, {:.3f} % wrongly lit",
                    out.facing, out.in_shadow, 100.0 * double(out.acne) / double(out.facing),
                    100.0 * double(out.detached) / double(out.facing));
    fmt::print("{}\n", line);
    RecordProperty("agreement", line);
    return out;
  }
};

}  // namespace candela::test
