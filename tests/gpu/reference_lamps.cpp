// Shadows of point and spot lights against traced hard ones, at the pixels' centres: the share of their light that
// arrives, each weighed by its illuminance and cosine. A map darkens what is lit (acne) or lights what is in shadow
// (detachment). Both are counted, printed and kept in the test's XML.
#include <fstream>

#include "base/rng.h"
#include "reference/bsdf.h"
#include "reference/centre_surface.h"
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

class ReferenceLamps : public ReferenceParity {
 protected:
  static std::filesystem::path folder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path made =
        std::filesystem::path(::testing::TempDir()) / fmt::format("candela_lamps_{}", info->name());
    std::error_code ignored;
    std::filesystem::remove_all(made, ignored);
    std::filesystem::create_directories(made);
    return made;
  }
  // A copy of a scene whose only light is a point light.
  static std::string under_lamp(const std::filesystem::path& scene_file, const std::vector<std::byte>& bytes,
                                glm::dvec3 at) {
    std::vector<std::byte> binary;
    Json json = read_json(bytes, binary);
    json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 500}}};
    Json node = {{"translation", {at.x, at.y, at.z}}};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    json["nodes"].push_back(node);
    json["scenes"][json.value("scene", size_t{0})]["nodes"].push_back(json["nodes"].size() - 1);
    json["extensionsUsed"].push_back("KHR_lights_punctual");
    const std::filesystem::path made = folder();
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(scene_file.parent_path()))
      if (entry.path() != scene_file)
        std::filesystem::copy(entry.path(), made / entry.path().filename(), std::filesystem::copy_options::recursive,
                              ignored);
    write_scene(made / scene_file.filename(), json, binary);
    return made / scene_file.filename();
  }

  static Agreement compared(Job job) {
    job.layers = {"shadow.lamps", "normal"};
    const Images images = images_of(job);
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return {};
    const reference::World& world = *(*frame)->world;
    Agreement out;
    for (int y = 0; y < job.height_px; ++y)
      for (int x = 0; x < job.width_px; ++x) {
        const reference::CameraRay camera = world.camera_ray(glm::dvec2(x, y) + 0.5, job.width_px, job.height_px);
        std::optional<Hit> hit = reference::next_surface(world, reference::rounded(camera), true, nullptr, nullptr);
        while (hit && world.is_blended(hit->item)) {
          const Hit passed = *hit;
          hit = reference::next_surface(world, reference::rounded(camera), true, &passed, nullptr);
        }
        if (!hit) continue;
        const reference::Surface surface = world.surface(*hit, camera.origin, camera.direction);
        if (surface.unlit) continue;
        const SurfacePoint point = world.accel().surface(*hit);
        // Both must see the shading normal face the light: one reads its map from level 0, the other a mip.
        const glm::dvec3 mapped(images["normal"].at<glm::vec4>(x, y));
        double all = 0, open = 0;
        for (const uint32_t index : world.tree_punctual()) {
          const reference::Arrival a = reference::arriving(world.punctual_lights()[index], surface.position);
          const double weight = glm::dot(a.illuminance, glm::dvec3(0.2126, 0.7152, 0.0722)) *
                                std::max(glm::dot(surface.normal, a.l), 0.0);
          if (!(weight > 0) || !(glm::dot(mapped, a.l) > 0)) continue;
          all += weight;
          if (reference::is_open(surface, a.l) &&
              reference::transmittance(world, point, a.l, a.distance_m, nullptr, true) > 0.5)
            open += weight;
        }
        if (!(all > 0)) continue;
        const double map = double(images["shadow.lamps"].at<float>(x, y)), truth = open / all;
        ++out.facing;
        out.in_shadow += truth < 0.5;
        out.acne += map < truth - 0.5;
        out.detached += map > truth + 0.5;
      }
    const std::string line =
        fmt::format("{} points face a lamp, {} of them mostly in shadow: {:.3f} % wrongly dark, {:.3f} % wrongly lit",
                    out.facing, out.in_shadow, 100.0 * double(out.acne) / double(out.facing),
                    100.0 * double(out.detached) / double(out.facing));
    fmt::print("{}\n", line);
    RecordProperty("agreement", line);
    return out;
  }
};

TEST_F(ReferenceLamps, SponzaUnderALampAgreesWithTracedShadows) {
  const std::filesystem::path file = CANDELA_SOURCE_DIR "/../shared/assets/scenes/Sponza/Sponza.gltf";
  const auto bytes = read_file(file);
  if (!bytes) GTEST_SKIP() << "Sponza is not here";
  Job job = job_for(under_lamp(file, *bytes, {-1, 2.5, 0.3}), 320, 180);
  look(job, {-9, 1.5, 0}, {0, 2, 0}, 60);
  // The error is that of the texels: it falls with them.
  double before = 0.03;
  for (const char* size : {"512", "1024", "2048"}) {
    job.settings = {{"shadows", "size_px", size}, {"shadows", "budget_mb", "1024"}};
    const Agreement agreement = compared(job);
    EXPECT_GT(agreement.in_shadow, agreement.facing / 20);
    EXPECT_LT(agreement.wrong(), before) << size;
    before = agreement.wrong() * 0.8;
  }
}

// A tunnel of rough rock with dripstones, from within, and three coloured lamps in it.
TEST_F(ReferenceLamps, ACaveWithThreeColouredLampsAgreesWithTracedShadows) {
  GltfBuilder b = empty_scene();
  Json rock = diffuse_material(0.5, 0.45, 0.4);
  rock["doubleSided"] = true;
  const int material = add_material(b, rock);
  // A surface of a grid, smoothly shaded.
  const auto add_grid = [&](int columns, int rows, const auto& at) {
    std::vector<float> positions, normals;
    std::vector<uint32_t> indices;
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= columns; ++i) {
        const double u = double(i) / columns, v = double(j) / rows, step = 1e-4;
        const glm::dvec3 p = at(u, v);
        const glm::dvec3 n = glm::cross(at(u + step, v) - at(u - step, v), at(u, v + step) - at(u, v - step));
        const glm::dvec3 unit = glm::length(n) > 0 ? glm::normalize(n) : glm::dvec3(0, 1, 0);
        for (int c = 0; c < 3; ++c) positions.push_back(float(p[c])), normals.push_back(float(unit[c]));
        if (i == columns || j == rows) continue;
        const uint32_t first = uint32_t(j * (columns + 1) + i), above = first + uint32_t(columns) + 1;
        for (const uint32_t index : {first, first + 1, above + 1, first, above + 1, above}) indices.push_back(index);
      }
    Json& p = b.primitive(
        {{"POSITION", b.accessor<float>("VEC3", positions)}, {"NORMAL", b.accessor<float>("VEC3", normals)}});
    p["indices"] = b.accessor<uint32_t>("SCALAR", indices);
    p["material"] = material;
    add_node(b, {{"mesh", int(b.json["meshes"].size()) - 1}});
  };
  const double turn = 2 * 3.14159265358979;
  add_grid(160, 96, [&](double u, double v) {
    const double x = 24 * (u - 0.5), a = turn * v;
    const double r =
        3 + 0.5 * std::sin(1.3 * x + 2 * a) + 0.3 * std::sin(2.9 * x - 3 * a) + 0.12 * std::sin(7 * x + 9 * a);
    return glm::dvec3(x, r * std::sin(a), r * std::cos(a));
  });
  Rng rng(76);
  for (int i = 0; i < 24; ++i) {
    const double x = rng.uniform(-9, 9), z = rng.uniform(-1.8, 1.8), side = i % 2 ? 1 : -1,
                 long_m = rng.uniform(0.6, 2.4);
    add_grid(16, 12, [=](double u, double v) {
      const double r = 0.22 * (1 - v) * (1 + 0.2 * std::sin(20 * v)), a = turn * u;
      return glm::dvec3(x + r * std::cos(a), side * (-3 + long_m * v), z + r * std::sin(a));
    });
  }
  const auto lamp = [&](glm::dvec3 at, glm::dvec3 color) {
    add_light(b, {{"type", "point"}, {"intensity", 300.0}, {"color", {color.x, color.y, color.z}}},
              {{"translation", {at.x, at.y, at.z}}});
  };
  lamp({-3, 0.4, 0.8}, {1, 0.3, 0.2}), lamp({1, -0.8, -1}, {0.2, 1, 0.4}), lamp({6, 1, 0}, {0.3, 0.4, 1});
  Job job = job_for(write(b), 320, 180);
  look(job, {-8, 0.2, 0}, {0, -0.2, 0}, 60);
  const Agreement agreement = compared(job);
  EXPECT_GT(agreement.in_shadow, agreement.facing / 50);
  EXPECT_LT(agreement.wrong(), 0.02);
}

TEST_F(ReferenceLamps, TheStreetByNightAgreesWithTracedShadows) {
  const auto bytes = make_scene_bytes("street", 1, 64);
  ASSERT_TRUE(bytes);
  const std::filesystem::path file = folder() / "street.glb";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes->data()), std::streamsize(bytes->size()));
  Job job = job_for(file, 320, 180);
  job.settings = {{"shadows", "lights", "64"}};
  const Agreement agreement = compared(job);
  EXPECT_GT(agreement.in_shadow, agreement.facing / 50);
  EXPECT_LT(agreement.wrong(), 0.02);
}

}  // namespace candela::test
