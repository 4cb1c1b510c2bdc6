// Screen-space reflections in whole frames: known values of mirrors, what they leave to the sky, and against the traced
// layer.
#include "frame_fixture.h"
#include "image/exr.h"
#include "passes/surfaces/terms.h"
#include "render/reference_frame.h"

namespace candela::test::frame_reflections {
namespace {

constexpr int width = 96, height = 64;
constexpr glm::dvec3 wall_colour(0.2, 0.5, 0.9);

}  // namespace

class FrameReflections : public FrameTest {
 protected:
  // A metal floor of half size 2 at y = 0, an unlit wall behind it from y = 0 to 4 at z = -2. `lamp`: a light that
  // gives next to nothing, which keeps the neutral light away: then there is no ambient light.
  static GltfBuilder floor_and_wall(double roughness, bool lamp, bool pane = false, glm::dvec3 of_wall = wall_colour) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    const double h = std::sqrt(0.5);
    Json metal = {{"pbrMetallicRoughness", base_color(1, 1, 1)}};
    metal["pbrMetallicRoughness"]["metallicFactor"] = 1;
    metal["pbrMetallicRoughness"]["roughnessFactor"] = roughness;
    const int floor = add_square_mesh(b, 2, add_material(b, metal));
    add_node(b, {{"mesh", floor}, {"rotation", {-h, 0, 0, h}}});
    const int wall = add_square_mesh(b, 2, add_material(b, unlit_material(of_wall.x, of_wall.y, of_wall.z)));
    add_node(b, {{"mesh", wall}, {"translation", {0, 2, -2}}});
    if (pane) {
      Json glassy = unlit_material(0.9, 0.2, 0.1, 0.5);
      glassy["alphaMode"] = "BLEND";
      add_node(b, {{"mesh", add_square_mesh(b, 0.3f, add_material(b, glassy))}, {"translation", {0.2, 0.4, 1}}});
    }
    if (lamp)
      add_light(b, {{"type", "directional"}, {"intensity", 1e-6}},
                {{"rotation", rotation_between({0, 0, -1}, {0, -1, 0})}});
    return b;
  }
  // Of radiance 0.5 everywhere.
  static std::string even_sky() {
    FloatImage image{.width = 16, .height = 8};
    for (const char* channel : {"R", "G", "B"})
      image.channels.push_back({channel, ChannelType::float32, std::vector<float>(16 * 8, 0.5f), {}});
    const auto bytes = encode_exr(image, ExrCompression::zip, "even");
    if (!bytes) return {};
    const std::string file = ::testing::TempDir() + "candela_reflections_even.exr";
    std::ofstream(file, std::ios::binary).write(bytes->data(), long(bytes->size()));
    return file;
  }
  static Job seen(const std::string& path, int samples = 1, double down = 0) {
    Job job = job_for(path, width, height, samples);
    look(job, {0, 1, 3}, {0, 1 - down, -2}, 60);
    job.effects = "reflections";
    job.layers = {"reflections", "ambient_specular"};
    job.settings = {{"reflections", "fade", "0"}};
    return job;
  }
  // Where the mirrored ray of a pixel's place meets the wall, if it leaves the floor.
  static std::optional<glm::dvec3> mirrored(glm::dvec2 px, double down, int w = width, int h = height) {
    const glm::dvec3 eye(0, 1, 3), forward = glm::normalize(glm::dvec3(0, -down, -5));
    const glm::dvec3 right(1, 0, 0), up = glm::cross(right, forward);
    const double tan_half = std::tan(glm::radians(30.0));
    const glm::dvec2 ndc = 2.0 * px / glm::dvec2(w, h) - 1.0;
    const glm::dvec3 d = forward + right * (ndc.x * tan_half * w / h) - up * (ndc.y * tan_half);
    if (!(d.y < 0)) return {};
    const glm::dvec3 at = eye - d * (eye.y / d.y);
    if (std::abs(at.x) > 1.95 || std::abs(at.z) > 1.95) return {};
    const glm::dvec3 r(d.x, -d.y, d.z);
    return at + r * ((-2 - at.z) / r.z);
  }
  static bool on_wall(glm::dvec3 p) { return std::abs(p.x) < 1.9 && p.y > 0.1 && p.y < 3.9; }
  // How far inside the picture a point is, in parts of its half size; below 0 outside.
  static double inside(glm::dvec3 p, double down) {
    const glm::dvec3 forward = glm::normalize(glm::dvec3(0, -down, -5)), up = glm::cross(glm::dvec3(1, 0, 0), forward);
    const glm::dvec3 off = p - glm::dvec3(0, 1, 3);
    const double z = glm::dot(off, forward), tan_half = std::tan(glm::radians(30.0));
    return 1 - std::max(std::abs(off.x / z) / (tan_half * width / height), std::abs(glm::dot(off, up) / z) / tan_half);
  }
  static void expect_finite(const Images& all, const std::string& what) {
    for (const Image& image : all)
      for (const float v : image.values<float>()) ASSERT_TRUE(std::isfinite(v)) << what << " " << image.layer;
  }
};

// A mirror shows the wall's colour, times what a white metal of the least roughness reflects (at least 0.97).
TEST_F(FrameReflections, AMirrorShowsTheWall) {
  const std::string path = write(floor_and_wall(0, true));
  for (const int samples : {1, 4}) {
    const Images images = images_of(seen(path, samples));
    int compared = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto met = mirrored(glm::dvec2(x, y) + 0.5, 0);
        if (!met || !on_wall(*met) || inside(*met, 0) < 0.05) continue;
        const glm::vec4 value = images["reflections"].at<glm::vec4>(x, y);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c] / wall_colour[c], 0.985, 0.02) << x << "," << y;
        EXPECT_NEAR(images["beauty"].at<glm::vec4>(x, y).x, value.x, 1e-5) << x << "," << y;
        ++compared;
      }
    EXPECT_GT(compared, 700);
  }
}

// What the picture does not show stays the sky, to the last bit; where the wall is met it takes the sky's place.
TEST_F(FrameReflections, OutsideThePictureIsTheSky) {
  const std::string path = write(floor_and_wall(0, false));
  const double down = 2.4;
  Job job = seen(path, 1, down);
  const Images with = images_of(job);
  job.effects = "none";
  const Images bare = images_of(job);
  int outside = 0, met_wall = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto met = mirrored(glm::dvec2(x, y) + 0.5, down);
      if (!met || !on_wall(*met)) continue;
      const glm::vec4 before = bare["beauty"].at<glm::vec4>(x, y), after = with["beauty"].at<glm::vec4>(x, y);
      if (inside(*met, down) < -0.1) {
        EXPECT_EQ(before, after) << x << "," << y;
        ++outside;
      } else if (inside(*met, down) > 0.1) {
        EXPECT_NEAR(with["ambient_specular"].at<glm::vec4>(x, y).x, 0, 1e-4 * before.x) << x << "," << y;
        EXPECT_NEAR(after.z / after.x, wall_colour.z / wall_colour.x, 0.02) << x << "," << y;
        ++met_wall;
      }
    }
  EXPECT_GT(outside, 100);
  EXPECT_GT(met_wall, 100);
  for (const glm::vec4& v : bare["reflections"].values<glm::vec4>()) ASSERT_EQ(glm::vec3(v), glm::vec3(0));
}

// Rays meet the wall whether the picture shows it or not, with any technique and with several samples.
TEST_F(FrameReflections, TracedMirrorsShowWhatThePictureDoesNot) {
  const std::string path = write(floor_and_wall(0, true));
  const double down = 2.4;
  for (const auto& [technique, samples] :
       {std::pair("clustered", 1), {"forward-plus", 4}, {"hybrid", 1}, {"ray", 4}, {"deferred-clustered", 1}}) {
    Job job = seen(path, samples, down);
    job.technique = technique;
    job.settings = {};
    if (job.technique != "ray" && job.technique != "hybrid") job.settings = {{"reflections", "method", "traced"}};
    const Images images = images_of(job);
    int outside = 0, within = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto met = mirrored(glm::dvec2(x, y) + 0.5, down);
        if (!met || !on_wall(*met)) continue;
        const glm::vec4 value = images["reflections"].at<glm::vec4>(x, y);
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(value[c] / wall_colour[c], 0.985, 0.02) << technique << " " << x << "," << y;
        ++(inside(*met, down) < 0 ? outside : within);
      }
    EXPECT_GT(outside, 100) << technique;
    EXPECT_GT(within, 100) << technique;
  }
}

// Orthographic: a camera that looks down at the floor at 45 degrees, made from the scene's own.
TEST_F(FrameReflections, AnOrthographicCameraSeesTheSame) {
  GltfBuilder b = floor_and_wall(0, true);
  b.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2.4}, {"ymag", 1.6}, {"znear", 0.1}, {"zfar", 20}}}}};
  add_node(b, {{"camera", 0},
               {"translation", {0, 4.2, 3}},
               {"rotation", rotation_between({0, 0, -1}, glm::dvec3(0, -0.7, -1))}});
  Job job = job_for(write(b), width, height, 1);
  job.effects = "reflections";
  job.layers = {"reflections"};
  for (const char* method : {"screen", "traced"}) {
    job.settings = {{"reflections", "method", method}};
    const Images images = images_of(job);
    int blue = 0;
    for (const glm::vec4& v : images["reflections"].values<glm::vec4>()) {
      if (!(v.z > 0.5f)) continue;
      EXPECT_NEAR(v.z / v.x, wall_colour.z / wall_colour.x, 0.02);
      ++blue;
    }
    EXPECT_GT(blue, 300) << method;
  }
}

// Any roughness, size, sample count, knob, and a camera that grazes the floor: numbers, and no colour below 0.
TEST_F(FrameReflections, AreNumbersWhateverTheFrame) {
  for (const double roughness : {0.0, 0.5, 1.0}) {
    const std::string path = write(floor_and_wall(roughness, false, true));
    for (const auto& [w, h] : {std::pair(1, 1), std::pair(31, 17), std::pair(2, 65)})
      for (const int samples : {1, 4})
        for (const char* texel : {"1", "2"}) {
          Job job = seen(path, samples);
          job.width_px = w, job.height_px = h;
          look(job, {0, texel[0] == '1' ? 1e-3 : 1.0, 3}, {0, 0, -2}, 60);
          job.settings = {{"reflections", "texel_px", texel},
                          {"reflections", "roughest", "1"},
                          {"reflections", "thickness", samples == 1 ? "0" : "1"}};
          const Images images = images_of(job);
          expect_finite(images, fmt::format("{}x{} {} {}", w, h, samples, roughness));
          for (const glm::vec4& v : images["beauty"].values<glm::vec4>())
            ASSERT_TRUE(v.x >= 0 && v.y >= 0 && v.z >= 0) << w << "x" << h << " " << v.x;
        }
  }
}

// Surfaces from keys in compute are those that the hardware draws again, but for last bits of depth, by which a march
// through the picture may end elsewhere: so few pixels differ, and their sum does not.
TEST_F(FrameReflections, KeyedSurfacesReflectWhatDrawnOnesDo) {
  for (const bool pane : {false, true}) {
    const std::string path = write(floor_and_wall(0.3, false, pane));
    for (const int samples : {1, 4}) {
      Job job = seen(path, samples);
      job.layers = {};
      job.settings.push_back({"reflections", "method", "screen"});
      job.technique = "clustered";
      const Images drawn = images_of(job);
      for (const char* technique : {"visibility", "ray"}) {
        job.technique = technique;
        const Images keyed = images_of(job);
        int apart = 0;
        double sum = 0;
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) {
            const glm::vec4 a = drawn["beauty"].at<glm::vec4>(x, y), b = keyed["beauty"].at<glm::vec4>(x, y);
            apart += glm::length(a - b) > 2e-3f * glm::length(a);
            sum += double(b.z) - double(a.z);
          }
        EXPECT_LT(apart, width * height / 100) << technique << " " << samples << (pane ? " pane" : "");
        EXPECT_LT(std::abs(sum), 1.0) << technique << " " << samples << (pane ? " pane" : "");
      }
    }
  }
}

// Where occlusion is traced with the surfaces, reflections take away what is left of the sky and no more: no pixel is
// darker than without light.
TEST_F(FrameReflections, TakeNoMoreThanTracedOcclusionLeaves) {
  const std::string path = write(floor_and_wall(0.3, false));
  for (const char* technique : {"clustered", "visibility"}) {
    Job job = seen(path);
    job.technique = technique;
    job.layers = {};
    job.effects = "reflections,occlusion";
    job.settings = {{"occlusion", "method", "traced"}, {"occlusion", "rays", "16"}};
    for (const glm::vec4& v : images_of(job)["beauty"].values<glm::vec4>())
      ASSERT_TRUE(v.x >= -1e-4f && v.y >= -1e-4f && v.z >= -1e-4f) << technique << " " << v.x;
  }
}

// At a contact edge (a third down row 43) the samples of a black wall have nothing that could be taken away.
TEST_F(FrameReflections, TakeNothingFromTheWallAtAContact) {
  const std::string path = write(floor_and_wall(0.3, false, false, {0, 0, 0}));
  for (const char* technique : {"clustered", "visibility"}) {
    Job job = seen(path, 4, -0.03);
    job.technique = technique;
    job.layers = {};
    float least = 0, most = 0;
    for (const glm::vec4& v : images_of(job)["beauty"].values<glm::vec4>())
      least = std::min(least, v.x), most = std::max(most, v.x);
    EXPECT_GT(least, -0.01f * most) << technique;
  }
}

// Terms sum to beauty with blended surfaces over them, and the same frame is the same bytes.
TEST_F(FrameReflections, TermsSumAndBytesStay) {
  const std::string path = write(floor_and_wall(0.3, false, true));
  for (const int samples : {1, 4}) {
    Job job = seen(path, samples);
    const Images few = images_of(job);
    job.layers.clear();
    for (const LayerName& term : Terms::layers) job.layers.emplace_back(term.name);
    const Images all = images_of(job), again = images_of(job);
    EXPECT_EQ(all, again);
    EXPECT_EQ(few["beauty"], all["beauty"]);
    EXPECT_EQ(few["reflections"], all["reflections"]);
    double most = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        glm::dvec3 sum(0);
        for (const std::string& name : job.layers) sum += glm::dvec3(all[name].at<glm::vec4>(x, y));
        most = std::max(most, glm::length(sum - glm::dvec3(all["beauty"].at<glm::vec4>(x, y))));
      }
    EXPECT_LT(most, 1e-5);
  }
  // Of many samples a pixel the mean is about the same.
  Job job = seen(path, 1);
  job.settings.insert(job.settings.end(), {{"reflections", "samples", "64"}, {"reflections", "steps", "0"}});
  const auto sum = [](const Images& images) {
    double total = 0;
    for (const glm::vec4& v : images["reflections"].values<glm::vec4>()) total += double(v.z);
    return total;
  };
  const double one = sum(images_of(job));
  job.settings.push_back({"supersample", "n", "2"});
  EXPECT_NEAR(sum(images_of(job)), one, 0.02 * one);
}

// Against the traced layer: a smooth and a rough floor. More rays and more steps come nearer to the pass's exact end,
// and that end is the traced one but for what the picture does not hold.
TEST_F(FrameReflections, TendToTheTracedLayer) {
  const std::string file = ::testing::TempDir() + "candela_reflections_look.json";
  std::ofstream(file) << R"({"reflections": {}})";
  for (const double roughness : {0.1, 0.5}) {
    Job job = seen(write(floor_and_wall(roughness, true)));
    job.effects = "auto";
    job.look = file;
    job.settings = {};
    job.quality = "exact";
    job.settings = {{"supersample", "n", "1"}, {"reflections", "method", "screen"}};
    const auto frame = open_reference(job, 0, {});
    ASSERT_TRUE(frame);
    reference::TraceSettings settings;
    reference::Film film(width, height, {.terms = true});
    film.add(reference::Integrator(*(*frame)->world, settings, width, height), 64, [](double) { return true; });
    const auto picture = [&](const std::vector<KnobSetting>& knobs) {
      Job with = job;
      with.settings.insert(with.settings.end(), knobs.begin(), knobs.end());
      return images_of(with)["reflections"].values<glm::vec4>();
    };
    const auto error = [&](const std::vector<glm::vec4>& a, auto&& truth) {
      double sum = 0;
      for (size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) sum += std::pow(a[i][c] - truth(i)[c], 2) / (std::pow(truth(i)[c], 2) + 0.01);
      return sum / (3 * double(a.size()));
    };
    const auto exact = picture({});
    const double model = error(exact, [&](size_t i) { return film.term(reference::Term::reflections, i); });
    const auto against_exact = [&](const std::vector<KnobSetting>& knobs) {
      return error(picture(knobs), [&](size_t i) { return glm::dvec3(exact[i]); });
    };
    std::vector<double> by_samples, by_steps;
    for (const char* n : {"1", "4", "16"}) by_samples.push_back(against_exact({{"reflections", "samples", n}}));
    for (const char* n : {"4", "16", "64"}) by_steps.push_back(against_exact({{"reflections", "steps", n}}));
    fmt::print("roughness {}: relMSE of the exact end {:.5f}; by samples {:.6f}; by steps {:.6f}\n", roughness, model,
               fmt::join(by_samples, " "), fmt::join(by_steps, " "));
    EXPECT_LT(model, 0.03);
    for (const auto& errors : {by_samples, by_steps})
      for (size_t i = 1; i < errors.size(); ++i) EXPECT_LE(errors[i], errors[i - 1] * 1.05 + 1e-7);
    EXPECT_LT(by_samples.back(), 0.01);
  }
}

// Rays through the scene against the traced layer: what is reflected lies outside of the picture for the most, under a
// lamp with a shadow and an even sky with occlusion. More rays come nearer to it.
TEST_F(FrameReflections, RaysTendToTheTracedLayer) {
  for (const double roughness : {0.05, 0.5}) {
    GltfBuilder b = floor_and_wall(roughness, false);
    const int grey = add_material(b, diffuse_material(0.7, 0.4, 0.2));
    // Above the picture's edge, and what casts a shadow on it.
    add_node(b, {{"mesh", add_square_mesh(b, 1, grey)}, {"translation", {0, 3, -1.9}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.3f, grey)}, {"translation", {0.5, 2.6, -0.8}}});
    add_light(b, {{"type", "point"}, {"intensity", 30}}, {{"translation", {1, 2, 0.5}}});
    Job job = seen(write(b), 1, 1.2);
    job.width_px = 48, job.height_px = 32;
    job.technique = "ray";
    job.effects = "auto";
    job.look = look_file(R"({"reflections": {}, "occlusion": {"radius_m": 2}})");
    job.sky = even_sky();
    job.quality = "exact";
    job.settings = {{"supersample", "n", "1"}, {"reflections", "samples", "64"}, {"ibl", "method", "split"}};
    job.settings.insert(job.settings.end(), {{"occlusion", "rays", "64"}, {"occlusion", "bent", "0"}});
    ASSERT_FALSE(job.sky.empty());
    const auto frame = open_reference(job, 0, {});
    ASSERT_TRUE(frame);
    reference::TraceSettings settings;
    reference::Film film(job.width_px, job.height_px, {.terms = true});
    film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), 256,
             [](double) { return true; });
    const auto error = [&](const std::vector<KnobSetting>& knobs) {
      Job with = job;
      with.settings.insert(with.settings.end(), knobs.begin(), knobs.end());
      const auto picture = images_of(with)["reflections"].values<glm::vec4>();
      double sum = 0;
      for (size_t i = 0; i < picture.size(); ++i) {
        const glm::dvec3 truth = film.term(reference::Term::reflections, i);
        for (int c = 0; c < 3; ++c) sum += std::pow(picture[i][c] - truth[c], 2) / (std::pow(truth[c], 2) + 0.01);
      }
      return sum / (3 * double(picture.size()));
    };
    const double screen = error({{"reflections", "method", "screen"}, {"reflections", "fade", "0"}});
    std::vector<double> by_samples;
    for (const char* n : {"1", "4", "16", "64"}) by_samples.push_back(error({{"reflections", "samples", n}}));
    fmt::print("roughness {}: relMSE through the picture {:.5f}, by rays {:.6f}\n", roughness, screen,
               fmt::join(by_samples, " "));
    for (size_t i = 1; i < by_samples.size(); ++i) EXPECT_LE(by_samples[i], by_samples[i - 1] * 1.05 + 1e-6);
    EXPECT_LT(by_samples.back(), 0.01);
    EXPECT_GT(screen, 4 * by_samples.back());
  }
}

// A dull floor before a polished board that shows a lamp: few of the floor's rays meet that small highlight. Each
// brings its mean over what it stands for, so that few rays leave no sparks and lose no light.
TEST_F(FrameReflections, HighlightsThatRaysMeetLeaveNoSparks) {
  GltfBuilder b = floor_and_wall(0.4, true);
  Json polished = {{"pbrMetallicRoughness", base_color(0.9, 0.9, 0.9)}};
  polished["pbrMetallicRoughness"]["metallicFactor"] = 1;
  polished["pbrMetallicRoughness"]["roughnessFactor"] = 0.1;
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, polished))}, {"translation", {0, 2, -1.5}}});
  add_light(b, {{"type", "point"}, {"intensity", 30}}, {{"translation", {0, 1.5, 1}}});
  Job job = seen(write(b));
  job.technique = "ray";
  job.width_px = 48, job.height_px = 32;
  const auto picture = [&](const char* samples) {
    job.settings = {
        {"reflections", "samples", samples}, {"reflections", "smooth", "0"}, {"reflections", "roughest", "1"}};
    const auto values = images_of(job)["reflections"].values<glm::vec4>();
    double sum = 0, most = 0;
    for (const glm::vec4& v : values) sum += double(v.x), most = std::max(most, double(v.x));
    return std::pair(sum / double(values.size()), most);
  };
  const auto [few_mean, few_most] = picture("4");
  const auto [mean, most] = picture("1024");
  fmt::print("4 rays: mean {:.4f}, most {:.3f}; 1024 rays: {:.4f}, {:.3f}\n", few_mean, few_most, mean, most);
  EXPECT_NEAR(few_mean, mean, 0.12 * mean);
  EXPECT_LT(few_most, 2 * most);
}

}  // namespace candela::test::frame_reflections
