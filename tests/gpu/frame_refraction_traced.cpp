// Refraction by rays, in whole frames: a slab and a ball against Snell's law, a scene of bodies against paths, and
// numbers at extreme indices, angles and places.
#include "../unit/reference_fixture.h"
#include "glass_fixture.h"
#include "passes/surfaces/terms.h"
#include "render/reference_frame.h"
#include "testscenes/make_scene.h"

namespace candela::test::frame_refraction_traced {
namespace {

constexpr glm::dvec3 right_colour(0.8, 0.3, 0.1);

}  // namespace

class FrameRefractionTraced : public GlassTest {
 protected:
  // Two walls of different colours that meet at x = seam_m.
  static void add_two_walls(GltfBuilder& b, double z, double seam_m) {
    for (const int side : {-1, 1}) {
      const glm::dvec3 c = side < 0 ? wall_colour : right_colour;
      const int mesh = add_square_mesh(b, 3, add_material(b, unlit_material(c.x, c.y, c.z)));
      add_node(b, {{"mesh", mesh}, {"translation", {seam_m + 3 * side, 0, z}}});
    }
  }
  // Two squares that bound a body from z = 0 to -thickness_m.
  static void add_slab(GltfBuilder& b, Json material, double thickness_m, float half = 1.5f) {
    const int mesh = add_square_mesh(b, half, add_material(b, std::move(material)));
    add_node(b, {{"mesh", mesh}});
    add_node(b, {{"mesh", mesh}, {"translation", {0, 0, -thickness_m}}, {"rotation", {0, 1, 0, 0}}});
  }
  static Job traced(const GltfBuilder& b, int samples = 1) {
    Job job = seen(b, samples);
    job.settings = {{"refraction", "method", "traced"}};
    return job;
  }
  static glm::dvec3 ray_through(glm::dvec3 eye, int x) {
    const glm::dvec3 forward = glm::normalize(-eye), right = glm::cross(forward, glm::dvec3(0, 1, 0));
    const double ndc = 2 * (x + 0.5) / glass_width - 1;
    return glm::normalize(forward + right * (ndc * std::tan(glm::radians(20.0)) * glass_width / glass_height));
  }
};

// A ray through a slab goes on in its direction, moved by d sin(a - a') / cos a': each pixel shows the wall's colour
// there, as bright as two interfaces and two crossings of the tint leave it.
TEST_F(FrameRefractionTraced, ASlabMovesWhatIsBehind) {
  constexpr double thickness = 0.9, ior = 1.5, wall_m = -3, seam_m = -1.5;
  GltfBuilder b = dark();
  add_two_walls(b, wall_m, seam_m);
  add_slab(b, glass_material({.color = {0.9, 0.9, 0.9}, .ior = ior, .thickness_m = 0.1}), thickness);
  const glm::dvec3 eye(3, 0, 2.6);
  for (const int samples : {1, 4}) {
    Job job = traced(b, samples);
    look(job, eye, {0, 0, 0}, 40);
    const Images images = images_of(job);
    int compared = 0, moved = 0;
    for (int x = 0; x < glass_width; ++x) {
      const glm::dvec3 d = ray_through(eye, x), at = eye - d * (eye.z / d.z);
      if (std::abs(at.x) > 1.4) continue;
      const double angle = std::acos(-d.z), inside = std::asin(std::sin(angle) / ior);
      const double shift = thickness * std::sin(angle - inside) / std::cos(inside);
      const double straight = at.x + d.x * (wall_m / d.z), met = straight + shift / std::cos(angle);
      if (std::abs(at.x + d.x / std::sin(angle) * std::tan(inside) * thickness) > 1.4) continue;
      if (std::abs(met - seam_m) < 0.15) continue;
      const glm::vec4 colour = images["beauty"].at<glm::vec4>(x, glass_height / 2);
      const double r1 = std::sin(angle - inside) / std::sin(angle + inside);
      const double r2 = std::tan(angle - inside) / std::tan(angle + inside), left = 1 - 0.5 * (r1 * r1 + r2 * r2);
      const glm::dvec3 expected = (met > seam_m ? right_colour : wall_colour) * (0.81 * left * left);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour[c], expected[c], 0.002) << x;
      moved += (met > seam_m) != (straight > seam_m);
      ++compared;
    }
    EXPECT_GT(compared, 12);
    EXPECT_GT(moved, 0);
  }
}

// A ball turns the picture round: refracted twice by Snell's law at a sphere.
TEST_F(FrameRefractionTraced, ABallIsALens) {
  constexpr double radius = 0.8, ior = 1.5, wall_m = -3;
  GltfBuilder b = dark();
  add_two_walls(b, wall_m, 0.1);
  const Json glass = glass_material({.ior = ior, .thickness_m = 0.1});
  add_node(b, {{"mesh", reference::test::add_sphere_mesh(b, radius, add_material(b, glass), 48)}});
  const Images images = images_of(traced(b));
  const glm::dvec3 eye(0, 0, 4);
  int compared = 0, turned = 0;
  for (int x = 0; x < glass_width; ++x) {
    const glm::dvec3 d = ray_through(eye, x);
    const double along = -glm::dot(eye, d), across2 = glm::dot(eye, eye) - along * along;
    if (!(across2 < 0.8 * radius * radius)) continue;
    const glm::dvec3 in = eye + d * (along - std::sqrt(radius * radius - across2)), n = in / radius;
    const glm::dvec3 inside = glm::refract(d, n, 1 / ior), out = in - 2 * glm::dot(in, inside) * inside;
    const glm::dvec3 onward = glm::refract(inside, -out / radius, ior),
                     met = out + onward * ((wall_m - out.z) / onward.z);
    if (std::abs(met.x - 0.1) < 0.15) continue;
    const glm::vec4 colour = images["beauty"].at<glm::vec4>(x, glass_height / 2);
    EXPECT_EQ(colour.x > colour.z, met.x > 0.1) << x;
    turned += (met.x > 0) != (d.x > 0);
    ++compared;
  }
  EXPECT_GT(compared, 10);
  EXPECT_GT(turned, 8);
}

// The made scene of sheets and bodies against paths: rays are nearer than the picture behind slabs; and more walls
// bring no more error.
TEST_F(FrameRefractionTraced, IsNearerToPathsThanTheScreen) {
  const std::string file = ::testing::TempDir() + "candela_refraction_glass.glb";
  ASSERT_TRUE(make_scene("glass", 1, 0, file));
  Job job = job_for(file, 64, 36);
  job.quality = "high";
  const auto frame = open_reference(job, 0, {}, reference::Mode::path);
  ASSERT_TRUE(frame) << frame.error().text();
  reference::TraceSettings settings;
  settings.mode = reference::Mode::path;
  reference::Film film(job.width_px, job.height_px, {});
  film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), 32,
           [](double) { return true; });
  const auto error = [&](const std::vector<KnobSetting>& knobs) {
    job.settings = {{"supersample", "n", "2"}, {"refraction", "samples", "16"}};
    job.settings.insert(job.settings.end(), knobs.begin(), knobs.end());
    const auto picture = images_of(job)["beauty"].values<glm::vec4>();
    double sum = 0;
    for (size_t i = 0; i < picture.size(); ++i)
      for (int c = 0; c < 3; ++c)
        sum += std::pow(picture[i][c] - film.mean(i)[c], 2) / (std::pow(film.mean(i)[c], 2) + 0.01);
    return sum / (3 * double(picture.size()));
  };
  const double screen = error({{"refraction", "method", "screen"}});
  std::vector<double> by_walls;
  for (const char* walls : {"1", "2", "8"})
    by_walls.push_back(error({{"refraction", "method", "traced"}, {"refraction", "walls", walls}}));
  fmt::print("relMSE by screen {:.4f}; by rays of 1, 2, 8 walls {:.4f}\n", screen, fmt::join(by_walls, " "));
  for (size_t i = 1; i < by_walls.size(); ++i) EXPECT_LE(by_walls[i], by_walls[i - 1]);
  EXPECT_LT(by_walls.back(), 0.3 * screen);
}

// Terms sum to beauty, and asking for them changes no bit of it.
TEST_F(FrameRefractionTraced, TermsSumToBeauty) {
  GltfBuilder b = dark();
  add_two_walls(b, -1, 0);
  add_slab(b, glass_material({.color = {0.9, 0.6, 0.3}, .ior = 1.5, .transmission = 0.7, .thickness_m = 0.1}), 0.3, 1);
  add_light(b, {{"type", "point"}, {"intensity", 5.0}}, {{"translation", {0.5, 0.5, 2}}});
  Job job = traced(b, 4);
  const Images bare = images_of(job);
  for (const LayerName& term : Terms::layers) job.layers.emplace_back(term.name);
  const Images images = images_of(job);
  EXPECT_EQ(images["beauty"], bare["beauty"]);
  for (int y = 0; y < glass_height; ++y)
    for (int x = 0; x < glass_width; ++x) {
      glm::dvec3 sum(0);
      for (const LayerName& term : Terms::layers) sum += glm::dvec3(images[std::string(term.name)].at<glm::vec4>(x, y));
      expect_color(images["beauty"].at<glm::vec4>(x, y), sum, fmt::format("{},{}", x, y), 1e-5);
    }
}

// Index 1 and a million, dispersion beyond reason, nearly no thickness, a camera that grazes a wall, one in a body
// where walls reflect all.
TEST_F(FrameRefractionTraced, GivesNumbersWhateverTheBody) {
  struct Case {
    double ior, thickness_m;
    glm::dvec3 eye;
  };
  const glm::dvec3 before(0, 0, 4), grazing(4, 0, 1e-4), within(-1.2, 0, -0.2);
  for (const auto& [ior, thickness, eye] : {Case{1, 0.5, within}, Case{1.5, 1e-7, before}, Case{1.5, 0.5, grazing},
                                            Case{1.5, 0.5, within}, Case{1e6, 0.5, before}, Case{1e6, 1e-7, grazing}}) {
    GltfBuilder b = dark();
    add_two_walls(b, -1, 0);
    Json glass = glass_material({.ior = ior,
                                 .thickness_m = 1,
                                 .dispersion = ior == 1.5 ? 1e3 : 0,
                                 .attenuation = {0, 0.5, 1},
                                 .distance_m = 1e-3});
    glass["doubleSided"] = true;
    add_slab(b, glass, thickness);
    Job job = traced(b);
    look(job, eye, {0, 0, -1}, 40);
    job.width_px = 32, job.height_px = 24;
    for (const glm::vec4& v : images_of(job)["beauty"].values<glm::vec4>())
      for (int c = 0; c < 4; ++c)
        ASSERT_TRUE(v[c] >= 0 && v[c] < 2) << ior << " " << thickness << " " << eye.x << " " << eye.z << ": " << v[c];
  }
}

}  // namespace candela::test::frame_refraction_traced
