// Reliefs of every technique against the reference, whose rays meet the bilinear heights exactly: which pixels show
// them, at what depth, how they shade, and how they move.
#include "reference/centre_surface.h"
#include "reference_parity.h"
#include "textured_square.h"

namespace candela::test::reference_relief {
namespace {

constexpr int width = 64, height = 48;
constexpr float deep = 0.3f;

std::vector<std::byte> hills(int across) {
  return png_from(32, 32, 3,
                  [=](double u, double v) { return glm::dvec4(glm::dvec3(tiling_noise(u, v, across, 3)), 1); });
}
// A square of hills, aslant to the camera, with a cube that cuts through it.
GltfBuilder hilly(double depth, bool silhouettes = true, bool with_cube = true, int across = 5) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  b.use("CANDELA_relief");
  Json material = {{"pbrMetallicRoughness", base_color(0.8, 0.5, 0.3)}};
  const int texture = add_texture(b, hills(across));
  if (depth >= 0)
    material["extensions"]["CANDELA_relief"] = {
        {"heightTexture", {{"index", texture}}}, {"depth", depth}, {"silhouettes", silhouettes}};
  add_node(b, {{"mesh", add_textured_square(b, add_material(b, material))}});
  if (with_cube) {
    const int small = add_square_mesh(b, 0.4f, add_material(b, {{"pbrMetallicRoughness", base_color(0.2, 0.3, 0.8)}}));
    add_node(b, {{"mesh", small}, {"translation", {0.3, 0.2, -0.15}}});
  }
  add_light(b, {{"type", "point"}, {"intensity", 10.0}}, {{"translation", {-0.8, 0.9, 1.2}}});
  add_light(b, {{"type", "directional"}, {"intensity", 1.0}}, {{"rotation", {-0.35, 0.2, 0.08, 0.91}}});
  return b;
}
Job seen_aslant(const std::string& file, int steps = 0, int refinements = 8) {
  Job job;
  job.scene = file;
  job.width_px = width, job.height_px = height, job.samples = 1, job.tonemap = "none";
  job.camera.eye = glm::dvec3(1.6, -1.1, 1.3), job.camera.target = glm::dvec3(0, 0, -0.1), job.camera.yfov_deg = 50;
  job.settings.push_back({"relief", "steps", std::to_string(steps)});
  job.settings.push_back({"relief", "refinements", std::to_string(refinements)});
  return job;
}

}  // namespace

class ReferenceRelief : public ReferenceParity {
 protected:
  // Of pixels' centres; infinite where there is nothing.
  static std::vector<double> true_depths(const Job& job) {
    std::vector<double> depths;
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return depths;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto there = reference::centre_surface(*(*frame)->world, x, y, width, height);
        depths.push_back(there ? there->depth_m : std::numeric_limits<double>::infinity());
      }
    return depths;
  }
  // Of pixels' centres, with shadows.
  static reference::Film truth_of(const Job& job) {
    reference::Film film(width, height);
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return film;
    reference::TraceSettings settings;
    settings.sampler = {reference::SamplerKind::uniform, 1, 0};
    film.add(reference::Integrator(*(*frame)->world, settings, width, height), 1, [](double) { return true; });
    return film;
  }
  struct Fit {
    size_t seen = 0, missed = 0;  // missed: off by more than a hundredth of the layer, or there and not there
    double rms = 0;               // of the others, metres
  };
  static Fit fit_of(Job job, const std::vector<double>& truth) {
    job.layers = {"depth"};
    job.effects = "none";
    const Images images = images_of(job);
    Fit fit;
    double squares = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double expected = truth[size_t(y * width + x)], found = images["depth"].at(x, y);
        if (!std::isfinite(expected) && found > 1e9) continue;
        ++fit.seen;
        const double off = std::abs(found - expected);
        if (!(off < 0.01 * deep))
          ++fit.missed;
        else
          squares += off * off;
      }
    fit.rms = std::sqrt(squares / double(std::max<size_t>(fit.seen - fit.missed, 1)));
    return fit;
  }
};

TEST_F(ReferenceRelief, TheExactEndIsWhereTheReferencesRaysMeetIt) {
  for (const bool silhouettes : {true, false}) {
    const Job job = seen_aslant(write(hilly(deep, silhouettes)));
    const Fit fit = fit_of(job, true_depths(job));
    EXPECT_GT(fit.seen, 700u);
    EXPECT_LE(fit.missed, 2u) << "outlines alone";
    EXPECT_LT(fit.rms, 2e-6);
  }
}

TEST_F(ReferenceRelief, StepsAndRefinementsTendToIt) {
  const std::string file = write(hilly(deep, true, true, 32));  // a hill of two texels
  const std::vector<double> truth = true_depths(seen_aslant(file));
  std::vector<Fit> by_steps, by_refinements;
  for (const int steps : {8, 32, 128}) by_steps.push_back(fit_of(seen_aslant(file, steps, 8), truth));
  for (const int refinements : {2, 4, 8}) by_refinements.push_back(fit_of(seen_aslant(file, 32, refinements), truth));
  EXPECT_LT(double(by_steps[1].missed), 0.6 * double(by_steps[0].missed));
  EXPECT_LT(by_steps[2].missed, by_steps[1].missed);
  EXPECT_LE(double(by_steps[2].missed), 0.02 * double(by_steps[2].seen));
  EXPECT_LT(by_refinements[1].rms, 0.6 * by_refinements[0].rms);
  EXPECT_LT(by_refinements[2].rms, by_refinements[1].rms) << "down to what the device's filter rounds";
}

TEST_F(ReferenceRelief, EveryTechniqueShadesItAsTheReferenceDoes) {
  const std::string file = write(hilly(deep));
  for (const char* technique : {"clustered", "visibility", "ray", "deferred-clustered", "deferred-volumes"}) {
    Job job = seen_aslant(file);
    job.technique = technique;
    const Pair pair = rendered(job, 1);
    size_t off = 0, seen = 0;
    for (size_t i = 0; i < pair.gpu.size(); ++i) {
      seen += pair.reference[i].w > 0;
      for (int c = 0; c < 4; ++c) ASSERT_TRUE(std::isfinite(pair.gpu[i][c])) << technique;
      const double most = std::max({pair.reference[i].x, pair.reference[i].y, pair.reference[i].z, 1e-2});
      off += glm::length(glm::dvec3(pair.gpu[i] - pair.reference[i])) > 0.01 * most;
    }
    EXPECT_GT(seen, 700u) << technique;
    EXPECT_LE(double(off), 0.01 * double(seen)) << technique << ": more than outlines and creases of cells";
  }
}

TEST_F(ReferenceRelief, ShadowsOfRaysAreThoseOfTheReference) {
  Job job = seen_aslant(write(hilly(deep)));
  job.settings.push_back({"sun", "mode", "traced"});
  job.settings.push_back({"local", "method", "traced"});
  const Images images = images_of(job);
  const reference::Film film = truth_of(job);
  size_t off = 0, seen = 0, dark = 0;
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec3 expected(film.mean(i));
    const glm::vec4 found = images["beauty"].at<glm::vec4>(int(i) % width, int(i) / width);
    seen += film.mean(i).w > 0, dark += film.mean(i).w > 0 && expected.x < 0.05;
    off += glm::length(glm::dvec3(found) - expected) > 0.02 * std::max({expected.x, expected.y, expected.z, 1e-2});
  }
  EXPECT_GT(dark, 10u) << "some of it lies in its own shadow";
  EXPECT_LE(double(off), 0.03 * double(seen));
}

TEST_F(ReferenceRelief, MarchesToLightsTendToTheReferencesShadows) {
  // Joints below a sun that grazes the end of the square by which its light comes in, and a lamp.
  GltfBuilder b = hilly(deep, true, false, 8);
  add_light(b, {{"type", "directional"}, {"intensity", 3.0}}, {{"rotation", {0.0, 0.58, 0.0, 0.8146}}});
  Job job = seen_aslant(write(b));
  job.camera.eye = glm::dvec3(1.9, -0.6, 0.8), job.camera.target = glm::dvec3(0.3, 0, -0.1);
  job.settings.push_back({"sun", "size_px", "1024"});
  job.settings.push_back({"sun", "single_px", "1024"});
  const reference::Film film = truth_of(job);
  const auto off = [&](const char* technique, int steps) {  // of all light
    Job marched = job;
    marched.technique = technique;
    marched.settings.push_back({"relief", "light_steps", std::to_string(steps)});
    const Images images = images_of(marched);
    double sum = 0, all = 0;
    for (size_t i = 0; i < film.pixels(); ++i) {
      const glm::vec4 found = images["beauty"].at<glm::vec4>(int(i) % width, int(i) / width);
      sum += std::abs(double(found.x) - film.mean(i).x), all += film.mean(i).x;
    }
    return sum / all;
  };
  std::vector<double> by_steps;
  for (const int steps : {-1, 4, 16, 64, 0}) by_steps.push_back(off("visibility", steps));
  EXPECT_GT(by_steps[0], 0.04) << "by the map alone: what comes in by the ends is lit";
  EXPECT_LT(by_steps[1], 0.3 * by_steps[0]);
  EXPECT_LT(by_steps[2], 0.5 * by_steps[1]);
  EXPECT_LT(by_steps[3], by_steps[2]);
  EXPECT_LT(by_steps[4], by_steps[3]);
  EXPECT_LT(by_steps[4], 0.004);
  EXPECT_LT(off("clustered", 0), 0.004);
}

TEST_F(ReferenceRelief, OfDepthZeroIsTheFlatSquareBitForBit) {
  const std::string flat = write(hilly(-1));
  const auto flat_bytes = images_of(seen_aslant(flat));
  const std::string none = write(hilly(0));
  EXPECT_EQ(flat_bytes["beauty"].bytes, images_of(seen_aslant(none))["beauty"].bytes);
}

TEST_F(ReferenceRelief, ASceneWithoutOneHoldsNothingOfIt) {
  const std::string flat = write(hilly(-1));
  const auto few = open(seen_aslant(flat, 8)), many = open(seen_aslant(flat, 0));
  ASSERT_TRUE(few && many);
  const FrameResult a = render(*few), b = render(*many);
  EXPECT_EQ(a.plan_hash, b.plan_hash) << "its knobs do nothing";
}

TEST_F(ReferenceRelief, MovesWithItsSquare) {
  GltfBuilder b = hilly(deep, true, false);
  const int times = b.accessor<float>("SCALAR", {0, 1}), places = b.accessor<float>("VEC3", {0, 0, 0, 0.24f, 0, 0});
  b.json["animations"].push_back(
      {{"samplers", {{{"input", times}, {"output", places}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  Job job = seen_aslant(write(b));
  job.camera.eye = glm::dvec3(0.3, -0.2, 2), job.camera.target = glm::dvec3(0.3, -0.2, 0);
  job.layers = {"motion", "depth"};
  const Images images = images_of(job, {}, 0.5);
  const double px = height / (2 * std::tan(25 * std::numbers::pi / 180));
  size_t seen = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double z = images["depth"].at(x, y);
      if (z > 1e9) continue;
      ++seen;
      const glm::vec2 moved = images["motion"].at<glm::vec2>(x, y);
      ASSERT_NEAR(moved.x, 0.01 * px / z, 1e-4) << x << " " << y;
      ASSERT_NEAR(moved.y, 0, 1e-4) << x << " " << y;
    }
  EXPECT_GT(seen, 700u);
}

}  // namespace candela::test::reference_relief
