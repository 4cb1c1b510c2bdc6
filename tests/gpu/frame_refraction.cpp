// Surfaces that let light through, in whole frames: known values of sheets and slabs, what is blended about them, light
// that passes them, and frosted ones against the traced truth.
#include <numbers>

#include "glass_fixture.h"
#include "passes/surfaces/terms.h"
#include "render/reference_frame.h"

namespace candela::test::frame_refraction {
namespace {

constexpr int width = glass_width, height = glass_height;

}  // namespace

class FrameRefraction : public GlassTest {};

TEST_F(FrameRefraction, ASheetTintsWhatIsBehind) {
  GltfBuilder b = dark();
  add_wall(b);
  add_sheet(b, glass_material({.color = {0.9, 0.5, 0.1}}), 0.5f, {-0.6, 0, 0});
  add_sheet(b, glass_material({.transmission = 0.25}), 0.5f, {0.6, 0, 0});
  for (const int samples : {1, 4}) {
    for (const char* lobe : {"0", "8"}) {
      Job job = seen(b, samples);
      job.settings = {{"refraction", "samples", lobe}};
      const Images images = images_of(job);
      expect_color(images["beauty"].at<glm::vec4>(22, 24), wall_colour * glm::dvec3(0.9, 0.5, 0.1), "tinted");
      expect_color(images["beauty"].at<glm::vec4>(42, 24), wall_colour * 0.25, "a quarter goes through");
      expect_color(images["beauty"].at<glm::vec4>(3, 3), wall_colour, "beside");
      EXPECT_EQ(images["beauty"].at<glm::vec4>(22, 24).w, 1);
    }
  }
}

// The copy of the next lower power of two alone: even colours stay, edges behind a clear sheet are as wide as its
// texels, and where the picture's sides are powers of two its copy is the picture.
TEST_F(FrameRefraction, TheCopyInAPowerOfTwoIsTheCoarserPicture) {
  GltfBuilder b = dark();
  add_wall(b);
  add_sheet(b, unlit_material(0, 0, 0), 0.25f, {0, 0, -0.2});
  add_sheet(b, glass_material({.color = {0.9, 0.5, 0.1}}), 0.6f);
  for (const int samples : {1, 4}) {
    Job job = seen(b, samples);
    const auto with = [&](const char* full, int w, int h) {
      job.settings = {{"refraction", "samples", "0"}, {"refraction", "full_size", full}};
      job.width_px = w, job.height_px = h;
      return images_of(job)["beauty"];
    };
    const Image whole = with("1", 60, 44), copy = with("0", 60, 44);
    double most = 0;
    for (int y = 0; y < 44; ++y)
      for (int x = 0; x < 60; ++x)
        most = std::max(most, double(glm::length(whole.at<glm::vec4>(x, y) - copy.at<glm::vec4>(x, y))));
    EXPECT_GT(most, 0.02);
    EXPECT_EQ(whole.at<glm::vec4>(3, 3), copy.at<glm::vec4>(3, 3));
    EXPECT_TRUE(with("1", 64, 32) == with("0", 64, 32));
  }
}

// A blended sheet lets light through where its alpha covers, and beside that shows what is behind as it is; by either
// method, and in the terms, and where refraction is not wanted it is a blended surface like others.
TEST_F(FrameRefraction, ABlendedSheetCoversByItsAlpha) {
  GltfBuilder b = dark();
  add_wall(b);
  const glm::dvec3 tint(0.9, 0.5, 0.1);
  Json pane = glass_material({.color = tint});
  pane["alphaMode"] = "BLEND", pane["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.25;
  add_sheet(b, pane);
  const glm::dvec3 expected = wall_colour * (0.25 * tint + 0.75);
  for (const char* method : {"sorted", "layers", "phenomenological"})
    for (const int samples : {1, 4}) {
      Job job = seen(b, samples);
      job.transparency = method;
      const auto session = open(job);
      const FrameResult frame = render(*session);
      expect_color(images(frame)["beauty"].at<glm::vec4>(32, 24), expected, method);
      for (const std::string& note : frame.notes) EXPECT_EQ(note.find("not drawn"), std::string::npos) << note;
    }
  Job job = seen(b);
  job.layers = {"background"};
  expect_color(images_of(job)["background"].at<glm::vec4>(32, 24), expected, "the term");
  job.effects = "none", job.layers.clear();
  expect_color(images_of(job)["beauty"].at<glm::vec4>(32, 24), wall_colour * 0.75, "blended");
}

// Nothing is behind: as transparent as the colour that it lets most of through, by either method.
TEST_F(FrameRefraction, NothingBehindLeavesAlpha) {
  GltfBuilder b = dark();
  add_sheet(b, glass_material({.color = {0.9, 0.5, 0.1}}));
  for (const char* method : {"sorted", "phenomenological"})
    for (const int samples : {1, 4}) {
      Job job = seen(b, samples);
      job.transparency = method;
      const Images images = images_of(job);
      EXPECT_NEAR(images["beauty"].at<glm::vec4>(32, 24).w, 0.1, 1e-6) << method;
      EXPECT_EQ(images["beauty"].at<glm::vec4>(1, 1).w, 0) << method;
    }
}

// A body of the index of air: both sides tint, and light is absorbed over the thickness, which grows with the node.
TEST_F(FrameRefraction, ABodyAbsorbsByItsThickness) {
  GltfBuilder b = dark();
  add_wall(b);
  const Glass body{.color = {0.9, 0.8, 0.7}, .thickness_m = 0.25, .attenuation = {0.2, 0.5, 1}, .distance_m = 0.5};
  add_sheet(b, glass_material(body), 0.25f, {-0.6, 0, 0}, 2);
  add_sheet(b, glass_material(body), 0.5f, {0.6, 0, 0});
  const Images images = images_of(seen(b));
  const glm::dvec3 both = wall_colour * glm::dvec3(0.81, 0.64, 0.49);
  expect_color(images["beauty"].at<glm::vec4>(22, 24), both * glm::dvec3(0.2, 0.5, 1), "twice as large");
  expect_color(images["beauty"].at<glm::vec4>(42, 24), both * glm::sqrt(glm::dvec3(0.2, 0.5, 1)), "as it is");
}

// A slab of index 1.5 before a wall of two colours, seen at a slant: each pixel shows the colour at the place where
// Snell's law takes its ray, from the slab on in its old direction. By `phenomenological` each of two slabs moves what
// is behind by its own part.
TEST_F(FrameRefraction, SlabsShiftWhatIsBehind) {
  struct Case {
    const char* method;
    int slabs;
    double wall_m, seam_m, edge_m;  // the wall's z, where its colours meet, and how near that nothing is compared
    int shifted;                    // pixels that must show another colour than without the slab
  };
  for (const auto& [method, slabs, wall_m, seam_m, edge_m, least_shifted] :
       {Case{"sorted", 1, -1, 0, 0.08, 3}, Case{"phenomenological", 1, -1, 0, 0.08, 3},
        Case{"phenomenological", 2, -1, 0, 0.08, 3}, Case{"sorted", 1, -3, -1.5, 0.25, 0},
        Case{"phenomenological", 1, -3, -1.5, 0.25, 0}}) {
    SCOPED_TRACE(fmt::format("{}, {} slabs, wall at {} m", method, slabs, wall_m));
    GltfBuilder b = dark();
    const glm::dvec3 right_colour(0.8, 0.3, 0.1);
    for (const int side : {-1, 1}) {
      const glm::dvec3 c = side < 0 ? wall_colour : right_colour;
      const int mesh = add_square_mesh(b, 3, add_material(b, unlit_material(c.x, c.y, c.z)));
      add_node(b, {{"mesh", mesh}, {"translation", {seam_m + 3 * side, 0, wall_m}}});
    }
    const double thickness = 0.95;
    for (int i = 0; i < slabs; ++i)
      add_sheet(b, glass_material({.ior = 1.5, .thickness_m = thickness / slabs}), 1.5f, {0, 0, -0.05 * i});
    Job job = seen(b);
    job.transparency = method;
    const glm::dvec3 eye(3, 0, 2.6);
    look(job, eye, {0, 0, 0}, 40);
    job.settings = {{"refraction", "samples", "1"}};
    const Images images = images_of(job);
    const glm::dvec3 forward = glm::normalize(-eye), up(0, 1, 0), right = glm::cross(forward, up);
    const double tan_half = std::tan(glm::radians(20.0));
    int shifted = 0, compared = 0;
    for (int x = 0; x < width; ++x) {
      const double ndc = 2 * (x + 0.5) / width - 1;
      const glm::dvec3 d = glm::normalize(forward + right * (ndc * tan_half * width / height));
      const glm::dvec3 at = eye - d * (eye.z / d.z);
      if (std::abs(at.x) > 1.4) continue;
      const glm::dvec3 inside = glm::refract(d, glm::dvec3(0, 0, 1), 1 / 1.5);
      const glm::dvec3 exit = at + inside * thickness, met = exit + d * ((wall_m - exit.z) / d.z);
      const double straight = at.x + d.x * (wall_m / d.z);
      if (std::abs(met.x - seam_m) < edge_m) continue;
      const glm::vec4 colour = images["beauty"].at<glm::vec4>(x, height / 2);
      EXPECT_EQ(colour.x > colour.z, met.x > seam_m) << x;
      shifted += (met.x > seam_m) != (straight > seam_m);
      ++compared;
    }
    EXPECT_GT(compared, 20);
    EXPECT_GE(shifted, least_shifted);
  }
}

TEST_F(FrameRefraction, BlendedSurfacesStandBehindAndBefore) {
  GltfBuilder b = dark();
  add_wall(b);
  add_sheet(b, glass_material({.color = {0.5, 0.5, 0.5}}));
  Json haze = unlit_material(1, 1, 1, 0.5);
  haze["alphaMode"] = "BLEND";
  add_sheet(b, haze, 0.3f, {-0.5, 0, -0.5});
  add_sheet(b, haze, 0.3f, {0.5, 0, 0.5});
  for (const int samples : {1, 4}) {
    const Images images = images_of(seen(b, samples));
    const glm::dvec3 hazy = 0.5 * wall_colour + 0.5;
    expect_color(images["beauty"].at<glm::vec4>(25, 24), 0.5 * hazy, "behind");
    expect_color(images["beauty"].at<glm::vec4>(42, 24), 0.25 * wall_colour + 0.5, "before");
    expect_color(images["beauty"].at<glm::vec4>(32, 24), 0.5 * wall_colour, "glass alone");
  }
}

// Terms sum to beauty, and asking for layers changes no bit of it; lights shine through.
TEST_F(FrameRefraction, TermsSumToBeauty) {
  GltfBuilder b = dark();
  add_wall(b);
  Json part = glass_material({.color = {0.9, 0.6, 0.3}, .roughness = 0.3, .ior = 1.5, .transmission = 0.7});
  part["emissiveFactor"] = {0.1, 0.2, 0.1};
  add_sheet(b, part);
  Json haze = diffuse_material(0.9, 0.9, 0.9);
  haze["alphaMode"] = "BLEND";
  haze["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
  add_sheet(b, haze, 0.4f, {0.5, 0.2, 0.5});
  add_sheet(b, diffuse_material(0.8, 0.2, 0.2), 0.3f, {-0.6, 0, -0.5});
  add_light(b, {{"type", "point"}, {"intensity", 5.0}}, {{"translation", {0.5, 0.5, 2}}});
  for (const int samples : {1, 4}) {
    Job job = seen(b, samples);
    const Images bare = images_of(job);
    for (const LayerName& term : Terms::layers) job.layers.emplace_back(term.name);
    const Images images = images_of(job);
    EXPECT_EQ(images["beauty"], bare["beauty"]);
    const auto beauty = images["beauty"].values<glm::vec4>();
    std::vector<glm::dvec3> sum(beauty.size());
    for (const LayerName& term : Terms::layers) {
      const auto values = images[std::string(term.name)].values<glm::vec4>();
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += glm::dvec3(values[i]);
    }
    for (size_t i = 0; i < sum.size(); ++i)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(sum[i][c], beauty[i][c], 4e-6 * (1 + sum[i][c])) << i;
  }
}

// Shadows by maps and by rays, and occlusion by rays: the floor behind glass is lit as without it.
TEST_F(FrameRefraction, LightPassesGlass) {
  const auto lit_floor = [&](bool with_glass) {
    GltfBuilder b = dark();
    add_sheet(b, diffuse_material(0.8, 0.8, 0.8), 3);
    if (with_glass) add_sheet(b, glass_material({}), 0.4f, {0.7, 0.3, 0.8});
    add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
              {{"rotation", rotation_between({0, 0, -1}, {-0.5, 0, -1})}});
    add_light(b, {{"type", "point"}, {"intensity", 5.0}}, {{"translation", {1.2, 0.4, 2}}});
    return b;
  };
  for (const char* method : {"maps", "traced"}) {
    Job job = seen(lit_floor(false));
    job.effects = "refraction,shadows";
    job.settings = {{"sun", "mode", method == std::string("maps") ? "cascades" : "traced"},
                    {"local", "method", method},
                    {"lights", "floor_lux", "0"},
                    {"colored_shadows", "scale", "off"}};
    const Images without = images_of(job);
    Job job_with = seen(lit_floor(true));
    job_with.effects = job.effects, job_with.settings = job.settings;
    const Images with = images_of(job_with);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        expect_color(with["beauty"].at<glm::vec4>(x, y), without["beauty"].at<glm::vec4>(x, y),
                     fmt::format("{} {},{}", method, x, y), 2e-5);
  }
}

// More samples tend to the lobe's own integral, and that is the frosted sheet of the traced truth.
TEST_F(FrameRefraction, SamplesTendToTheTruth) {
  GltfBuilder b = dark();
  add_wall(b, -2);
  const glm::dvec3 posts[] = {{0.9, 0.1, 0.1}, {0.1, 0.9, 0.1}, {0.9, 0.9, 0.1}};
  for (int i = 0; i < 3; ++i)
    add_sheet(b, unlit_material(posts[i].x, posts[i].y, posts[i].z), 0.2f, {-0.7 + 0.7 * i, 0, -0.1 - 0.4 * i});
  add_sheet(b, glass_material({.roughness = 0.35}), 1.2f);
  Job job = seen(b, 4);
  const auto with = [&](const char* samples) {
    job.settings = {{"refraction", "samples", samples}};
    return images_of(job)["beauty"].values<glm::vec4>();
  };
  const auto rms = [](const auto& a, const auto& truth) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c) sum += std::pow(double(a[i][c]) - double(truth[i][c]), 2);
    return std::sqrt(sum / double(3 * a.size()));
  };
  const auto converged = with("512");
  const double few = rms(with("4"), converged), some = rms(with("16"), converged), many = rms(with("64"), converged);
  EXPECT_LT(some, 0.7 * few);
  EXPECT_LT(many, 0.7 * some);

  job.settings = {};
  const auto frame = open_reference(job, 0, {}, reference::Mode::path);
  ASSERT_TRUE(frame) << frame.error().text();
  reference::TraceSettings settings;
  settings.mode = reference::Mode::path;
  reference::Film film(width, height, {});
  film.add(reference::Integrator(*(*frame)->world, settings, width, height), 128, [](double) { return true; });
  std::vector<glm::dvec3> truth;
  for (size_t i = 0; i < converged.size(); ++i) truth.push_back(glm::dvec3(film.mean(i)));
  const double model = rms(converged, truth), blurred_alike = rms(with("0"), truth);
  EXPECT_LT(model, 0.03);
  EXPECT_GT(blurred_alike, 2 * model);
}

TEST_F(FrameRefraction, IsLeftOutWhereNothingRefracts) {
  GltfBuilder b = dark();
  add_wall(b);
  const auto plan = [](const Job& job) { return plan_text(*render(*open(job)).plan); };
  EXPECT_NE(plan(seen(b)).find("the scene has no surface that refracts"), std::string::npos);
  add_sheet(b, glass_material({}));
  Job job = seen(b);
  EXPECT_EQ(plan(job).find("the scene has no surface that refracts"), std::string::npos);
  job.effects = "none";
  EXPECT_NE(plan(job).find("refraction is not wanted"), std::string::npos);
}

}  // namespace candela::test::frame_refraction
