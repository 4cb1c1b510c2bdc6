// Fog as the GPU draws it against the reference's single scattering, shadows aside: the layers of fog, at pixels'
// centres.
#include <numeric>

#include "reference_parity.h"
#include "testscenes/make_scene.h"

namespace candela::test {
namespace {

struct FogPair {
  std::vector<glm::dvec3> light, through, beauty;  // of the GPU
  std::vector<glm::dvec3> true_light, true_through, true_beauty;
  // Of the fog's light, over the pixels of which it is at least a tenth, but for a fraction of the worst: where a lamp
  // is seen, neither side's few samples of a pixel find the mean of a glow that goes to infinity.
  double relmse(double trimmed = 0) const {
    std::vector<double> errors;
    for (size_t i = 0; i < light.size(); ++i) {
      const glm::dvec3 truth = true_light[i];
      if (truth.x + truth.y + truth.z < 0.1 * (true_beauty[i].x + true_beauty[i].y + true_beauty[i].z)) continue;
      double error = 0;
      for (int c = 0; c < 3; ++c) error += std::pow(light[i][c] - truth[c], 2) / (truth[c] * truth[c] + 0.01) / 3;
      errors.push_back(error);
    }
    if (errors.empty()) return 0;
    std::ranges::sort(errors);
    errors.resize(errors.size() - size_t(trimmed * double(errors.size())));
    return std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
  }
  double worst_transmittance() const {
    double worst = 0;
    for (size_t i = 0; i < through.size(); ++i)
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(through[i][c] - true_through[i][c]));
    return worst;
  }
  double beauty_relmse() const {
    double sum = 0;
    for (size_t i = 0; i < beauty.size(); ++i)
      for (int c = 0; c < 3; ++c)
        sum += std::pow(beauty[i][c] - true_beauty[i][c], 2) / (std::pow(true_beauty[i][c], 2) + 0.01) / 3;
    return sum / double(beauty.size());
  }
};

}  // namespace

class ReferenceFog : public ReferenceParity {
 protected:
  // Surfaces, masks and blending, lamps of every kind; eyes at a height of 1 and some metres.
  static std::string room(bool with_sun) {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.7, 0.6, 0.5)))},
                 {"translation", {0, 0, -8}}});
    Json glass = diffuse_material(0.2, 0.9, 0.2);
    glass["alphaMode"] = "BLEND", glass["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, glass))}, {"translation", {1, 0.4, -4}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.7f, add_material(b, unlit_material(0.4, 0.5, 0.6, 1)))},
                 {"translation", {-1.5, -0.4, -3}}});
    add_light(b, {{"type", "point"}, {"intensity", 12.0}, {"color", {1, 0.7, 0.3}}}, {{"translation", {-2, 1, -5}}});
    add_light(b, {{"type", "point"}, {"intensity", 6.0}, {"range", 3.0}}, {{"translation", {2, -1, -3}}});
    add_light(b,
              {{"type", "spot"},
               {"intensity", 40.0},
               {"range", 12.0},
               {"color", {0.3, 0.6, 1}},
               {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
              {{"translation", {1.5, 3, -6}}, {"rotation", {-0.7071068, 0, 0, 0.7071068}}});
    if (with_sun) add_light(b, {{"type", "directional"}, {"intensity", 2.0}}, {{"rotation", {-0.5, 0.1, 0, 0.86}}});
    return write(b);
  }
  static std::vector<glm::dvec3> averaged(const Image& image, int side) {
    std::vector<glm::dvec3> out;
    for (int y = 0; y < image.height / side; ++y)
      for (int x = 0; x < image.width / side; ++x) {
        glm::dvec3 sum(0);
        for (int j = 0; j < side; ++j)
          for (int i = 0; i < side; ++i) sum += glm::dvec3(image.at<glm::vec4>(x * side + i, y * side + j));
        out.push_back(sum / double(side * side));
      }
    return out;
  }
  // Both at side * side samples a pixel, on a grid.
  static FogPair pair_of(Job job, int fog_steps = 256, int side = 1, bool shadows = false) {
    job.settings.push_back({"lights", "floor_lux", "0"});
    if (!shadows) job.settings.insert(job.settings.end(), {{"sun", "mode", "off"}, {"local", "lights", "0"}});
    job.samples = 1;
    job.layers = {"fog", "fog_transmittance"};
    FogPair out;
    Job large = job;
    large.width_px *= side, large.height_px *= side;
    const Images images = images_of(large);
    if (images.size() != 3) return out;
    out.light = averaged(images["fog"], side);
    out.through = averaged(images["fog_transmittance"], side);
    out.beauty = averaged(images["beauty"], side);
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return out;
    reference::TraceSettings settings;
    settings.visibility = shadows;
    settings.ambient = reference::Ambient::occlusion;
    settings.fog_steps = fog_steps;
    settings.sampler = {reference::SamplerKind::uniform, side * side, 0};
    reference::Film film(job.width_px, job.height_px, {.fog = true});
    film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), side * side,
             [](double) { return true; });
    for (size_t i = 0; i < film.pixels(); ++i) {
      out.true_light.push_back(film.fog_light(i));
      out.true_through.push_back(film.fog_through(i));
      out.true_beauty.emplace_back(film.mean(i));
    }
    return out;
  }
  static Job in_fog(const std::string& scene, const std::string& fog) {
    Job job = job_for(scene, width, height);
    job.look = look_file("{\"fog\": " + fog + "}");
    look(job, {0, 0.5, 3}, {0, 0, -3}, 50);
    return job;
  }
};

// Every kind of fog, marched in many slices and in the default grid; coloured, high and low, bounded from within and
// without, forwards and backwards.
TEST_F(ReferenceFog, LayersOfEveryKind) {
  const std::string scene = room(true);
  const std::pair<const char*, double> kinds[] = {
      {R"({"extinction": [0.05, 0.08, 0.12], "albedo": 0.9})", 1},
      {R"({"extinction": 0.1, "anisotropy": 0.8, "falloff": 0.3, "height": 0.5, "emission": [0.01, 0.02, 0.0]})", 1},
      {R"({"extinction": 0.2, "anisotropy": -0.5, "bounds": {"x": [-3, 3], "y": [-1, 1.5], "z": [-7, -2]}})", 4},
      {R"({"extinction": 3, "albedo": [0.9, 0.5, 1], "falloff": 0.1, "height": -2})", 1},
      // Several media: overlapping, one turned, one around the eye, one behind it, one seen edge-on.
      {R"({"extinction": 0.03, "anisotropy": 0.5, "boxes": [
           {"extinction": [0.3, 0.2, 0.1], "albedo": 0.8, "anisotropy": -0.4, "rotation_deg": 30,
            "bounds": {"x": [-2, 1], "y": [-2, 1], "z": [-6, -3]}},
           {"extinction": 0.4, "emission": [0, 0.02, 0.05], "falloff": 0.8, "height": -1,
            "bounds": {"x": [-1, 3], "z": [-7, -4]}},
           {"extinction": 0.1, "bounds": {"x": [-1, 1], "y": [0, 1], "z": [2, 4]}},
           {"extinction": 5, "bounds": {"z": [4, 9]}},
           {"extinction": 0.5, "bounds": {"y": [0.45, 0.5], "z": [-8, 1]}}]})",
       8},
  };
  for (const auto& [fog, slack] : kinds) {
    Job job = in_fog(scene, fog);
    const FogPair grid = pair_of(job);
    job.settings = {{"fog", "method", "pixels"}, {"fog", "steps", "512"}};
    // A ray stands for its pixel's width, within which a lamp's glow is a disc's: narrower pixels tend to the point.
    // Measured at 2 x 2 a pixel: 4.0e-4 at most, where bounds cut the fog within a pixel.
    const FogPair marched = pair_of(job, 256, 2);
    fmt::print("{}: grid {:.2e}, marched {:.2e}, transmittance {:.1e}, beauty {:.2e}\n", fog, grid.relmse(),
               marched.relmse(), marched.worst_transmittance(), marched.beauty_relmse());
    EXPECT_LT(grid.relmse(), 2e-3 * slack) << fog;
    EXPECT_LT(marched.relmse(), 5e-4) << fog;
    EXPECT_LT(marched.worst_transmittance(), 2e-5) << fog;
    EXPECT_LT(grid.worst_transmittance(), 2e-5) << fog;
    EXPECT_LT(marched.beauty_relmse(), 2e-4) << fog;
  }
}

// Lamps behind pillars, one inside a wall, and a spot through a gate: shafts of light and of dark in the air. The more
// points, the nearer to traced light; without maps the lamps shine through. Measured: 2.2e-2 without, 3.9e-3 in the
// coarsest grid, 1.5e-3 in the default one, 1.9e-5 where each pixel follows its ray.
TEST_F(ReferenceFog, ShadowsOfLamps) {
  GltfBuilder b = empty_scene();
  const int stone = add_material(b, diffuse_material(0.3, 0.3, 0.3));
  const auto wall = [&](double half, double x, double y, double z, bool across) {
    Json node = {{"mesh", add_square_mesh(b, float(half), stone)}, {"translation", {x, y, z}}};
    if (across) node["rotation"] = {0, 0.7071068, 0, 0.7071068};
    add_node(b, node);
  };
  wall(8, 0, 0, -9, false);
  for (const double x : {-1.6, 0.0, 1.6}) wall(0.4, x, 0.2, -5.5, false);
  wall(0.8, -1, 0.5, -3, true);
  wall(0.5, 2.2, -1, -4, false);
  add_light(b, {{"type", "point"}, {"intensity", 40.0}, {"color", {1, 0.7, 0.3}}}, {{"translation", {0.6, 0.3, -7}}});
  add_light(b, {{"type", "point"}, {"intensity", 20.0}, {"range", 9.0}}, {{"translation", {-2, 0.6, -3.1}}});
  add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {3, 2, -9}}});  // within the wall
  add_light(b,
            {{"type", "spot"},
             {"intensity", 150.0},
             {"range", 12.0},
             {"color", {0.3, 0.6, 1}},
             {"spot", {{"innerConeAngle", 0.3}, {"outerConeAngle", 0.4}}}},
            {{"translation", {2.2, 2.5, -4}}, {"rotation", {-0.7071068, 0, 0, 0.7071068}}});
  Job job = in_fog(write(b), R"({"extinction": [0.05, 0.06, 0.07], "anisotropy": 0.3})");
  const auto error = [&](const std::string& grid, const char* points) {
    job.settings = {{"fog", "steps", "256"}, {"fog", "local_shadows", points}};
    job.settings.push_back({"fog", std::isalpha(grid[0]) ? "method" : "grid", grid});
    const FogPair pair = pair_of(job, 256, 2, true);
    fmt::print("{}, {} points: relMSE {:.2e}\n", grid, points, pair.relmse());
    return pair.relmse();
  };
  const double shining_through = error("pixels", "0"), marched = error("pixels", "1"), coarse = error("32x18x24", "1"),
               usual = error("128x72x64", "1"), more = error("128x72x64", "4");
  EXPECT_LT(usual, 0.01);
  EXPECT_LT(usual, coarse);
  EXPECT_LT(more, usual * 1.01);
  EXPECT_LT(marched, 2e-3);
  EXPECT_GT(shining_through, 10 * usual);
}

// A low sun behind roofs of many heights: the edges of their shadows run along the rays. The more points of a slice,
// the nearer to traced light.
TEST_F(ReferenceFog, ShadowsOfSuns) {
  GltfBuilder b = empty_scene();
  const int stone = add_material(b, diffuse_material(0.3, 0.3, 0.3)), house = add_square_mesh(b, 0.5f, stone);
  const double h = std::sqrt(0.5);
  add_node(b, {{"mesh", add_square_mesh(b, 12, stone)}, {"translation", {0, -1.5, 0}}, {"rotation", {-h, 0, 0, h}}});
  for (int k = 0; k < 13; ++k)
    add_node(b, {{"mesh", house},
                 {"scale", {0.69, 1.2, 1}},
                 {"translation", {0.7 * k - 4.2, 0.55 + 0.45 * std::sin(2.3 * k), -6 + 0.8 * std::sin(1.7 * k)}}});
  add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
            {{"rotation", rotation_between({0, 0, -1}, {0.06, -0.1, 1})}});
  Job job = in_fog(write(b), R"({"extinction": [0.05, 0.06, 0.07], "anisotropy": 0.3,
      "bounds": {"x": [-6, 6], "y": [-2, 3], "z": [-11, 2]}})");
  job.width_px = 96, job.height_px = 72;
  look(job, {0, 0.5, 3}, {0, 0.5, -3}, 40);
  std::vector<double> errors;
  for (const char* points : {"1", "2", "4", "16"}) {
    job.settings = {{"fog", "sun_points", points}, {"sun", "size_px", "4096"}};
    errors.push_back(pair_of(job, 256, 1, true).relmse());
  }
  fmt::print("by points: relMSE {:.2e}\n", fmt::join(errors, " "));
  for (size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1]);
  EXPECT_LT(errors.back(), 0.75 * errors.front());
  EXPECT_LT(errors.front(), 1e-3);
}

// A lamp's glow is blurred over the rays of the grid and loses nothing by it, with and without a thing in its light;
// and nothing of it shines through a wall before it, wherever the slices' ends lie.
TEST_F(ReferenceFog, LampsLoseNoLightAndWallsHideIt) {
  const auto scene = [&](const std::vector<std::pair<float, glm::dvec3>>& squares) {
    GltfBuilder b = empty_scene();
    const int stone = add_material(b, diffuse_material(0.3, 0.3, 0.3));
    add_node(b, {{"mesh", add_square_mesh(b, 20, stone)}, {"translation", {0, 0, -14}}});
    for (const auto& [half, at] : squares)
      add_node(b, {{"mesh", add_square_mesh(b, half, stone)}, {"translation", {at.x, at.y, at.z}}});
    add_light(b, {{"type", "point"}, {"intensity", 100.0}, {"range", 30.0}}, {{"translation", {0, 0.5, -3}}});
    return write(b);
  };
  const auto sum = [](const std::vector<glm::dvec3>& light) {
    double s = 0;
    for (const glm::dvec3& v : light) s += v.y;
    return s;
  };
  const std::string fog = R"({"extinction": 0.05, "albedo": 0.9, "anisotropy": 0.3})";
  for (const auto& [name, squares] : std::vector<std::pair<std::string, std::vector<std::pair<float, glm::dvec3>>>>{
           {"open air", {}}, {"squares beside it", {{0.1f, {-0.3, 0.5, -3.2}}, {0.1f, {0.3, 0.3, -2.8}}}}}) {
    const FogPair pair = pair_of(in_fog(scene(squares), fog), 256, 2, true);
    ASSERT_FALSE(pair.light.empty());
    fmt::print("{}: {:.4f} of the true light, relMSE {:.2e}\n", name, sum(pair.light) / sum(pair.true_light),
               pair.relmse());
    EXPECT_NEAR(sum(pair.light) / sum(pair.true_light), 1, 0.01) << name;
  }
  const std::string behind = scene({{0.5f, {0, 0.5, -2.8}}});
  for (int i = 0; i < 8; ++i) {
    Job job = in_fog(behind, fog);
    look(job, {0, 0.5, 3 - 0.1 * i}, {0, 0.5, -3}, 50);
    const FogPair pair = pair_of(job, 64, 1, true);
    ASSERT_FALSE(pair.light.empty());
    const size_t middle = size_t(height / 2) * width + width / 2;
    EXPECT_LT(pair.light[middle].y, 0.01) << i;  // 0.8 where the slice is interpolated
    EXPECT_LT(pair.true_light[middle].y, 0.01) << i;
  }
}

// The goal of the default: a night street of 1,024 lamps in fog, each value of the grid nearer to the truth.
TEST_F(ReferenceFog, TheStreetUpTheLadder) {
  const std::string path = ::testing::TempDir() + "candela_fog_street.glb";
  ASSERT_TRUE(make_scene("street", 1, 1024, path));
  Job job = job_for(path, 96, 54);
  job.look = look_file(R"({"fog": {"extinction": 0.02, "albedo": 0.95, "anisotropy": 0.3}})");
  std::vector<double> errors, trimmed;
  for (const char* grid : {"32x18x24", "96x54x48", "128x72x64", "160x90x128", "pixels", "march"}) {
    const bool is_method = std::isalpha(grid[0]);
    job.settings = {{"fog", is_method ? "method" : "grid", grid}};
    const FogPair pair = pair_of(job, 16, 4);
    errors.push_back(pair.relmse()), trimmed.push_back(pair.relmse(0.01));
    fmt::print("{}: relMSE {:.2e}, without the worst hundredth {:.2e}\n", grid, errors.back(), trimmed.back());
  }
  EXPECT_LT(errors[2], 0.01) << "the default";
  EXPECT_LT(trimmed[1], trimmed[0]);
  EXPECT_LT(trimmed[2], trimmed[1]);
  EXPECT_LT(trimmed[3], trimmed[2]);
  EXPECT_LT(errors[4], 0.002);
  EXPECT_LT(errors[5], 0.05) << "the seed's march";
}

}  // namespace candela::test
