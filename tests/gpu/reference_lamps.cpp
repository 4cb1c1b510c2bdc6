// Shadows of point and spot lights against traced hard ones (shadow_agreement.h).
#include <fstream>

#include "base/rng.h"
#include "shadow_agreement.h"
#include "testscenes/make_scene.h"

namespace candela::test {

class ReferenceLamps : public ReferenceShadows {
 protected:
  static ShadowAgreement compared(const Job& job) {
    return ReferenceShadows::compared(job, "shadow_local", &reference::World::tree_punctual);
  }
};

TEST_F(ReferenceLamps, SponzaUnderALampAgreesWithTracedShadows) {
  const std::filesystem::path file = CANDELA_SOURCE_DIR "/../shared/assets/scenes/Sponza/Sponza.gltf";
  const auto bytes = read_file(file);
  if (!bytes) GTEST_SKIP() << "the folder shared/assets is absent";
  Job job = job_for(under(file, *bytes, {{"type", "point"}, {"intensity", 500}}, {{"translation", {-1, 2.5, 0.3}}}),
                    320, 180);
  look(job, {-9, 1.5, 0}, {-3, 0, 1.2}, 6);
  // Pixels are smaller than texels, so that the error is that of the texels: it falls with them. Larger pixels show the
  // mean over what they cover, which is not what their middle has.
  double before = 0.01;
  for (const char* size : {"256", "512", "1024"}) {
    job.settings = {{"local", "size_px", size}, {"local", "budget_mb", "1024"}};
    const ShadowAgreement agreement = compared(job);
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
  const ShadowAgreement agreement = compared(job);
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
  job.settings = {{"local", "lights", "64"}};
  const ShadowAgreement agreement = compared(job);
  EXPECT_GT(agreement.in_shadow, agreement.facing / 50);
  EXPECT_LT(agreement.wrong(), 0.02);
}

}  // namespace candela::test
