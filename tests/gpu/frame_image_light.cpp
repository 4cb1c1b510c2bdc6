// Image-based light against sums over the texels of the sky with the reference's BRDF, in double precision.
#include "frame_sky_fixture.h"
#include "scene/studio.h"

namespace candela::test {
namespace {

class ImageLight : public SkyTest {
 protected:
  static Job squares(double metallic, const std::string& sky, glm::dvec3 color = {0.9, 0.6, 0.3}) {
    return SkyTest::squares(sky, [&](int x) {
      Json pbr = base_color(color.x, color.y, color.z);
      pbr["roughnessFactor"] = roughness[size_t(x)], pbr["metallicFactor"] = metallic;
      return Json{{"pbrMetallicRoughness", pbr}};
    });
  }
  static glm::dvec3 truth(int x, int y, double metallic, const Texels& sky) {
    reference::Surface s;
    s.normal = turned(y) * glm::dvec3(0, 0, 1);
    s.base_color = {0.9, 0.6, 0.3};
    s.roughness = roughness[size_t(x)], s.metallic = metallic;
    s.specular_gain =
        reference::specular_gain(glm::mix(s.dielectric_f0, s.base_color, metallic), s.roughness, s.normal.z);
    return sum_over(sky, s);
  }
  static double relmse(const Images& images, double metallic, const Texels& sky) {
    return relmse_of(images, [&](int x, int y) { return truth(x, y, metallic, sky); });
  }
  static double error(Job job, double metallic, const Texels& sky, std::vector<KnobSetting> settings) {
    job.settings = std::move(settings);
    return relmse(images_of(job), metallic, sky);
  }
};

// A ball of metal scatters light from far evenly to all sides: over a quarter of its radius squared it sends a spot's
// illuminance to the camera, however much smaller than a pixel the spot's image on it is. With the spot in the image
// and with it as a light, the more lookups the nearer; one direction of the filtered sky is off by its half.
TEST_F(ImageLight, ABallMirrorsAllOfASmallSpot) {
  const glm::dvec3 spot = glm::normalize(glm::dvec3(0.4, 0.5, 0.7));
  const Texels sky =
      write_sky("spot", [=](glm::dvec3 d) { return glm::dvec3(glm::dot(d, spot) > 0.9998 ? 1e4 : 0.0); });
  double illuminance = 0;
  for (const auto& [d, light] : sky.light) illuminance += light.x;
  ASSERT_GT(illuminance, 0);
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json metal = base_color(1, 1, 1);
  metal["metallicFactor"] = 1, metal["roughnessFactor"] = 0;
  const int material = add_material(b, {{"pbrMetallicRoughness", metal}});
  constexpr int rings = 24;
  std::vector<float> places;
  std::vector<uint32_t> corners;
  for (uint32_t j = 0; j <= rings; ++j)
    for (uint32_t i = 0; i <= 2 * rings; ++i) {
      const double t = std::numbers::pi * j / rings, p = std::numbers::pi * i / rings;
      for (const double x : {std::sin(t) * std::cos(p), std::cos(t), std::sin(t) * std::sin(p)})
        places.push_back(float(x));
      const uint32_t a = j * (2 * rings + 1) + i, below = a + 2 * rings + 1;
      if (j < rings && i < 2 * rings)
        for (const uint32_t k : {a, a + 1, below, a + 1, below + 1, below}) corners.push_back(k);
    }
  b.json["meshes"].push_back(
      {{"primitives",
        {{{"attributes",
           {{"POSITION", b.accessor<float>("VEC3", places)}, {"NORMAL", b.accessor<float>("VEC3", places)}}},
          {"indices", b.accessor<uint32_t>("SCALAR", corners)},
          {"material", material}}}}});
  add_node(b, {{"mesh", 0}});
  constexpr double half = 1.1;
  constexpr int side = 64;
  b.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", half}, {"ymag", half}, {"znear", 1}, {"zfar", 9}}}}};
  add_node(b, {{"camera", 0}, {"translation", {0, 0, 5}}});
  Job job = job_for(write(b), side, side);
  job.sky = sky.file;
  job.effects = "ibl";
  const std::string kept = ::testing::TempDir() + "candela_spot_kept.look.json";
  std::ofstream(kept) << R"({"sky": {"extract_sun": false}})";
  const auto mirrored = [&](const Job& of) {
    double sum = 0;
    for (const glm::vec4& p : images_of(of)["beauty"].values<glm::vec4>()) sum += double(p.x);
    return sum * (2 * half / side) * (2 * half / side) / (illuminance / 4);
  };
  for (const char* technique : {"clustered", "visibility"})
    for (const bool taken : {false, true}) {
      Job of = job;
      of.technique = technique;
      if (!taken) of.look = kept;
      of.settings = {{"ibl", "mirror_taps", "64"}};
      const double all = mirrored(of);
      // A G-buffer keeps what a pixel shows of the sky.
      if (of.technique == "clustered") {
        const Image drawn = images_of(of)["beauty"];
        for (const char* deferred : {"deferred-clustered", "deferred-volumes"}) {
          of.technique = deferred;
          EXPECT_EQ(images_of(of)["beauty"], drawn) << deferred << " " << taken;
        }
      }
      std::printf("%s, spot %s: %.4f\n", technique, taken ? "taken out" : "in the image", all);
      EXPECT_NEAR(all, 1, 0.08) << technique << " " << taken;
    }
}

// Beside a high wall the sky is open over a quarter of the sphere, whose mean direction by the cosine leans from the
// normal by atan(2 / pi). Under a sky of radiance 1 + a x the light tells how far it leans.
TEST_F(ImageLight, BentNormalsLeanWhereTheSkyIsOpen) {
  constexpr double a = 0.9;
  const std::string brighter = write_sky("brighter", [](glm::dvec3 d) { return glm::dvec3(1 + a * d.x); }).file;
  const std::string darker = write_sky("darker", [](glm::dvec3 d) { return glm::dvec3(1 - a * d.x); }).file;
  const auto leaning = [&](bool wall, const std::vector<KnobSetting>& settings) {
    GltfBuilder b = empty_scene();
    const int grey = add_material(b, diffuse_material(0.5, 0.5, 0.5));
    add_node(b, {{"mesh", add_square_mesh(b, 4, grey)}});
    if (wall) add_node(b, {{"mesh", add_square_mesh(b, 90, grey)}, {"rotation", {0, 0.70710678, 0, 0.70710678}}});
    Job job = job_for(write(b), 64, 36);
    job.look = look_file(R"({"occlusion": {"radius_m": 100, "falloff": 0, "strength": 1}})");
    look(job, {3, 0, 3}, {0, 0, 0}, 20);
    job.layers = {"ambient_diffuse", "ambient_specular"};
    job.settings = settings;
    double light[2];
    for (int i = 0; i < 2; ++i) {
      job.sky = i == 0 ? brighter : darker;
      const Images images = images_of(job);
      light[i] = double(images["ambient_diffuse"].at<glm::vec4>(33, 18).x);
      for (const Image& image : images)
        for (const float v : image.values<float>()) EXPECT_TRUE(std::isfinite(v) && v >= 0) << image.layer;
    }
    return (light[0] - light[1]) / (light[0] + light[1]) / (2 * a / 3);
  };
  const std::vector<KnobSetting> screen = {{"occlusion", "method", "screen"},
                                           {"occlusion", "texel_px", "1"},
                                           {"occlusion", "slices", "64"},
                                           {"occlusion", "samples", "64"}};
  const std::vector<KnobSetting> traced = {{"occlusion", "method", "traced"}, {"occlusion", "rays", "256"}};
  const double open = 2 / std::hypot(2, std::numbers::pi);  // sine of that angle
  for (const auto& [settings, off] : {std::pair(screen, 0.03), {traced, 0.01}})
    for (const char* ibl : {"lobe", "sampled"}) {
      std::vector<KnobSetting> plain = settings, bent = settings;
      plain.push_back({"ibl", "method", ibl}), bent.push_back({"ibl", "method", ibl});
      bent.push_back({"occlusion", "bent", "1"});
      const double leans = leaning(true, bent);
      fmt::print("{} leaning {:.4f}, of {:.4f}\n", ibl, leans, open);
      EXPECT_NEAR(leans, open, off) << ibl;
      // Rays know where the sky is bright: they tend to the light itself, which leans by 2 / pi.
      const bool by_rays = settings[0].value == "traced";
      EXPECT_NEAR(leaning(true, plain), by_rays ? 2 / std::numbers::pi : 0, by_rays ? 0.04 : 0.01) << ibl;
    }
  std::vector<KnobSetting> bent = screen;
  bent.push_back({"occlusion", "bent", "1"});
  EXPECT_NEAR(leaning(false, bent), 0, 0.01);
}

}  // namespace

// Sampled, the error falls with the number of samples; filtered, it is within the goal of 0.01, and split sums are not.
TEST_F(ImageLight, ComesNearTheSumOverTheSky) {
  const Texels sky = sunny();
  for (const double metallic : {0.0, 1.0}) {
    const Job job = squares(metallic, sky.file);
    const double lobe = error(job, metallic, sky, {{"ibl", "method", "lobe"}});
    EXPECT_LT(lobe, 0.005) << metallic;
    // Of a dielectric's little error half is of its diffuse light, which is alike.
    const double worse = metallic > 0 ? 2 : 1.1;
    EXPECT_GT(error(job, metallic, sky, {{"ibl", "method", "split"}}), worse * lobe) << metallic;
    EXPECT_GT(error(job, metallic, sky, {{"ibl", "method", "lobe"}, {"ibl", "lights", "0"}}), worse * lobe) << metallic;
    double before = 1;
    for (const char* samples : {"64", "512", "4096"}) {
      const double now = error(job, metallic, sky, {{"ibl", "method", "sampled"}, {"ibl", "pixel_samples", samples}});
      EXPECT_LT(now, before) << metallic << " " << samples;
      before = now;
    }
    EXPECT_LT(before, 1e-3) << metallic;
  }
}

TEST_F(ImageLight, ComesNearTheStudioInClosedForm) {
  Texels sky;
  constexpr int width = 256, height = 128;  // as fine as the softest edges ask
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double solid_angle =
          2 * std::numbers::pi / width *
          (std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height));
      const glm::dvec3 d = equirect_direction((x + 0.5) / width, (y + 0.5) / height);
      sky.light.emplace_back(d, studio_radiance(d) * solid_angle);
    }
  for (const double metallic : {0.0, 1.0}) {
    Job job = squares(metallic, "");
    job.sky = studio_sky;
    double before = 1;
    for (const char* samples : {"64", "512", "4096"}) {
      const double now = error(job, metallic, sky, {{"ibl", "method", "sampled"}, {"ibl", "pixel_samples", samples}});
      EXPECT_LT(now, before) << metallic << " " << samples;
      before = now;
    }
    EXPECT_LT(before, 1e-4) << metallic;
    // Lobes of a metal seen from aside are not round: 0.0203 between bright boxes.
    EXPECT_LT(error(job, metallic, sky, {{"ibl", "method", "lobe"}}), metallic > 0 ? 0.022 : 0.0005) << metallic;
    job.sky = neutral_sky;
    EXPECT_GT(error(job, metallic, sky, {}), 0.02) << metallic;
  }
}

// A uniform sky comes back as the integral of the BRDF by every method, within half a percent: all of it from a metal
// whose colour is 1.
TEST_F(ImageLight, PassesTheFurnace) {
  const Texels white = write_sky("white", [](glm::dvec3) { return glm::dvec3(1); });
  for (const double metallic : {0.0, 1.0})
    for (const char* method : {"split", "lobe", "sampled"}) {
      Job job = squares(metallic, white.file);
      job.settings = {{"ibl", "method", method}};
      const Images images = images_of(job);
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
          const glm::dvec3 exact = truth(x, y, metallic, white);
          const glm::vec4 p = images["beauty"].at<glm::vec4>(x * cell + cell / 2, y * cell + cell / 2);
          for (int k = 0; k < 3; ++k) EXPECT_NEAR(p[k], exact[k], 0.005) << method << " " << x << " " << y;
        }
    }
  for (const char* method : {"split", "lobe", "sampled"}) {
    Job job = squares(1, white.file, {1, 1, 1});
    job.settings = {{"ibl", "method", method}};
    const Images images = images_of(job);
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        EXPECT_NEAR(images["beauty"].at<glm::vec4>(x * cell + cell / 2, y * cell + cell / 2)[1], 1, 0.01)
            << method << " " << x << " " << y;
  }
}

// Seen at a slant, what a dielectric reflects is the light of its grazing half vectors, whose lobe leans further from
// the normal than the whole: bright sky above a floor must not wash it out.
TEST_F(ImageLight, DielectricsAtASlantReflectWhatLiesLow) {
  const glm::dquat tilt = glm::angleAxis(-1.3, glm::dvec3(1, 0, 0));
  const glm::dvec3 normal = tilt * glm::dvec3(0, 0, 1);
  const Texels sky = write_sky("above", [&](glm::dvec3 d) { return glm::dvec3(glm::dot(d, normal) > 0.8 ? 6 : 0.2); });
  double worst = 0;
  for (const double rough : {0.3, 0.45, 0.6, 0.8}) {
    GltfBuilder b = empty_scene();
    Json pbr = base_color(0, 0, 0);
    pbr["roughnessFactor"] = rough, pbr["metallicFactor"] = 0;
    add_node(b, {{"mesh", add_square_mesh(b, 9, add_material(b, {{"pbrMetallicRoughness", pbr}}))},
                 {"rotation", {tilt.x, tilt.y, tilt.z, tilt.w}}});
    b.json["cameras"] = {
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 0.5}, {"ymag", 0.5}, {"znear", 1}, {"zfar", 99}}}}};
    add_node(b, {{"camera", 0}, {"translation", {0, 0, 40}}});
    Job job = job_for(write(b), 4, 4);
    job.sky = sky.file, job.effects = "ibl";
    reference::Surface s;
    s.normal = normal, s.base_color = {0, 0, 0};
    s.roughness = rough, s.metallic = 0;
    s.specular_gain = reference::specular_gain(s.dielectric_f0, rough, normal.z);
    const double truth = sum_over(sky, s).x, drawn = double(images_of(job)["beauty"].at<glm::vec4>(2, 2).x);
    std::printf("roughness %.2f: %.4f of %.4f\n", rough, drawn, truth);
    worst = std::max(worst, std::abs(drawn / truth - 1));
  }
  EXPECT_LT(worst, 0.2);
}

// Light from one side of a black sky, where spherical harmonics go below 0.
TEST_F(ImageLight, IsNowhereNegativeAndFinite) {
  const Texels spot = write_sky("spot", [](glm::dvec3 d) { return glm::dvec3(d.x > 0.98 ? 1e8 : 0.0); });
  for (const char* method : {"split", "lobe", "sampled"}) {
    Job job = squares(0.5, spot.file);
    job.settings = {{"ibl", "method", method}};
    for (const glm::vec4& p : images_of(job)["beauty"].values<glm::vec4>())
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(p[k], 0.0f) << method;
        EXPECT_TRUE(std::isfinite(p[k])) << method;
      }
  }
}

// A look that turns the sky a quarter and doubles it gives the picture of the turned and doubled image, sky and lobes.
TEST_F(ImageLight, FollowsTheLooksSky) {
  const auto radiance = [](glm::dvec3 d) { return glm::dvec3(1 + d.x, d.z > 0.9 ? 40 : 0.5, 1 + 0.5 * d.z * d.y); };
  const Texels plain = write_sky("plain", radiance);
  const Texels turned = write_sky("turned", [&](glm::dvec3 d) { return 2.0 * radiance(glm::dvec3(-d.z, d.y, d.x)); });
  const std::string look = ::testing::TempDir() + "candela_image_light_look.json";
  std::ofstream(look) << R"({"sky": {"rotation_deg": 90, "intensity": 2}})";
  for (const char* method : {"split", "lobe", "sampled", "none"}) {
    Job job = squares(0.5, turned.file);
    if (std::string(method) == "none")
      job.effects = "none";
    else
      job.settings = {{"ibl", "method", method},
                      {"ibl", "filter_samples", "1024"},  // samples do not turn with the sky
                      {"ibl", "pixel_samples", "4096"}};
    const Images wanted = images_of(job);
    job.sky = plain.file, job.look = look;
    const Images images = images_of(job);
    const auto a = wanted["beauty"].values<glm::vec4>(), b = images["beauty"].values<glm::vec4>();
    for (size_t i = 0; i < a.size(); ++i)
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(b[i][k], a[i][k], 0.01 * a[i][k] + 0.01) << method << " " << i;
  }
}

// A frame without the effect has nothing of it.
TEST_F(ImageLight, IsLeftOutWhole) {
  const Texels sky = sunny();
  Job job = squares(1, sky.file);
  const auto plan_of = [&] {
    const auto session = open(job);
    return session ? plan_text(*render(*session).plan) : std::string();
  };
  EXPECT_NE(plan_of().find("IBL_METHOD"), std::string::npos);
  job.effects = "none";
  EXPECT_EQ(plan_of().find("IBL_METHOD"), std::string::npos);
  EXPECT_EQ(plan_of().find("ibl."), std::string::npos);
  job.effects = "auto";
  EXPECT_NE(plan_of().find("IBL_METHOD"), std::string::npos);
  job.sky.clear();
  EXPECT_EQ(plan_of().find("IBL_METHOD"), std::string::npos);
}

}  // namespace candela::test
