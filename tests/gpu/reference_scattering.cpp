// Bodies that scatter light on the GPU: slabs, as `direct` has them; and what slabs are wrong by against `path`.
#include "reference_parity.h"
#include "testscenes/make_scene.h"

namespace candela::test {
namespace {

using Materials = std::vector<Json>;

Json body(double entering, glm::dvec3 color, double depth, double anisotropy, double metallic = 0) {
  Json pbr = base_color(0.8, 0.4, 0.2);
  pbr["metallicFactor"] = metallic, pbr["roughnessFactor"] = 0.5;
  return {{"pbrMetallicRoughness", pbr},
          {"doubleSided", true},
          {"extensions",
           {{"KHR_materials_diffuse_transmission",
             {{"diffuseTransmissionFactor", entering}, {"diffuseTransmissionColorFactor", {0.9, 1, 0.7}}}},
            {"KHR_materials_volume",
             {{"thicknessFactor", 0.5},
              {"attenuationDistance", 0.5 / depth},
              {"attenuationColor", {std::exp(-1.0), std::exp(-0.5), std::exp(-2.0)}}}},
            {"KHR_materials_volume_scatter",
             {{"multiscatterColorFactor", {color.x, color.y, color.z}}, {"scatterAnisotropy", anisotropy}}}}}};
}

}  // namespace

class ReferenceScattering : public ReferenceParity {
 protected:
  static void use(GltfBuilder& b) {
    use_materials(b);
    for (const char* name :
         {"KHR_materials_volume_scatter", "KHR_materials_volume", "KHR_materials_diffuse_transmission"})
      b.use(name);
  }
  // Squares side by side, each of a material; the nodes of a row are scaled.
  static GltfBuilder squares(const Materials& materials) {
    GltfBuilder b = empty_scene();
    use(b);
    int i = 0;
    for (const Json& m : materials) {
      const double scale = i / 6 == 1 ? 0.5 : 1;
      add_node(b, {{"mesh", add_square_mesh(b, float(0.47 / scale), add_material(b, m))},
                   {"translation", {i % 6 - 2.5, 1.0 - i / 6, 0}},
                   {"scale", {scale, scale, scale}}});
      ++i;
    }
    return b;
  }
  static double worst_error(const GltfBuilder& b, glm::dvec3 eye, std::vector<KnobSetting> settings = {}) {
    Job job = job_for(write(b), 60, 40);
    look(job, eye, glm::dvec3(0), 55);
    job.settings = std::move(settings);
    const Pair pair = rendered(job, 1);
    double worst = 0;
    size_t lit = 0;
    for (size_t i = 0; i < pair.gpu.size(); ++i) {
      if (pair.gpu[i].w != pair.reference[i].w) continue;  // on a square's edge
      for (int c = 0; c < 3; ++c) {
        EXPECT_TRUE(std::isfinite(pair.gpu[i][c]));
        if (pair.reference[i][c] < 1e-3) continue;
        ++lit;
        worst = std::max(worst, std::abs(pair.gpu[i][c] / pair.reference[i][c] - 1));
      }
    }
    EXPECT_GT(lit, 300u);
    return worst;
  }
};

TEST_F(ReferenceScattering, SlabsAreThoseOfDirectLight) {
  Materials all;
  for (const double entering : {0.3, 1.0})
    for (const double depth : {1e-6, 0.5, 30.0})
      for (const double anisotropy : {-0.5, 0.8})
        all.push_back(body(entering, {1, 0.6, 0}, depth, anisotropy, depth == 0.5 ? 0.3 : 0));
  GltfBuilder b = squares(all);
  add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {-2, 0.25, 1.75}}});
  add_light(b, {{"type", "directional"}, {"intensity", 2.0}}, {{"rotation", {-0.3, 0.2, 0.1, 0.9274}}});
  add_light(b, {{"type", "point"}, {"intensity", 15.0}}, {{"translation", {1, 0.5, -1.5}}});
  for (const glm::dvec3 eye : {glm::dvec3(0.3, -0.5, 5), glm::dvec3(0.5, 0.6, -5)})
    EXPECT_LT(worst_error(b, eye), 2e-5);
  // A G-buffer and triangles shaded in one pass each hold the same.
  for (const char* technique : {"deferred-clustered", "visibility"}) {
    Job job = job_for(write(b), 60, 40);
    look(job, {0.3, -0.5, 5}, glm::dvec3(0), 55);
    job.effects = "none";
    const Image forward = images_of(job)["beauty"];
    job.technique = technique;
    const Image other = images_of(job)["beauty"];
    for (size_t i = 0; i < 4 * forward.pixels(); ++i)
      ASSERT_NEAR(forward.values<float>()[i], other.values<float>()[i], 1e-5) << technique;
  }
}

TEST_F(ReferenceScattering, SlabsUnderAmbientLight) {
  Materials all;
  for (const double depth : {0.5, 3.0, 30.0}) all.push_back(body(1, {1, 0.6, 0}, depth, 0));
  GltfBuilder b = squares(all);
  EXPECT_LT(worst_error(b, {0.3, 0.5, 4}), 2e-3);
}

// Light from behind comes in at the slab's other side, whatever of the body itself lies between; what stands behind the
// body keeps it off: with maps and rays.
TEST_F(ReferenceScattering, ABodyDoesNotShadowItself) {
  const std::vector<KnobSetting> maps, rays = {{"local", "method", "traced"}, {"sun", "mode", "traced"}};
  for (const bool lamp : {false, true})
    for (const auto& settings : {maps, rays}) {
      GltfBuilder b = empty_scene();
      use(b);
      const int mesh = add_square_mesh(b, 0.4f, add_material(b, body(1, {0.9, 0.9, 0.9}, 0.5, 0)));
      for (const double x : {-1.0, 1.0}) {
        add_node(b, {{"mesh", mesh}, {"translation", {x, 0, 0}}});
        add_node(b, {{"mesh", mesh}, {"translation", {x, 0, -0.49}}, {"rotation", {1, 0, 0, 0}}});
      }
      add_node(b, {{"mesh", add_square_mesh(b, 0.8f, add_material(b, diffuse_material(1, 1, 1)))},
                   {"translation", {1, 0, -0.8}}});
      if (lamp)
        add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {0, 0, -4}}});
      else
        add_light(b, {{"type", "directional"}, {"intensity", 1.0}},
                  {{"rotation", rotation_between({0, 0, -1}, {0, 0, 1})}});
      Job job = job_for(write(b), 48, 24);
      look(job, {0, 0, 4}, {0, 0, 0}, 30);
      job.settings = settings;
      const Image image = images_of(job)["beauty"];
      EXPECT_GT(image.at<glm::vec4>(13, 12).x, 0.02f) << lamp << settings.size();
      EXPECT_EQ(image.at<glm::vec4>(34, 12).x, 0) << lamp << settings.size();
    }
}

// The made scene under quality high against the walk, all shaders of it under validation. relMSE, as
// docs/understanding/materials.md states it.
TEST_F(ReferenceScattering, TheErrorAgainstTheWalk) {
  const std::string file = ::testing::TempDir() + "candela_scattering.glb";
  const auto made = make_scene("scattering", 1, 0, file);
  ASSERT_TRUE(made) << made.error().text();
  Job job = job_for(file, 64, 36);
  job.quality = "high";
  const Images images = images_of(job);
  auto frame = open_reference(job, 0, {}, reference::Mode::path);
  ASSERT_TRUE(frame) << frame.error().text();
  reference::TraceSettings settings;
  settings.mode = reference::Mode::path;
  reference::Film film(job.width_px, job.height_px);
  film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), 32,
           [](double) { return true; });
  Pair pair;
  for (size_t i = 0; i < film.pixels(); ++i) {
    pair.gpu.push_back(glm::dvec4(images["beauty"].values<glm::vec4>()[i]));
    pair.reference.push_back(film.mean(i));
  }
  glm::dvec4 gpu(0), walked(0);
  for (size_t i = 0; i < film.pixels(); ++i) gpu += pair.gpu[i], walked += pair.reference[i];
  const glm::dvec3 fraction = glm::dvec3(gpu) / glm::dvec3(walked);
  fmt::print("relMSE {:.4f}, mean {:.3f} {:.3f} {:.3f} of the walk's\n", pair.relmse(), fraction.x, fraction.y,
             fraction.z);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(fraction[c], 0.8, 0.04) << c;
  EXPECT_LT(pair.relmse(), 0.085);
  EXPECT_EQ(images["beauty"], images_of(with_layers(job))["beauty"]);
}

}  // namespace candela::test
