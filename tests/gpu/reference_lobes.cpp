// Lobes of Khronos materials on the GPU against the reference: light by light in 32 bits against 64, ambient light by
// the same model, and the sky's light, which the GPU approximates.
#include "reference_parity.h"

namespace candela::test {
namespace {

using Materials = std::vector<Json>;

Json material(double metallic, double roughness) {
  Json pbr = base_color(0.8, 0.4, 0.2);
  pbr["metallicFactor"] = metallic, pbr["roughnessFactor"] = roughness;
  return {{"pbrMetallicRoughness", pbr}, {"doubleSided", true}};
}
Json with(Json m, const char* lobe, Json values) {
  m["extensions"][std::string("KHR_materials_") + lobe] = std::move(values);
  return m;
}

Materials coats() {
  Materials all;
  for (const double factor : {0.3, 1.0})
    for (const double roughness : {0.2, 0.5, 1.0})
      for (const double metallic : {0.0, 1.0})
        all.push_back(with(material(metallic, 0.5), "clearcoat",
                           {{"clearcoatFactor", factor}, {"clearcoatRoughnessFactor", roughness}}));
  return all;
}
Materials sheens() {
  Materials all;
  for (const double roughness : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0})
    for (const double factor : {0.5, 1.0})
      all.push_back(with(material(0, 0.6), "sheen",
                         {{"sheenColorFactor", {factor, 0.5 * factor, 0.1}}, {"sheenRoughnessFactor", roughness}}));
  return all;
}
Materials films() {
  Materials all;
  for (const double thickness : {0.0, 0.01, 150.0, 420.0, 1200.0, 1e9})
    for (const double ior : {1.0, 1.33, 1.5, 2.4})  // 1.5: of the dielectric base, too
      for (const double metallic : {0.0, 0.4, 1.0})
        all.push_back(with(material(metallic, 0.4), "iridescence",
                           {{"iridescenceFactor", metallic == 1 ? 0.6 : 1.0},
                            {"iridescenceIor", ior},
                            {"iridescenceThicknessMaximum", thickness}}));
  return all;
}
Materials stretched() {
  Materials all;
  for (const double strength : {0.2, 0.6, 1.0})
    for (const double rotation : {0.0, 0.7})
      for (const double roughness : {0.2, 0.4, 1.0})
        all.push_back(with(material(1, roughness), "anisotropy",
                           {{"anisotropyStrength", strength}, {"anisotropyRotation", rotation}}));
  return all;
}
Materials passing() {
  Materials all;
  for (const double factor : {0.25, 1.0})
    for (const double metallic : {0.0, 0.5})
      for (const double roughness : {0.3, 0.9})
        all.push_back(
            with(material(metallic, roughness), "diffuse_transmission",
                 {{"diffuseTransmissionFactor", factor}, {"diffuseTransmissionColorFactor", {0.2, 0.9, 0.6}}}));
  return all;
}
// Every pair of the above, and all at once.
Materials stacks() {
  const Materials lists[] = {coats(), sheens(), films(), stretched(), passing()};
  Materials all;
  Json whole = material(0.3, 0.5);
  for (size_t i = 0; i < std::size(lists); ++i) {
    for (size_t j = 0; j < i; ++j) {
      Json both = material(0.3, 0.5);
      both["extensions"] = lists[i][lists[i].size() / 2 - 1]["extensions"];
      both["extensions"].update(lists[j][lists[j].size() / 2]["extensions"]);
      all.push_back(both);
    }
    whole["extensions"].update(lists[i][lists[i].size() / 2]["extensions"]);
  }
  all.push_back(whole);
  return all;
}

}  // namespace

class ReferenceLobes : public ReferenceParity {
 protected:
  // Squares side by side, each of a material, with a tangent that is not along an axis.
  static GltfBuilder squares(const Materials& materials) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    int i = 0;
    for (const Json& m : materials) {
      const int mesh = add_square_mesh(b, 0.47f, add_material(b, m));
      b.json["meshes"].back()["primitives"][0]["attributes"]["TANGENT"] =
          b.accessor<float>("VEC4", {0.8f, 0.6f, 0, 1, 0.8f, 0.6f, 0, 1, 0.8f, 0.6f, 0, 1, 0.8f, 0.6f, 0, 1});
      add_node(b, {{"mesh", mesh}, {"translation", {i % 6 - 2.5, 1.0 - i / 6, 0}}});
      ++i;
    }
    return b;
  }
  static void add_lamps(GltfBuilder& b) {
    add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {-2, 0.25, 1.75}}});
    add_light(b, {{"type", "directional"}, {"intensity", 2.0}, {"color", {0.2, 1, 0.4}}},
              {{"rotation", {-0.3, 0.2, 0.1, 0.9274}}});
    add_light(b, {{"type", "point"}, {"intensity", 15.0}, {"color", {1, 0.5, 0.3}}}, {{"translation", {1, 0.5, -1.5}}});
  }
  static Pair seen(const GltfBuilder& b, glm::dvec3 eye) {
    Job job = job_for(write(b), 96, 64);
    look(job, eye, glm::dvec3(0, 0, 0), 55);
    return rendered(job, 1);
  }
  // bound: relative, of every channel of every pixel that gets some light.
  static void expect_equal(const Materials& materials, double bound, bool lamps = true) {
    GltfBuilder b = squares(materials);
    if (lamps) add_lamps(b);
    double worst = 0;
    for (const glm::dvec3 eye : {glm::dvec3(0.3, -0.5, 5), glm::dvec3(5.2, -0.5, 1.4), glm::dvec3(0.5, 0.6, -5)}) {
      const Pair pair = seen(b, eye);
      size_t lit = 0, edges = 0;
      for (size_t i = 0; i < pair.gpu.size(); ++i) {
        if (pair.gpu[i].w != pair.reference[i].w) {  // the middle of the pixel is on a square's edge
          ++edges;
          continue;
        }
        for (int c = 0; c < 3; ++c) {
          ASSERT_TRUE(std::isfinite(pair.gpu[i][c])) << "pixel " << i;
          const double expected = pair.reference[i][c];
          if (expected < 1e-3) continue;
          ++lit;
          const double error = std::abs(pair.gpu[i][c] / expected - 1);
          worst = std::max(worst, error);
          ASSERT_LE(error, bound) << "seen from " << eye.x << ": pixel " << i % 96 << "," << i / 96 << " is "
                                  << pair.gpu[i][c] << " and should be " << expected;
        }
      }
      EXPECT_GT(lit, 300u);
      EXPECT_LE(edges, 4u);
    }
    RecordProperty("worst", fmt::format("{}", worst));
  }
};

// Angles, roughness and factors, each lobe alone and stacked. Sheen reads its albedo from a table.
TEST_F(ReferenceLobes, CoatUnderLamps) { expect_equal(coats(), 1e-5); }
TEST_F(ReferenceLobes, SheenUnderLamps) { expect_equal(sheens(), 4e-4); }
TEST_F(ReferenceLobes, FilmUnderLamps) { expect_equal(films(), 1e-5); }
TEST_F(ReferenceLobes, StretchedFacetsUnderLamps) { expect_equal(stretched(), 3e-5); }
TEST_F(ReferenceLobes, PassingLightUnderLamps) { expect_equal(passing(), 1e-5); }
TEST_F(ReferenceLobes, StacksUnderLamps) { expect_equal(stacks(), 2e-4); }

// The neutral light's harmonics, whose albedos come from tables.
TEST_F(ReferenceLobes, AmbientLight) {
  Materials some = stacks();
  for (const Materials& all : {coats(), sheens(), films(), stretched(), passing()})
    for (size_t i = 1; i < all.size(); i += all.size() / 4) some.push_back(all[i]);
  expect_equal(some, 2e-3, false);
}

}  // namespace candela::test
