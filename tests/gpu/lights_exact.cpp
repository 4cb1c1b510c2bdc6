#include <numbers>

#include "base/rng.h"
#include "frame_fixture.h"

// Every technique gives the bytes of brute-force, whatever the lights: each known way to get light lists wrong has a
// case.
namespace candela::test {
namespace {

using std::numbers::pi;

Json rotation_towards(glm::dvec3 direction) { return rotation_between({0, 0, -1}, direction); }
Json at(glm::dvec3 p) { return {{"translation", {p.x, p.y, p.z}}}; }

void point(GltfBuilder& b, glm::dvec3 p, double range_m, double candela = 5) {
  Json light = {{"type", "point"}, {"intensity", candela}};
  if (range_m > 0) light["range"] = range_m;
  add_light(b, light, at(p));
}
void spot(GltfBuilder& b, glm::dvec3 p, glm::dvec3 direction, double range_m, double outer_rad, double inner_rad,
          double candela = 20) {
  Json node = at(p);
  node["rotation"] = rotation_towards(direction);
  add_light(b,
            {{"type", "spot"},
             {"intensity", candela},
             {"range", range_m},
             {"spot", {{"outerConeAngle", outer_rad}, {"innerConeAngle", inner_rad}}}},
            node);
}
glm::dvec3 random_point(Rng& rng, glm::dvec3 low, glm::dvec3 high) {
  return {rng.uniform(low.x, high.x), rng.uniform(low.y, high.y), rng.uniform(low.z, high.z)};
}
glm::dvec3 random_direction(Rng& rng) {
  for (;;) {
    const glm::dvec3 d = random_point(rng, glm::dvec3(-1), glm::dvec3(1));
    if (glm::length(d) > 0.1 && glm::length(d) < 1) return glm::normalize(d);
  }
}

// A floor to the horizon, slanted squares one behind the other with sky between, one of them glass, and a wall five
// kilometres off.
GltfBuilder stage() {
  GltfBuilder b = empty_scene();
  const int clay = add_material(b, {{"pbrMetallicRoughness", base_color(0.7, 0.6, 0.5)}, {"doubleSided", true}});
  Json glass = {
      {"pbrMetallicRoughness", base_color(0.5, 0.7, 0.9, 0.4)}, {"doubleSided", true}, {"alphaMode", "BLEND"}};
  const int floor = add_square_mesh(b, 400, clay), square = add_square_mesh(b, 1, clay),
            wall = add_square_mesh(b, 900, clay), pane = add_square_mesh(b, 1, add_material(b, glass));
  const double s = std::sqrt(0.5);
  add_node(b, {{"mesh", floor}, {"translation", {0, -1, 0}}, {"rotation", {-s, 0, 0, s}}});
  const double places[][4] = {
      {-1.2, 0, -1, 0.5}, {0.9, 0.1, -3, -0.9}, {-0.5, 0.6, -8, 1.2}, {2.5, 0.5, -16, 0.2}, {0.2, -0.4, -1.5, 1.5}};
  for (const auto& p : places)
    add_node(b, {{"mesh", square},
                 {"translation", {p[0], p[1], p[2]}},
                 {"rotation", {0, std::sin(p[3] / 2), 0, std::cos(p[3] / 2)}}});
  add_node(b, {{"mesh", pane}, {"translation", {0.3, 0, -2}}});
  add_node(b, {{"mesh", pane}, {"translation", {-0.4, 0.2, 0.6}}, {"scale", {0.4, 0.4, 0.4}}});
  add_node(b, {{"mesh", wall}, {"translation", {1500, 300, -5000}}});
  use_materials(b);
  return b;
}

struct Case {
  const char* name;
  std::function<void(GltfBuilder&, Rng&)> lights;
  glm::dvec3 eye{0, 0.5, 3}, target{0, 0, -4};
  double yfov_deg = 60;
  double half_height_m = 0;  // orthographic when not 0
};

const Case cases[] = {
    {"PointsAndSpotsAllOver",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 40; ++i)
         point(b, random_point(rng, {-4, -1, -20}, {4, 3, 3}), std::exp(rng.uniform(-3, 1.5)));
       for (int i = 0; i < 40; ++i)
         spot(b, random_point(rng, {-4, -1, -20}, {4, 3, 3}), random_direction(rng), rng.uniform(0.3, 6),
              rng.uniform(0.1, 1.5), 0.05);
     }},
    // The closest ball of a growing capsule is not the one at the foot of the perpendicular: lights beside long tiles.
    {"LightsBesideLongTiles",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 60; ++i) {
         const double z = rng.uniform(-300, -5);
         point(b, {rng.uniform(-0.3, 0.3) * z, rng.uniform(-1, 0.5), z}, 1 + std::abs(z) * rng.uniform(0.01, 0.1),
               50 * z * z);
       }
     }},
    {"ConesNearZero",
     [](GltfBuilder& b, Rng& rng) {
       const double angles[] = {1e-4, 1e-3, 4e-3, 0.01};
       for (int i = 0; i < 40; ++i) {
         const glm::dvec3 p = random_point(rng, {-3, 0, -10}, {3, 4, 2});
         spot(b, p, random_point(rng, {-2, -1, -8}, {2, -1, 1}) - p, 12, angles[i % 4], 0, 400);
       }
     }},
    {"ConesNearNinetyDegrees",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 40; ++i)
         spot(b, random_point(rng, {-3, -0.9, -10}, {3, 2, 2}), random_direction(rng), rng.uniform(0.5, 5),
              pi / 2 - rng.uniform(0, 2e-3), i % 2 ? pi / 2 - 3e-3 : 0);
     }},
    {"SharpConeEdges",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 40; ++i) {
         const double outer = rng.uniform(0.05, 1.5);
         spot(b, random_point(rng, {-3, -0.9, -10}, {3, 2, 2}), random_direction(rng), rng.uniform(0.5, 5), outer,
              outer * 0.99999);
       }
     }},
    {"LightsRoundTheCamera",
     [](GltfBuilder& b, Rng& rng) {
       point(b, {0, 0.5, 3}, 4);
       point(b, {0, 0.5, 3.5}, 2);
       spot(b, {0, 0.5, 3}, {0, -0.1, -1}, 8, 0.4, 0.1);
       for (int i = 0; i < 30; ++i) point(b, random_point(rng, {-2, -1, 2}, {2, 3, 8}), rng.uniform(0.5, 6));
       for (int i = 0; i < 30; ++i)
         spot(b, random_point(rng, {-2, -1, 3}, {2, 3, 8}), random_direction(rng), rng.uniform(1, 9),
              rng.uniform(0.2, 1.5), 0.1);
     }},
    {"LightsAtTheEdgeOfTheView",  // tangents overflow where a ball touches the plane of the camera
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 50; ++i) {
         const double range = rng.uniform(0.2, 3), angle = rng.uniform(0, 2 * pi);
         const double distance = range * (1 + (i % 5 - 2) * 1e-4);
         point(b, {0 + distance * std::cos(angle), 0.5 + distance * std::sin(angle), 3 + (i % 3 - 1) * 1e-5}, range);
       }
     }},
    {"LightsOnClusterBoundaries",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 1; i <= 6; ++i)
         for (int k = 0; k < 8; ++k) {
           const double z = std::ldexp(1 + k % 4 * 0.25, i), range = k < 4 ? 0.1 * z : std::ldexp(1.0, i - 2);
           point(b, {rng.uniform(-0.4, 0.4) * z, -0.99, 3 - z}, range, z * z);
         }
     }},
    // From above, the floor 15 m away. Slices end at the first power of two beyond the deepest light, 16 m, and the
    // last of four to the octave begins at 14 m.
    {"LightsInTheLastSliceAlone",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 40; ++i) point(b, random_point(rng, {-4, -1, -6}, {4, -0.8, -2}), rng.uniform(0.3, 0.5), 50);
     },
     {0, 14, -2},
     {0, -1, -4}},
    {"TinyRanges",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 200; ++i)
         point(b, {rng.uniform(-1.5, 1.5), -1, rng.uniform(-2, 0.4)}, std::exp(rng.uniform(-7, -2)), 0.1);
     }},
    {"EnormousRanges",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 20; ++i)
         point(b, random_point(rng, {-400, 1, -400}, {400, 100, 400}), std::pow(10, rng.uniform(2, 18)), 1e4);
       for (int i = 0; i < 20; ++i)
         spot(b, random_point(rng, {-400, 1, -400}, {400, 100, 400}), random_direction(rng),
              std::pow(10, rng.uniform(2, 18)), rng.uniform(0.01, 1.5), 0, 1e4);
     }},
    {"WithoutRangeAndFromTheSun",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 12; ++i)
         point(b, random_point(rng, {-4, -1, -20}, {4, 3, 3}), i % 4 ? rng.uniform(0.2, 2) : 0);
       add_light(b, {{"type", "directional"}, {"intensity", 0.5}}, {{"rotation", rotation_towards({0.3, -1, -0.2})}});
     }},
    {"KilometresAway",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 40; ++i)
         point(b, random_point(rng, {600, -600, -5000}, {2400, 1200, -4900}), rng.uniform(100, 300), 1e6);
       for (int i = 0; i < 20; ++i)
         spot(b, random_point(rng, {600, -600, -4900}, {2400, 1200, -4500}),
              {rng.uniform(-1, 1), rng.uniform(-1, 1), -1}, 900, 0.3, 0.1, 1e6);
     },
     {0, 0.5, 3},
     {1500, 300, -5000},
     20},
    {"WideView",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 60; ++i) point(b, random_point(rng, {-9, -1, -8}, {9, 1, 3}), rng.uniform(1, 5));
     },
     {0, 0.5, 3},
     {0, 0, -4},
     165},
    {"NarrowView",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 60; ++i)
         point(b, random_point(rng, {-0.4, 0.3, -9}, {0.4, 0.9, -7}), rng.uniform(0.01, 0.2), 0.05);
     },
     {0, 0.6, 40},
     {-0.2, 0.6, -8},
     0.5},
    {"Orthographic",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 40; ++i) point(b, random_point(rng, {-4, -1, -20}, {4, 3, 3}), rng.uniform(0.1, 2));
       for (int i = 0; i < 40; ++i)
         spot(b, random_point(rng, {-4, -1, -20}, {4, 3, 3}), random_direction(rng), rng.uniform(0.3, 6),
              rng.uniform(0.1, 1.5), 0.05);
     },
     {0, 0.5, 5},
     {0.4, 0, -4},
     60,
     2.5},
    {"ThousandsOnOneTile",
     [](GltfBuilder& b, Rng& rng) {
       for (int i = 0; i < 3000; ++i)
         point(b, glm::dvec3(0.1, -0.8, -2) + 0.05 * random_direction(rng), rng.uniform(0.2, 0.5), 0.001);
     }},
};

class LightsExact : public FrameTest, public testing::WithParamInterface<Case> {
 protected:
  Job job_of(const Case& c, int width, int height, int samples, const std::string& technique) {
    Job job = job_for(write(scene_), width, height, samples);
    job.technique = technique;
    // Shadows would hide what wrong lists show.
    job.settings = {{"lights", "few", "0"}, {"local", "lights", "0"}};
    if (c.half_height_m == 0) look(job, c.eye, c.target, c.yfov_deg);
    return job;
  }
  static size_t differing(const Image& a, const Image& b) {
    const auto x = a.values<glm::uvec4>(), y = b.values<glm::uvec4>();
    size_t count = x.size() != y.size();
    for (size_t i = 0; i < std::min(x.size(), y.size()); ++i) count += x[i] != y[i];
    return count;
  }
  GltfBuilder scene_ = stage();
};

TEST_P(LightsExact, SameBytesAsBruteForce) {
  const Case& c = GetParam();
  Rng rng(7);
  c.lights(scene_, rng);
  if (c.half_height_m > 0) {
    scene_.json["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic",
          {{"xmag", 1.5 * c.half_height_m}, {"ymag", c.half_height_m}, {"znear", 0.1}, {"zfar", 100}}}}};
    Json node = at(c.eye);
    node["rotation"] = rotation_towards(c.target - c.eye);
    node["camera"] = 0;
    add_node(scene_, node);
  }
  size_t lit = 0;
  for (const int samples : {1, 4}) {
    const auto [width, height] = samples == 1 ? std::pair(101, 67) : std::pair(96, 48);
    const Images expected = images_of(job_of(c, width, height, samples, "brute-force"));
    for (const glm::vec4& p : expected["beauty"].values<glm::vec4>()) lit += p.x + p.y + p.z > 0;
    for (const char* technique : {"clustered", "forward-plus"})
      for (const char* list : {"bitmask", "compact"}) {
        Job job = job_of(c, width, height, samples, technique);
        job.settings.push_back({"lights", "list", list});
        job.settings.push_back({"lights", "order", samples == 1 ? "sorted" : "segments"});
        job.settings.push_back({"lights", "sift_over", samples == 1 ? "1073741824" : "0"});
        job.layers = {"heatmap_lights", "heatmap_missed"};
        const Images got = images_of(job);
        EXPECT_EQ(differing(expected["beauty"], got["beauty"]), 0u) << technique << " " << list << " " << samples;
        double listed = 0;
        for (const float n : got["heatmap_lights"].values<float>()) listed += double(n);
        for (const float n : got["heatmap_missed"].values<float>()) ASSERT_EQ(n, 0.0f);
        EXPECT_GT(listed, 0) << technique;
      }
  }
  EXPECT_GT(lit, 30u) << "the lights of this case must be seen";
}

INSTANTIATE_TEST_SUITE_P(, LightsExact, testing::ValuesIn(cases),
                         [](const auto& info) { return std::string(info.param.name); });

// Knobs that may change time alone.
TEST_F(LightsExact, NoKnobOfTheListsChangesAByte) {
  Rng rng(3);
  cases[0].lights(scene_, rng);
  const Images expected = images_of(job_of(cases[0], 101, 67, 4, "brute-force"));
  const std::vector<std::vector<KnobSetting>> variants = {
      {{"lights", "test", "aabb"}},           {{"lights", "test", "cone-sphere"}},
      {{"lights", "test", "capsule"}},        {{"lights", "mask", "0"}},
      {{"lights", "tile_px", "8"}},           {{"lights", "tile_px", "256"}},
      {{"lights", "slices_per_octave", "1"}}, {{"lights", "slices_per_octave", "16"}},
      {{"lights", "order", "sorted"}},        {{"lights", "order", "segments"}},
      {{"lights", "sift_over", "0"}},         {{"lights", "sift_over", "5"}}};
  for (const char* technique : {"clustered", "forward-plus"})
    for (const auto& settings : variants) {
      Job job = job_of(cases[0], 101, 67, 4, technique);
      job.settings.insert(job.settings.end(), settings.begin(), settings.end());
      EXPECT_EQ(differing(expected["beauty"], images_of(job)["beauty"]), 0u)
          << technique << " " << settings[0].knob << "=" << settings[0].value;
    }
}

// Each test lists no fewer than a tighter one, and all list every light that is needed.
TEST_F(LightsExact, TighterTestsListFewerLights) {
  Rng rng(5);
  cases[0].lights(scene_, rng);
  for (const char* technique : {"clustered", "forward-plus"}) {
    double before = std::numeric_limits<double>::infinity();
    for (const char* test : {"aabb", "capsule", "capsule-joint"}) {
      Job job = job_of(cases[0], 96, 48, 1, technique);
      job.settings.push_back({"lights", "test", test});
      job.layers = {"heatmap_lights", "heatmap_waste", "heatmap_missed"};
      const Images got = images_of(job);
      double listed = 0;
      for (const float n : got["heatmap_lights"].values<float>()) listed += double(n);
      for (const float n : got["heatmap_missed"].values<float>()) ASSERT_EQ(n, 0.0f);
      EXPECT_LE(listed, before) << technique << " " << test;
      before = listed;
    }
  }
}

// A cap loses light, and says so; without one the list of ten thousand lights is whole (SameBytesAsBruteForce).
TEST_F(LightsExact, TheCapLosesLightAndSaysHowMuch) {
  Rng rng(3);
  for (const Case& c : cases)
    if (std::string_view(c.name) == "ThousandsOnOneTile") c.lights(scene_, rng);
  Job job = job_of(cases[0], 96, 48, 1, "forward-plus");
  const Images whole = images_of(job);
  job.settings.push_back({"lights", "cap", "255"});
  const auto session = open(job);
  ASSERT_TRUE(session);
  const FrameResult capped = render(*session);
  EXPECT_GT(differing(whole["beauty"], images(capped)["beauty"]), 0u);
  ASSERT_EQ(capped.warnings.size(), 1u);
  EXPECT_NE(capped.warnings[0].find("LOST"), std::string::npos) << capped.warnings[0];
}

// What a cap leaves of a list does not depend on which pixels are shaded beside each other: techniques that share the
// same cells show the same lights, and differ as they do without a cap.
TEST_F(LightsExact, ACapTakesTheSameLightsInEachTechnique) {
  Rng rng(3);
  cases[0].lights(scene_, rng);
  for (const int samples : {1, 4}) {
    std::optional<std::vector<glm::vec4>> first;
    for (const char* technique : {"clustered", "deferred-clustered", "visibility"}) {
      Job job = job_of(cases[0], 96, 48, samples, technique);
      job.settings.push_back({"lights", "cap", "2"});
      const auto values = images_of(job)["beauty"].values<glm::vec4>();
      if (!first) first = values;
      size_t apart = 0;
      for (size_t i = 0; i < values.size(); ++i)
        apart += glm::length(values[i] - (*first)[i]) > 1e-3f * glm::length((*first)[i]) + 1e-6f;
      // Of several samples visibility shades the middle of those that a triangle has, which may lie in another cell.
      EXPECT_LE(apart, samples > 1 && std::string_view(technique) == "visibility" ? 96u * 48 / 50 : 2u)
          << samples << " samples, " << technique;
    }
  }
}

// More memory than lights.memory_mb allows makes cells larger, never lists shorter.
TEST_F(LightsExact, SparseMemoryMakesCellsLarger) {
  Rng rng(3);
  for (int i = 0; i < 3000; ++i) point(scene_, random_point(rng, {-9, -1, -20}, {9, 3, 3}), 8, 0.01);
  Job job = job_of(cases[0], 96, 48, 1, "brute-force");
  const Images expected = images_of(job);
  job = job_of(cases[0], 96, 48, 1, "clustered");
  job.settings.push_back({"lights", "memory_mb", "1"});
  job.settings.push_back({"lights", "list", "compact"});
  const auto session = open(job);
  ASSERT_TRUE(session);
  const FrameResult result = render(*session);
  EXPECT_EQ(differing(expected["beauty"], images(result)["beauty"]), 0u);
  EXPECT_TRUE(std::any_of(result.notes.begin(), result.notes.end(),
                          [](const std::string& n) { return n.find("lights.memory_mb") != std::string::npos; }));
}

}  // namespace
}  // namespace candela::test
