#include "plan/frame_upload.h"

#include <gtest/gtest.h>

#include <cstring>

#include "scene_pieces.h"

// What the CPU hands to the device: lights, materials and items, from the numbers of the file.
namespace candela::test {
namespace {

FrameUpload upload_of(const GltfBuilder& builder) {
  const SeenScene seen = seen_from_the_front(builder);
  const auto layout = layout_geometry(seen.scene);
  EXPECT_TRUE(layout) << layout.error().text();
  return make_frame_upload(seen.scene, seen.pose, seen.view, seen.data,
                           make_draw_list(seen.scene, seen.pose, seen.data), *layout, {}, {});
}

GltfBuilder square_with(Json material) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, std::move(material)))}});
  return b;
}

}  // namespace

// A spot's two numbers give 1 inside the inner cone, 0 at the outer one, and are linear in the cosine between.
TEST(FrameUpload, SpotsHaveTheirCones) {
  GltfBuilder b = square_with(diffuse_material(1, 1, 1));
  add_light(b,
            {{"type", "spot"},
             {"intensity", 3.0},
             {"color", {1, 0.5, 0.25}},
             {"range", 8.0},
             {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.75}}}},
            {{"translation", {0, 1, 2}}});
  const FrameUpload upload = upload_of(b);
  ASSERT_EQ(upload.lights.size(), 1u);
  const shared::Light& l = upload.lights[0];
  const auto factor = [&](double angle) { return double(l.spot_offset) - (2 - 2 * std::cos(angle)) * l.spot_scale; };
  EXPECT_NEAR(factor(0.25), 1, 1e-6);
  EXPECT_NEAR(factor(0.75), 0, 1e-6);
  const double middle = (std::cos(0.5) - std::cos(0.75)) / (std::cos(0.25) - std::cos(0.75));
  EXPECT_NEAR(factor(0.5), middle, 1e-6);
  EXPECT_EQ(l.type, shared::light_spot);
  EXPECT_EQ(l.position, glm::vec3(0, 1, -2));
  EXPECT_EQ(l.direction, glm::vec3(0, 0, -1));
  EXPECT_EQ(l.intensity, glm::vec3(3, 1.5, 0.75));
  EXPECT_EQ(l.inverse_range, 0.125f);
}

// A table of the materials' records, and none where no material that is drawn has lobes.
TEST(FrameUpload, LobesHaveRecords) {
  Json material = diffuse_material(1, 1, 1);
  EXPECT_TRUE(upload_of(square_with(material)).lobes.empty());
  material["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.25}};
  material["extensions"]["KHR_materials_iridescence"] = {{"iridescenceFactor", 0}, {"iridescenceIor", 2}};
  material["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", 1}, {"anisotropyRotation", 0.5}};
  GltfBuilder b = square_with(diffuse_material(1, 1, 1));
  add_material(b, material);  // that nothing shows
  EXPECT_TRUE(upload_of(b).lobes.empty());
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
  const FrameUpload upload = upload_of(b);
  ASSERT_GE(upload.lobes.size(), 3u);
  EXPECT_EQ(upload.lobes[0], shared::absent);
  EXPECT_EQ(upload.lobes[1], shared::absent);
  EXPECT_EQ(upload.lobes[2], 3u);
  ASSERT_EQ(upload.lobes.size(), 3 + sizeof(shared::MaterialLobes) / 4);
  shared::MaterialLobes lobes;
  std::memcpy(&lobes, &upload.lobes[3], sizeof lobes);
  EXPECT_EQ(lobes.coat, 0.5f);
  EXPECT_EQ(lobes.coat_roughness, 0.25f);
  EXPECT_EQ(lobes.film_ior, 0) << "of a film that it does not show";
  EXPECT_EQ(lobes.anisotropy, 1);
  EXPECT_NEAR(lobes.anisotropy_turn.x, std::cos(0.5), 1e-7);
  EXPECT_NEAR(lobes.anisotropy_turn.y, std::sin(0.5), 1e-7);
}

// Where floats cannot square a distance, a weaker light stands nearer by: its light arrives as before.
TEST(FrameUpload, FarLightsShineAsTheyWould) {
  GltfBuilder b = square_with(diffuse_material(1, 1, 1));
  add_light(b, {{"type", "point"}, {"intensity", 1e36}}, {{"translation", {0, 0, 1e18}}});
  const FrameUpload upload = upload_of(b);
  ASSERT_EQ(upload.lights.size(), 1u);
  const shared::Light& l = upload.lights[0];
  const double distance = glm::length(glm::dvec3(l.position));
  EXPECT_LT(distance, 1e16);
  EXPECT_NEAR(double(l.intensity.x) / (distance * distance), 1, 1e-5);
  EXPECT_GT(l.position.z, 0);
}

TEST(FrameUpload, MaterialsKeepTheirNumbers) {
  Json material = {{"pbrMetallicRoughness", base_color(0.5, 0.25, 0.125, 0.75)}};
  material["alphaMode"] = "MASK", material["alphaCutoff"] = 0.25;
  material["doubleSided"] = true;
  material["emissiveFactor"] = {0.5, 1, 0.25};
  material["extensions"]["KHR_materials_ior"] = {{"ior", 2.0}};
  material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 4.0}};
  GltfBuilder b = square_with(material);
  b.use("KHR_materials_ior"), b.use("KHR_materials_emissive_strength");
  const FrameUpload upload = upload_of(b);
  ASSERT_GE(upload.materials.size(), 1u);
  const shared::Material& m = upload.materials[0];
  EXPECT_EQ(m.base_color, glm::vec4(0.5, 0.25, 0.125, 0.75));
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_EQ(m.emissive, glm::vec3(2, 4, 1));
  EXPECT_NEAR(m.ior_f0, 1.0 / 9, 1e-7);
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.roughness, 1.0f);
  EXPECT_EQ(m.flags, shared::material_masked | shared::material_double_sided);
  const FrameUpload blended = upload_of(square_with([] {
    Json glass = unlit_material(1, 1, 1, 0.5);
    glass["alphaMode"] = "BLEND";
    return glass;
  }()));
  EXPECT_EQ(blended.materials[0].flags, shared::material_blended | shared::material_unlit);
}

// Groups cover a run without gap or overlap, and the last says so.
TEST(FrameUpload, GroupsCoverTheirRuns) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int square = add_square_mesh(b, 1, add_material(b, diffuse_material(1, 1, 1)));
  constexpr uint32_t count = 2 * shared::cull_group_size + 3;
  for (uint32_t i = 0; i < count; ++i) add_node(b, {{"mesh", square}, {"translation", {0.1 * i, 0, 0}}});
  const FrameUpload upload = upload_of(b);
  ASSERT_EQ(upload.items.size(), count);
  ASSERT_EQ(upload.groups.size(), 3u);
  uint32_t next = 0;
  for (const shared::CullGroup& g : upload.groups) {
    EXPECT_EQ(g.first_item, next);
    EXPECT_EQ(g.run, 0u);
    EXPECT_EQ(g.first_group, 0u);
    next += g.item_count;
    EXPECT_EQ(g.is_last, next == count ? 1u : 0u);
  }
  EXPECT_EQ(next, count);
  // Bounds are widened by what rounding may do.
  for (const shared::Item& item : upload.items)
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(item.bounds_extent[axis], axis < 2 ? 1.0f : 0.0f);
      EXPECT_LT(item.bounds_extent[axis], axis < 2 ? 1.001f : 0.001f);
    }
}

}  // namespace candela::test
