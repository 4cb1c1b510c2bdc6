// Layers of the light of named groups of lights: their sum is the light of all, in every technique and in the
// reference.
#include "frame_fixture.h"
#include "render/outputs.h"
#include "render/reference_frame.h"
#include "render/traced_frames.h"
#include "techniques/technique.h"

namespace candela::test::frame_light_groups {
namespace {

constexpr int width = 48, height = 36;

// Lights of each kind, of several nodes, over opaque, masked and blended surfaces.
std::string lit_scene(std::string (*write)(const GltfBuilder&)) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 1.5f, add_material(b, diffuse_material(0.6, 0.5, 0.4)))}});
  Json blended = diffuse_material(0.2, 0.9, 0.2);
  blended["alphaMode"] = "BLEND", blended["doubleSided"] = true;
  blended["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
  add_node(b, {{"mesh", add_square_mesh(b, 0.6f, add_material(b, blended))}, {"translation", {0.5, 0.2, 0.9}}});
  const auto light = [&](const char* name, const Json& light, const Json& place) {
    Json node = place;
    node["name"] = name;
    add_light(b, light, node);
  };
  light("Key lamp", {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {1.2, 0.5, 2}}});
  light("Fill lamp", {{"type", "point"}, {"intensity", 3.0}, {"range", 2.5}}, {{"translation", {-1.2, -0.5, 1}}});
  light("Spot", {{"type", "spot"}, {"intensity", 30.0}, {"spot", {{"outerConeAngle", 0.6}}}},
        {{"translation", {-1, 0.2, 2}}});
  light("Sun", {{"type", "directional"}, {"intensity", 2.0}, {"color", {1, 0.8, 0.6}}}, {{"translation", {0, 0, 3}}});
  return write(b);
}

Job job_of(const std::string& file) {
  Job job;
  job.scene = file;
  job.width_px = width, job.height_px = height, job.samples = 4;
  job.tonemap = "none";
  job.camera.eye = glm::dvec3(0.4, -3, 4), job.camera.target = glm::dvec3(0), job.camera.yfov_deg = 45;
  job.light_groups = {{"lamps", {"* lamp"}}, {"sky", {"Sun"}}};
  return job;
}

const std::vector<std::string> directs = {"direct_sun", "direct_point", "direct_spot"};
const std::vector<std::string> groups = {"light_lamps", "light_sky", "light_rest"};

}  // namespace

class FrameLightGroups : public FrameTest {
 protected:
  static std::string scene_file() { return lit_scene(write); }
  // parts: roundings of a pixel, as FrameTerms counts them.
  static void expect_sum(const Images& images, const std::vector<std::string>& some, int parts, size_t least_lit) {
    size_t lit = 0;
    const auto sums = [&](const std::vector<std::string>& layers) {
      std::vector<glm::dvec3> sum(images[layers.front()].pixels());
      for (const std::string& layer : layers) {
        const std::vector<glm::vec4> values = images[layer].values<glm::vec4>();
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += glm::dvec3(values[i]);
      }
      return sum;
    };
    const std::vector<glm::dvec3> a = sums(some), b = sums(directs);
    for (size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        lit += b[i][c] > 0;
        ASSERT_LE(std::abs(a[i][c] - b[i][c]), 2 * parts * 0x1p-24 * b[i][c]) << "pixel " << i;
      }
    EXPECT_GE(lit, 3 * least_lit);
  }
};

TEST_F(FrameLightGroups, SumToTheLightOfAllAndChangeNoBitOfBeauty) {
  const std::string file = scene_file();
  for (const Technique& technique : techniques()) {
    SCOPED_TRACE(technique.name);
    Job job = job_of(file);
    job.technique = technique.name;
    job.light_groups.clear();
    const Images alone = images_of(job);
    job.light_groups = job_of(file).light_groups;
    job.layers = directs;
    const Images divided = images_of(job);
    EXPECT_TRUE(alone["beauty"] == divided["beauty"]);
    expect_sum(divided, groups, 24, size_t(width * height) / 3);
    // What a group is of: one sun alone, both lamps alone.
    EXPECT_TRUE(divided["light_sky"] == Image({"light_sky", divided["direct_sun"].bytes, width, height}));
    EXPECT_TRUE(divided["light_lamps"] == Image({"light_lamps", divided["direct_point"].bytes, width, height}));
    EXPECT_TRUE(divided["light_rest"] == Image({"light_rest", divided["direct_spot"].bytes, width, height}));
  }
}

TEST_F(FrameLightGroups, SumOverBlendedAndSupersampledSurfacesAndThroughFog) {
  const std::string file = scene_file();
  for (const char* transparency : {"sorted", "layers"}) {
    SCOPED_TRACE(transparency);
    Job job = job_of(file);
    job.transparency = transparency;
    job.layers = directs;
    expect_sum(images_of(job), groups, 24, size_t(width * height) / 3);
    job.samples = 0, job.settings = {{"supersample", "n", "2"}};
    expect_sum(images_of(job), groups, 32, size_t(width * height) / 3);
    job.look = look_file(R"({"fog": {"extinction": 0.1}})");
    expect_sum(images_of(job), groups, 32, size_t(width * height) / 3);
  }
}

// More than one pass draws to.
TEST_F(FrameLightGroups, AreAsManyAsSixteen) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 1.5f, add_material(b, diffuse_material(0.6, 0.5, 0.4)))}});
  for (int i = 0; i < 18; ++i)
    add_light(b, {{"type", "point"}, {"intensity", 1.0 + i}},
              {{"name", fmt::format("lamp {}", i)}, {"translation", {0.15 * i - 1.3, 0.1 * (i % 3), 0.5 + 0.1 * i}}});
  Job job = job_of(write(b));
  job.light_groups.clear();
  std::vector<std::string> layers;
  for (int i = 0; i < 15; ++i) {
    job.light_groups.push_back({fmt::format("g{}", i), {fmt::format("lamp {}", i)}});
    layers.push_back(job.light_groups.back().layer());
  }
  layers.push_back("light_rest");
  job.layers = directs;
  const Images images = images_of(job);
  expect_sum(images, layers, 40, size_t(width * height) / 3);
  for (const std::string& layer : layers) {
    double light = 0;
    for (const glm::vec4& v : images[layer].values<glm::vec4>()) light += double(v.y);
    EXPECT_GT(light, 0) << layer;
  }
}

// Each as it looks where every group is drawn, and alone, with neither the other groups' images nor beauty's passes.
TEST_F(FrameLightGroups, ArePicturesByView) {
  Job job = job_of(scene_file());
  job.dither = false;
  const auto picture = [&](bool linear) {
    const auto session = open(job, {.linear = linear, .display = true, .display_bits = 8});
    const FrameResult frame = render(*session);
    if (!linear) {
      EXPECT_EQ(frame.outputs.size(), 1u);
      for (const PlanResource& resource : frame.plan->resources)
        for (size_t g = 0; g < groups.size(); ++g)
          EXPECT_TRUE(groups[g] == job.view || resource.first_pass < 0 ||
                      resource.name().find(fmt::format("group{}", g)) == std::string::npos)
              << resource.name();
    }
    return display_image(frame, job).pixels;
  };
  // sRGB by IEC 61966-2-1.
  const auto code = [](float linear) {
    const double v = std::clamp(double(linear), 0.0, 1.0);
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
  };
  for (const char* transparency : {"sorted", "layers"})
    for (const std::string& group : groups) {
      SCOPED_TRACE(group + " " + transparency);
      job.transparency = transparency, job.view = "beauty";
      const std::vector<glm::vec4> linear = images_of(job)[group].values<glm::vec4>();
      job.view = group;
      const std::vector<std::byte> alone = picture(false);
      EXPECT_TRUE(alone == picture(true));
      ASSERT_EQ(alone.size(), 3 * linear.size());
      size_t lit = 0;
      for (size_t i = 0; i < linear.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          const double seen = double(alone[3 * i + size_t(c)]);
          lit += seen > 8;
          ASSERT_NEAR(seen, code(linear[i][c]), 1.01) << i;
        }
      EXPECT_GT(lit, size_t(width * height) / 3);
    }
  job.view = "light_lamps", job.samples = 0, job.settings = {{"supersample", "n", "2"}};
  EXPECT_TRUE(picture(false) == picture(true));
  job.shutter_s = 1.0 / 48, job.settings = {{"subframes", "n", "2"}};
  EXPECT_TRUE(picture(false) == picture(true));
}

TEST_F(FrameLightGroups, RefusesNodesThatGiveNoLight) {
  Job job = job_of(scene_file());
  const auto refusal = [&](std::vector<LightGroupRequest> wrong) {
    job.light_groups = std::move(wrong);
    const auto session = Session::open(job, {}, RunSettings{});
    if (!session) return session.error().message;
    const auto frame = (*session)->render(0);
    return frame ? std::string("rendered") : frame.error().message;
  };
  EXPECT_NE(refusal({{"a", {"Key"}}}).find("nodes with lights are: Key lamp, Fill lamp, Spot, Sun"), std::string::npos);
  EXPECT_NE(refusal({{"a", {"Sun"}}, {"b", {"S*"}}}).find("two groups, a and b"), std::string::npos);
  EXPECT_NE(refusal({{"a.b", {"Sun"}}}).find("cannot be part of a layer's name"), std::string::npos);
  EXPECT_NE(refusal({{"rest", {"Sun"}}}).find("the group of all other lights"), std::string::npos);
  EXPECT_NE(refusal({{"a", {"Sun"}}, {"a", {"Spot"}}}).find("twice"), std::string::npos);
  job.transparency = "moments";
  EXPECT_NE(refusal({{"a", {"Sun"}}}).find("--transparency layers or sorted"), std::string::npos);
}

TEST_F(FrameLightGroups, TheReferenceHasTheSame) {
  const Job job = job_of(scene_file());
  const Images drawn = images_of(job);
  for (const reference::Mode mode : {reference::Mode::direct, reference::Mode::path}) {
    const auto frame = open_reference(job, 0, {}, mode);
    ASSERT_TRUE(frame) << frame.error().text();
    TraceRequest request;
    request.settings.mode = mode;
    request.settings.sampler.spp = 16;
    reference::Film film = begin_film(job, **frame, request, {}).film;
    const reference::Integrator integrator(*(*frame)->world, request.settings, width, height);
    ASSERT_TRUE(film.add(integrator, 16, [](double) { return true; }));
    for (uint32_t g = 0; g < groups.size(); ++g) {
      double traced = 0, of_frame = 0;
      for (const glm::vec4& v : drawn[groups[g]].values<glm::vec4>()) of_frame += double(v.y);
      for (size_t i = 0; i < film.pixels(); ++i) traced += film.light_of_group(g, i).y;
      EXPECT_GT(of_frame, 0);
      EXPECT_NEAR(traced / of_frame, 1, 0.05) << groups[g];
    }
    for (size_t i = 0; i < film.pixels(); ++i) {
      glm::dvec3 sum(0), direct(0);
      for (uint32_t g = 0; g < groups.size(); ++g) sum += film.light_of_group(g, i);
      for (const reference::Term t :
           {reference::Term::direct_sun, reference::Term::direct_point, reference::Term::direct_spot})
        direct += film.term(t, i);
      ASSERT_LE(glm::length(sum - direct), 1e-12 * (glm::length(direct) + 1e-30));
    }
  }
}

}  // namespace candela::test::frame_light_groups
