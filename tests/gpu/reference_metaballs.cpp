// Polygons of metaballs against the surface itself, which the reference meets: error over the size of cells.
#include "passes/geometry/metaballs.h"
#include "reference_layer_pairs.h"
#include "textured_square.h"

namespace candela::test {

class ReferenceMetaballs : public ReferenceLayerPairs {
 protected:
  static constexpr double time_s = 17.0 / 24;
  static Job job_of(const std::string& cell) {
    Job job = job_for(one_lamp(scene("metaballs"), Light::kept), 2 * width, 2 * height);
    job.settings.push_back({"metaballs", "cell", cell});
    return job;
  }
  static LayerPair layers_of(const Job& job) {
    return ReferenceLayerPairs::layers_of(job, time_s, {"depth", "normal", "object_id", "material_id", "motion"});
  }
  // Root mean square over what both show of the body, not at its outline; 1: over how much depth it stretches.
  static double rms(const LayerPair& p, const std::vector<std::string>& channels, size_t& pixels) {
    const std::vector<uint32_t>&id = p.gpu.find("object_id.X")->u, &idr = p.reference.find("object_id.X")->u;
    const std::vector<float>& z = p.reference.find("depth.Z")->f;
    const int w = p.reference.width, h = p.reference.height;
    double sum = 0;
    pixels = 0;
    const uint32_t body = idr[size_t(h / 2) * size_t(w) + size_t(w / 2)];
    for (int y = 1; y + 1 < h; ++y)
      for (int x = 1; x + 1 < w; ++x) {
        const size_t i = size_t(y) * size_t(w) + size_t(x);
        bool inside = true;
        for (const size_t k : {i, i - 1, i + 1, i - size_t(w), i + size_t(w)})
          inside &= id[k] == body && idr[k] == body && std::abs(z[k] - z[i]) < 0.1f;
        if (!inside) continue;
        ++pixels;
        for (const std::string& c : channels)
          sum += std::pow(double(p.gpu.find(c)->f[i]) - double(p.reference.find(c)->f[i]), 2);
      }
    return std::sqrt(sum / double(pixels));
  }
};

TEST_F(ReferenceMetaballs, ErrorsFallWithTheSquareOfTheCell) {
  struct Errors {
    double depth_m, normal, relmse;
  };
  std::vector<Errors> all;
  for (const char* cell : {"4", "2", "1", "0.5"}) {
    const LayerPair layers = layers_of(job_of(cell));
    size_t pixels = 0;
    Errors e{};
    e.depth_m = rms(layers, {"depth.Z"}, pixels);
    e.normal = rms(layers, {"normal.X", "normal.Y", "normal.Z"}, pixels);
    EXPECT_GT(pixels, 500u) << cell;
    e.relmse = rendered(job_of(cell), 2, time_s).relmse();
    fmt::print("cell {}: depth {:.3e} m, normal {:.3e}, relMSE {:.3e}\n", cell, e.depth_m, e.normal, e.relmse);
    if (!all.empty()) {
      EXPECT_NEAR(std::log2(all.back().depth_m / e.depth_m), 2, 0.5) << cell;
      EXPECT_LT(e.normal, 0.45 * all.back().normal) << cell;
      EXPECT_LT(e.relmse, 0.6 * all.back().relmse) << cell;
    }
    all.push_back(e);
  }
  EXPECT_LT(all.back().depth_m, 2e-4);
  EXPECT_LT(all.back().relmse, 1e-3);
}

// Where the surface turns away from a light, shadows are those of the surface, not of facets that turn away before it
// does: of what the body shows, next to nothing is dark that the reference has lit, by maps and by rays.
TEST_F(ReferenceMetaballs, ShadowsEndWithTheSurface) {
  Job job = job_of("2");
  const LayerPair layers = layers_of(job);
  const std::vector<uint32_t>& id = layers.gpu.find("object_id.X")->u;
  const uint32_t body = id[size_t(height) * size_t(2 * width) + size_t(width)];
  job.settings.push_back({"lights", "floor_lux", "0"});
  job.samples = 1;
  auto frame = open_reference(job, time_s, {});
  ASSERT_TRUE(frame);
  reference::TraceSettings settings;
  settings.ambient = reference::Ambient::occlusion;
  settings.sampler = {reference::SamplerKind::uniform, 1, 0};
  reference::Film film(job.width_px, job.height_px);
  film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), 1,
           [](double) { return true; });
  for (const bool traced : {false, true})
    for (const char* technique : {"clustered", "deferred-clustered", "visibility"}) {
      Job drawn = job;
      drawn.technique = technique;
      if (traced) drawn.settings.push_back({"sun", "mode", "traced"});
      if (traced) drawn.settings.push_back({"local", "method", "traced"});
      const Images images = images_of(drawn, {}, time_s);
      size_t pixels = 0, dark = 0, bright = 0;
      for (int y = 1; y + 1 < job.height_px; ++y)
        for (int x = 1; x + 1 < job.width_px; ++x) {
          const size_t i = size_t(y) * size_t(job.width_px) + size_t(x);
          bool inside = true;
          for (const size_t k : {i, i - 1, i + 1, i - size_t(job.width_px), i + size_t(job.width_px)})
            inside &= id[k] == body;
          if (!inside) continue;
          const double is = images["beauty"].at<glm::vec4>(x, y).y, of = film.mean(i).y;
          ++pixels, dark += is < 0.5 * of - 0.005, bright += of < 0.5 * is - 0.005;
        }
      fmt::print("{} {}: of {} pixels {} too dark, {} too bright\n", technique, traced ? "traced" : "maps", pixels,
                 dark, bright);
      EXPECT_GT(pixels, 800u);
      EXPECT_LE(dark, pixels / 500) << technique << traced;
      EXPECT_LE(bright, pixels / 500) << technique << traced;
    }
}

// The motion of the surface: the reference's is of the field in double. What differs is where the points lie.
TEST_F(ReferenceMetaballs, AgreeOnMotion) {
  const LayerPair layers = layers_of(job_of("0.5"));
  size_t pixels = 0;
  const double off_px = rms(layers, {"motion.X", "motion.Y"}, pixels);
  double largest = 0;
  for (const float v : layers.reference.find("motion.X")->f) largest = std::max(largest, std::abs(double(v)));
  EXPECT_GT(largest, 1);
  EXPECT_LT(off_px, 0.01 * largest);
}

namespace {

// Balls of a metre in a node's space, one if nothing is said, whose surface is a sphere.
constexpr double threshold = 0.25;
const double sphere_m = std::sqrt(1 - std::cbrt(threshold));
void add_ball(GltfBuilder& b, const Json& material, glm::dvec3 at, glm::dvec3 scale = glm::dvec3(1),
              const std::vector<glm::dvec3>& places = {glm::dvec3(0)}) {
  const int body = add_node(b, {{"translation", {at.x, at.y, at.z}}, {"scale", {scale.x, scale.y, scale.z}}});
  Json children = Json::array(), balls = Json::array();
  for (const glm::dvec3& p : places) {
    children.push_back(b.json["nodes"].size()), balls.push_back({{"node", b.json["nodes"].size()}});
    b.json["nodes"].push_back({{"translation", {p.x, p.y, p.z}}});
  }
  b.json["nodes"][size_t(body)]["children"] = children;
  b.json["nodes"][size_t(body)]["extensions"]["CANDELA_metaballs"] = {
      {"threshold", threshold}, {"cell", 0.05}, {"material", add_material(b, material)}, {"balls", balls}};
  b.use("CANDELA_metaballs", true);
}

constexpr double rho = 0.5, bright = 3, away_m = 1.5;
// A floor under a black body of that radiance.
GltfBuilder glowing_above_floor(glm::dvec3 scale, const std::vector<glm::dvec3>& places = {glm::dvec3(0)}) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, diffuse_material(rho, rho, rho)))}});
  Json glowing = diffuse_material(0, 0, 0);
  glowing["emissiveFactor"] = {1, 1, 1};
  b.use("KHR_materials_emissive_strength");
  glowing["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", bright}};
  add_ball(b, glowing, {0, 0, away_m}, scale, places);
  add_light(b, {{"type", "point"}, {"intensity", 1e-6}}, {{"translation", {0, 0, -3}}});  // so no studio is
  return b;
}
reference::Film film_of(const Job& job, const ReferenceFrame& frame, reference::Strategy strategy, int spp) {
  reference::TraceSettings settings;
  settings.mode = reference::Mode::path;
  settings.strategy = strategy;
  reference::Film film(job.width_px, job.height_px);
  film.add(reference::Integrator(*frame.world, settings, job.width_px, job.height_px), spp,
           [](double) { return true; });
  return film;
}

}  // namespace

// However a body that emits is found. On a floor below a black sphere of radiance L whose centre is d above it lies
// rho L (r / d)^2.
TEST_F(ReferenceMetaballs, NoLightOfOneThatEmitsIsLost) {
  using reference::Strategy;
  Job job = job_for(write(glowing_above_floor(glm::dvec3(1))), 6, 4);
  look(job, {2.5, 0, 0.5}, {0, 0, 0}, 0.2);
  auto frame = open_reference(job, 0, {}, reference::Mode::path);
  ASSERT_TRUE(frame) << frame.error().text();
  for (const auto& [strategy, bound] :
       {std::pair(Strategy::both, 0.001), std::pair(Strategy::light, 0.001), std::pair(Strategy::brdf, 0.02)}) {
    const reference::Film film = film_of(job, **frame, strategy, 4096);
    double mean = 0;
    for (size_t i = 0; i < film.pixels(); ++i) mean += film.mean(i).y / double(film.pixels());
    EXPECT_NEAR(mean, rho * bright * std::pow(sphere_m / away_m, 2), bound * mean) << int(strategy);
  }
}

// One is chosen as lights are: what is a twentieth of the size, and met by one path in 2,500, has no noise to speak of.
TEST_F(ReferenceMetaballs, SmallOnesThatEmitAreChosen) {
  constexpr double scale = 0.05;
  Job job = job_for(write(glowing_above_floor(glm::dvec3(scale))), 6, 4);
  look(job, {2.5, 0, 0.5}, {0, 0, 0}, 0.2);
  auto frame = open_reference(job, 0, {}, reference::Mode::path);
  ASSERT_TRUE(frame) << frame.error().text();
  const double truth = rho * bright * std::pow(scale * sphere_m / away_m, 2);
  const auto noise = [&](reference::Strategy strategy) {
    const reference::Film film = film_of(job, **frame, strategy, 64);
    double sum = 0;
    for (size_t i = 0; i < film.pixels(); ++i) sum += std::pow(film.mean(i).y / truth - 1, 2);
    return std::sqrt(sum / double(film.pixels()));
  };
  const double by_chance = noise(reference::Strategy::brdf), chosen = noise(reference::Strategy::both);
  fmt::print("64 samples a pixel, off by: {:.2g} by chance, {:.2g} chosen\n", by_chance, chosen);
  EXPECT_LT(chosen, 0.02);
  EXPECT_GT(by_chance, 50 * chosen);
}

// Of several balls in a node that is scaled unevenly, above and through the floor: each way of meeting it, and both
// together, give the same light within what their variance allows.
TEST_F(ReferenceMetaballs, EveryWayOfMeetingOneThatEmitsGivesTheSame) {
  using reference::Strategy;
  const std::vector<glm::dvec3> places = {{0, 0, 0}, {0.7, 0.1, -0.2}, {-0.6, 0.8, -1.1}, {2.5, -1, -3.2}};
  for (const double height_m : {1.1, 0.35}) {  // of the lowest ball's node
    GltfBuilder b = glowing_above_floor({0.3, 0.2, 0.45}, places);
    b.json["nodes"][1]["translation"] = {0, 0, height_m};
    b.json["nodes"][1]["rotation"] = {0.1, 0.2, 0.3, std::sqrt(1 - 0.14)};
    Job job = job_for(write(b), 8, 6);
    look(job, {0.5, -3, 2.5}, {0, 0, 0}, 30);
    auto frame = open_reference(job, 0, {}, reference::Mode::path);
    ASSERT_TRUE(frame) << frame.error().text();
    struct Light {
      double mean = 0, variance = 0;
    };
    const auto light_of = [&](Strategy strategy, int spp) {
      const reference::Film film = film_of(job, **frame, strategy, spp);
      Light light;
      for (size_t i = 0; i < film.pixels(); ++i) {
        light.mean += film.mean(i).y / double(film.pixels());
        light.variance += film.variance(i).y / std::pow(double(film.pixels()), 2);
      }
      return light;
    };
    const Light chosen = light_of(Strategy::light, 2048), met = light_of(Strategy::brdf, 8192),
                both = light_of(Strategy::both, 1024);
    fmt::print("{:.5f} +- {:.5f} chosen, {:.5f} +- {:.5f} met, {:.5f} +- {:.5f} both\n", chosen.mean,
               std::sqrt(chosen.variance), met.mean, std::sqrt(met.variance), both.mean, std::sqrt(both.variance));
    for (const Light& other : {chosen, both}) {
      EXPECT_NEAR(other.mean, met.mean, 4 * std::sqrt(other.variance + met.variance));
      EXPECT_LT(std::sqrt(other.variance), 0.02 * other.mean) << "so that it tells something";
    }
  }
}

// Bodies have no texture coordinates: textures show the place 0, 0, in all techniques and in the reference.
TEST_F(ReferenceMetaballs, TexturesShowOnePlace) {
  const auto scene_of = [](bool textured) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json material = diffuse_material(1, 1, 1);
    if (textured)
      material["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
          add_texture(b, png_from(2, 2, 3, [](double u, double v) {
                        return u < 0.5 && v < 0.5 ? glm::dvec4(1, 0, 0, 1) : glm::dvec4(0, 1, 1, 1);
                      }));
    else
      material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 1};
    add_ball(b, material, {0, 0, 0});
    add_light(b, {{"type", "point"}, {"intensity", 20}}, {{"translation", {1, 2, 3}}});
    return b;
  };
  Job job = job_for(write(scene_of(true)), width, height);
  look(job, {0, 0.3, 2.5}, {0, 0, 0}, 45);
  for (const char* technique : {"clustered", "visibility", "deferred-clustered", "ray"}) {
    job.technique = technique;
    job.scene = write(scene_of(true));
    const Pair pair = rendered(job, 1);
    job.scene = write(scene_of(false));
    const Pair plain = rendered(job, 1);
    size_t seen = 0;
    for (size_t i = 0; i < pair.gpu.size(); ++i) {
      seen += pair.reference[i].x > 0.01;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(pair.gpu[i][c], plain.gpu[i][c], 1e-4 * (1 + plain.gpu[i][c])) << technique;
        EXPECT_NEAR(pair.reference[i][c], plain.reference[i][c], 1e-6) << technique;
      }
    }
    EXPECT_GT(seen, 200u) << technique;
    EXPECT_LT(pair.relmse(), 1e-3) << technique;
  }
}

}  // namespace candela::test
