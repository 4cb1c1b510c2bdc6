// The sky's light on lobes of Khronos materials, against sums over its texels with the reference's lobes.
#include "frame_sky_fixture.h"
#include "reference/lobes.h"

namespace candela::test {
namespace {

// A lobe in the file's terms and in the reference's, over the columns' roughness where it has one of its own.
struct LobeOfSky {
  const char* name;
  double metallic, roughness;  // of the base; roughness 0: the column's
  std::function<Json(double)> extension;
  std::function<void(reference::Lobes&, double, glm::dquat)> set;
};

const std::vector<LobeOfSky>& lobes() {
  static const std::vector<LobeOfSky> all = {
      {"clearcoat", 0.5, 0.6,
       [](double r) {
         return Json{{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", r}};
       },
       [](reference::Lobes& l, double r, glm::dquat q) {
         l.clearcoat = 1, l.clearcoat_roughness = r, l.clearcoat_normal = q * glm::dvec3(0, 0, 1);
       }},
      {"sheen", 0, 0.8,
       [](double r) {
         return Json{{"sheenColorFactor", {0.9, 0.6, 0.3}}, {"sheenRoughnessFactor", r}};
       },
       [](reference::Lobes& l, double r, glm::dquat) {
         l.sheen_color = {0.9, 0.6, 0.3}, l.sheen_roughness = r;
       }},
      {"iridescence", 1, 0,
       [](double) {
         return Json{{"iridescenceFactor", 1}, {"iridescenceIor", 1.33}, {"iridescenceThicknessMaximum", 420}};
       },
       [](reference::Lobes& l, double, glm::dquat) { l.iridescence = 1, l.film_ior = 1.33, l.film_nm = 420; }},
      {"anisotropy", 1, 0,
       [](double) {
         return Json{{"anisotropyStrength", 0.7}};
       },
       [](reference::Lobes& l, double, glm::dquat q) { l.anisotropy = 0.7, l.along = q * glm::dvec3(0.8, 0.6, 0); }},
      {"diffuse_transmission", 0, 0,
       [](double) {
         return Json{{"diffuseTransmissionFactor", 0.7}, {"diffuseTransmissionColorFactor", {0.2, 0.9, 0.6}}};
       },
       [](reference::Lobes& l, double, glm::dquat) {
         l.diffuse_transmission = 0.7, l.transmitted_color = {0.2, 0.9, 0.6};
       }},
  };
  return all;
}

class LobesOfSky : public SkyTest {
 protected:
  static Job job_of(const LobeOfSky& lobe, const std::string& sky) {
    return squares(sky, [&](int x) {
      Json pbr = base_color(0.6, 0.4, 0.3);
      pbr["metallicFactor"] = lobe.metallic;
      pbr["roughnessFactor"] = lobe.roughness > 0 ? lobe.roughness : roughness[size_t(x)];
      Json m = {{"pbrMetallicRoughness", pbr}};
      m["extensions"][std::string("KHR_materials_") + lobe.name] = lobe.extension(roughness[size_t(x)]);
      return m;
    });
  }
  static glm::dvec3 truth(const LobeOfSky& lobe, int x, int y, const Texels& sky) {
    reference::Surface s;
    const glm::dquat q = turned(y);
    s.normal = q * glm::dvec3(0, 0, 1);
    s.base_color = {0.6, 0.4, 0.3};
    s.roughness = lobe.roughness > 0 ? lobe.roughness : roughness[size_t(x)];
    s.metallic = lobe.metallic;
    s.lobes.emplace();
    lobe.set(*s.lobes, roughness[size_t(x)], q);
    const glm::dvec3 f0 = glm::mix(s.dielectric_f0, s.base_color, s.metallic);
    s.specular_gain = reference::is_stretched(s) ? reference::specular_gain(f0, reference::facets_of(s), {0, 0, 1})
                                                 : reference::specular_gain(f0, s.roughness, s.normal.z);
    return sum_over(sky, s);
  }
  static double error(const LobeOfSky& lobe, const Texels& sky, std::vector<KnobSetting> settings) {
    Job job = job_of(lobe, sky.file);
    job.settings = std::move(settings);
    const Images images = images_of(job);
    return relmse_of(images, [&](int x, int y) { return truth(lobe, x, y, sky); });
  }
};

class LobesInFrames : public SkyTest {};

}  // namespace

// Sampled, the error falls with the number of samples; filtered, it is within the goal of 0.01.
TEST_F(LobesOfSky, ComeNearTheSumOverTheSky) {
  const Texels sky = sunny();
  for (const LobeOfSky& lobe : lobes()) {
    const double filtered = error(lobe, sky, {{"ibl", "method", "lobe"}});
    EXPECT_LT(filtered, 0.006) << lobe.name;
    EXPECT_LT(error(lobe, sky, {{"ibl", "method", "sampled"}, {"ibl", "pixel_samples", "256"}}), 1e-4) << lobe.name;
    fmt::print("{}: split {:.5f}, lobe {:.5f}\n", lobe.name, error(lobe, sky, {{"ibl", "method", "split"}}), filtered);
  }
}

// With more directions a pixel stretched metal comes nearer to the sum over the sky, and its exact end is there.
TEST_F(LobesOfSky, StretchedMetalTendsToTheSum) {
  const Texels sky = sunny();
  const LobeOfSky& lobe = *std::ranges::find(lobes(), std::string_view("anisotropy"), &LobeOfSky::name);
  double before = 1;
  for (const auto& [directions, most] : {std::pair("1", 0.04), {"8", 0.003}, {"64", 3e-4}, {"1024", 1e-4}}) {
    const double now = error(lobe, sky, {{"ibl", "method", "lobe"}, {"ibl", "stretched", directions}});
    fmt::print("{} directions: relMSE {:.5f}\n", directions, now);
    EXPECT_LT(now, most) << directions;
    EXPECT_LT(now, 0.7 * before) << directions;
    before = now;
  }
}

// Every shader that shades surfaces, with every lobe and its textures: terms, layers, fog, reflections, probes, rays,
// supersampling. What is beside beauty changes none of it, and its terms sum to it.
TEST_F(LobesInFrames, EveryShaderDrawsThem) {
  const auto drawn = [](Job job) {
    const Images all = images_of(job);
    for (const Image& image : all)
      if (image.layer == "beauty" || image.layer.find('.') != std::string::npos)
        for (const float v : image.values<float>()) EXPECT_TRUE(std::isfinite(v)) << image.layer;
    return all;
  };
  const Job plain = job_for(scene("lobes"), 40, 42);
  const Images bare = drawn(plain), layered = drawn(with_layers(plain));
  EXPECT_EQ(bare["beauty"], layered["beauty"]);
  const char* terms[] = {"direct_sun",       "direct_point", "direct_spot", "ambient_diffuse",
                         "ambient_specular", "emission",     "background"};
  for (size_t i = 0; i < bare["beauty"].pixels(); ++i) {
    glm::dvec4 sum(0);
    for (const char* term : terms) sum += glm::dvec4(layered[term].values<glm::vec4>()[i]);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(double(bare["beauty"].values<glm::vec4>()[i][c]), sum[c], 1e-5 * (1 + sum[c])) << "pixel " << i;
  }
  Job effects = plain;
  effects.sky = write_sky("of_lobes", [](glm::dvec3 d) { return glm::dvec3(1 + d.x, 1, 1 - 0.5 * d.y); }).file;
  effects.look = look_file(R"({"fog": {"extinction": 0.05}, "reflections": {}, "probes": [
      {"position": [0, 3, 1], "box": {"min": [-4, -1, -3], "max": [4, 7, 4]}, "fade_m": 0.5, "time_s": 0}]})");
  effects.settings = {{"probes", "size_px", "16"}};
  drawn(effects);
  effects.layers = {"ambient_specular", "reflections"};
  drawn(effects);
  Job traced = plain;
  traced.width_px = traced.height_px = 24;
  traced.settings = {{"local", "method", "traced"}, {"sun", "mode", "traced"}, {"occlusion", "method", "traced"}};
  traced.look = look_file(R"({"lights": {"radius_m": 0.1}})");
  drawn(traced);
  Job supersampled = plain;
  supersampled.settings = {{"supersample", "n", "2"}};
  drawn(supersampled);
}

// A sheet between the viewer and a light shows what passes through it, and nothing where something stands behind it:
// with shadow maps of suns and lamps, and with rays.
TEST_F(LobesInFrames, LightPassesFromBehind) {
  const auto middle = [](bool passes, bool blocked, bool lamp, std::vector<KnobSetting> settings) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json m = diffuse_material(0.5, 0.5, 0.5);
    m["doubleSided"] = true;
    const int grey = add_material(b, m);
    if (passes)
      m["extensions"]["KHR_materials_diffuse_transmission"] = {{"diffuseTransmissionFactor", 0.5},
                                                               {"diffuseTransmissionColorFactor", {0.8, 0.4, 0.2}}};
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, m))}});
    if (blocked) add_node(b, {{"mesh", add_square_mesh(b, 2, grey)}, {"translation", {0, 0, -0.5}}});
    if (lamp)
      add_light(b, {{"type", "point"}, {"intensity", 4.0}}, {{"translation", {0, 0, -2}}});
    else
      add_light(b, {{"type", "directional"}, {"intensity", 1.0}},
                {{"rotation", rotation_between({0, 0, -1}, {0, 0, 1})}});
    Job job = job_for(write(b), 32, 32);
    look(job, {0.4, 0.3, 3}, {0, 0, 0}, 30);
    job.settings = std::move(settings);
    return glm::dvec3(images_of(job)["beauty"].at<glm::vec4>(16, 16));
  };
  const std::vector<KnobSetting> maps, rays = {{"local", "method", "traced"}, {"sun", "mode", "traced"}};
  for (const bool lamp : {false, true})
    for (const auto& settings : {maps, rays}) {
      const glm::dvec3 seen = middle(true, false, lamp, settings), wanted = glm::dvec3(0.8, 0.4, 0.2) * 0.5 / M_PI;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], wanted[c], 0.01 * wanted[c]) << lamp << settings.size();
      EXPECT_EQ(middle(true, true, lamp, settings), glm::dvec3(0)) << lamp << settings.size();
      EXPECT_EQ(middle(false, false, lamp, settings), glm::dvec3(0)) << lamp << settings.size();
    }
}

}  // namespace candela::test
