#include <algorithm>

#include "base/rng.h"
#include "frame_fixture.h"
#include "reference/film.h"
#include "reference/integrator.h"
#include "render/reference_frame.h"

// Shadows of point and spot lights in whole frames.
namespace candela::test::frame_lamps {
namespace {

constexpr int width = 96, height = 64;

}  // namespace

class FrameLamps : public FrameTest {
 protected:
  static constexpr glm::dvec3 lamp{0, 3, 0};

  static void add_lamp(GltfBuilder& b, glm::dvec3 at, const std::string& type, double cone_rad = 1.0, Json range = {}) {
    Json light = {{"type", type}, {"intensity", 100.0}};
    if (type == "spot") light["spot"] = {{"innerConeAngle", 0.1}, {"outerConeAngle", cone_rad}};
    if (!range.is_null()) light["range"] = range;
    add_light(b, light, {{"translation", {at.x, at.y, at.z}}, {"rotation", rotation_between({0, 0, -1}, {0, -1, 0})}});
  }
  // A floor of half size 20 at y = 0 and a square of half size 0.5 a metre above it.
  static GltfBuilder floor_and_square(glm::dvec3 origin = glm::dvec3(0)) {
    GltfBuilder b = empty_scene();
    const int floor = add_square_mesh(b, 20, add_material(b, diffuse_material(0.8, 0.8, 0.8)));
    const int square = add_square_mesh(b, 0.5f, add_material(b, diffuse_material(0.5, 0.2, 0.1)));
    const Json lying = rotation_between({0, 0, 1}, {0, 1, 0});
    add_node(b, {{"mesh", floor}, {"rotation", lying}, {"translation", {origin.x, origin.y, origin.z}}});
    add_node(b, {{"mesh", square}, {"rotation", lying}, {"translation", {origin.x, origin.y + 1, origin.z}}});
    return b;
  }
  static std::string lit_by(const std::vector<glm::dvec3>& lamps, const std::string& type = "point",
                            double cone_rad = 1.0) {
    GltfBuilder b = floor_and_square();
    for (const glm::dvec3 at : lamps) add_lamp(b, at, type, cone_rad);
    return write(b);
  }
  static Job looking_down(const std::string& path) {
    Job job = job_for(path, width, height, 4);
    look(job, {0, 5, 6}, {0, 0, 0}, 60);
    job.layers = {"shadow_local"};
    return job;
  }
  static void set(Job& job, const std::string& table, const std::string& knob, const std::string& value) {
    job.settings.push_back({table, knob, value});
  }
  static std::string note_of(const Job& job, const std::string& part) {
    const auto session = open(job);
    if (!session) return "no session";
    for (const std::string& note : render(*session).notes)
      if (note.find(part) != std::string::npos) return note;
    return {};
  }
};

// A lamp inside its bulb lights the floor, in both renderers; a bulb that does not glow keeps the light in.
TEST_F(FrameLamps, WhatGlowsBlocksNoLamp) {
  for (const bool glows : {true, false}) {
    GltfBuilder b = floor_and_square();
    Json bulb = diffuse_material(0.5, 0.5, 0.5);
    if (glows) bulb["emissiveFactor"] = {1, 0.9, 0.8};
    const int side = add_square_mesh(b, 0.2f, add_material(b, bulb));
    for (const glm::dvec3 out : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0),
                                 glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
      const glm::dvec3 at = lamp + 0.2 * out;
      add_node(b,
               {{"mesh", side}, {"rotation", rotation_between({0, 0, 1}, out)}, {"translation", {at.x, at.y, at.z}}});
    }
    add_lamp(b, lamp, "point");
    Job job = looking_down(write(b));
    const glm::vec4 drawn = images_of(job)["beauty"].at<glm::vec4>(width / 2, height - 4);
    auto frame = open_reference(job, 0, {});
    ASSERT_TRUE(frame) << frame.error().text();
    reference::Film film(width, height, {});
    film.add(reference::Integrator(*(*frame)->world, {}, width, height), 16, [](double) { return true; });
    const glm::dvec3 traced(film.mean(size_t(height - 4) * width + width / 2));
    if (glows) {
      EXPECT_GT(drawn.x, 0.05f);
      EXPECT_NEAR(drawn.x, traced.x, 0.02 * traced.x);
    } else {
      EXPECT_EQ(drawn.x, 0);
      EXPECT_EQ(traced.x, 0);
    }
  }
}

// The square's shadow is half again as large as itself: dark inside, lit outside, and between them no wider than the
// kernel and the filter are.
TEST_F(FrameLamps, AShadowLiesWhereTheLightCarriesIt) {
  struct Case {
    const char* type;
    double cone_rad;
  };
  for (const Case& c : {Case{"point", 0.0}, Case{"spot", 1.0}, Case{"spot", 1.4}}) {
    constexpr int columns = 2 * width, rows = 2 * height;
    Job job = looking_down(lit_by({lamp}, c.type, c.cone_rad));
    job.width_px = columns, job.height_px = rows;
    const Images images = images_of(job);
    const glm::dvec3 eye(0, 5, 6), forward = glm::normalize(-eye), right(1, 0, 0), up = glm::cross(right, forward);
    const double tan_y = std::tan(30 * 3.14159265358979 / 180), tan_x = tan_y * columns / rows;
    // In the plane of the floor, for a map of 256 texels less its border: 1.5 texels of the tent, half a one of which
    // the edge covers a part, and the lift.
    const double texel = 3 * 2 * (c.cone_rad == 1.0 ? std::tan(1.0) : 1.0) / 251, penumbra = 2.2 * texel;
    set(job, "local", "size_px", "256");
    int dark = 0, lit = 0;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const glm::dvec3 ray =
            forward + right * (tan_x * (2 * (x + 0.5) / columns - 1)) - up * (tan_y * (2 * (y + 0.5) / rows - 1));
        if (ray.y > -0.1) continue;
        const glm::dvec3 at = eye + ray * (-eye.y / ray.y), over = eye + ray * ((1 - eye.y) / ray.y);
        if (std::max(std::abs(over.x), std::abs(over.z)) < 0.6) continue;  // hidden by the square
        if (std::max(std::abs(at.x), std::abs(at.z)) > 3) continue;
        const double off = std::max(std::abs(at.x), std::abs(at.z));
        const float visibility = images["shadow_local"].at<float>(x, y);
        if (off < 0.75 - penumbra) {
          EXPECT_EQ(visibility, 0) << c.type << " " << x << "," << y << " " << off;
          ++dark;
        }
        if (off > 0.75 + penumbra) {
          EXPECT_EQ(visibility, 1) << c.type << " " << x << "," << y << " " << off;
          ++lit;
        }
      }
    EXPECT_GT(dark, 20);
    EXPECT_GT(lit, 1000);
  }
}

// Light inside a closed box of walls does not come out, and lights all of the inside.
TEST_F(FrameLamps, ALightInsideAClosedBoxStaysThere) {
  GltfBuilder b = empty_scene();
  const int floor = add_square_mesh(b, 20, add_material(b, diffuse_material(0.8, 0.8, 0.8)));
  Json both = diffuse_material(0.5, 0.5, 0.5);
  both["doubleSided"] = true;
  const int wall = add_square_mesh(b, 0.5f, add_material(b, both));
  add_node(b, {{"mesh", floor}, {"rotation", rotation_between({0, 0, 1}, {0, 1, 0})}, {"translation", {0, -1, 0}}});
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 out(0);
      out[axis] = side;
      // A hair wider than the box: edges overlap.
      add_node(b, {{"mesh", wall},
                   {"rotation",
                    rotation_between({0, 0, 1}, glm::dot(out, glm::dvec3(0, 0, 1)) < -0.5 ? glm::dvec3(0, 0, 1) : out)},
                   {"scale", {1.001, 1.001, 1}},
                   {"translation", {out.x / 2, out.y / 2, out.z / 2}}});
    }
  add_lamp(b, {0.1, 0.05, -0.2}, "point");
  Job outside = looking_down(write(b));
  const Images images = images_of(outside);
  int reached = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) reached += images["beauty"].at<glm::vec4>(x, y).x > 0;
  EXPECT_EQ(reached, 0);
  Job inside = outside;
  look(inside, {0.3, 0.2, 0.3}, {-0.3, -0.4, -0.4}, 70);
  const Images within = images_of(inside);
  // In its corners the kernel of one wall reads the other.
  const auto values = within["shadow_local"].values<float>();
  EXPECT_LT(std::ranges::count_if(values, [](float v) { return v != 1; }), width * height / 100);
}

// On the floor, inside of the square, at the camera, and where the floor's triangle ends.
TEST_F(FrameLamps, LightsAtNoDistanceStayFinite) {
  for (const glm::dvec3 at : {glm::dvec3(0), {0.2, 1, 0.1}, {0, 5, 6}, {20, 0, 20}, {0, 1e-5, 0}}) {
    const Images images = images_of(looking_down(lit_by({at})));
    for (const float v : images["beauty"].values<float>()) ASSERT_TRUE(std::isfinite(v)) << at.x << " " << at.y;
    for (const float v : images["shadow_local"].values<float>()) ASSERT_TRUE(v >= 0 && v <= 1) << at.x << " " << at.y;
  }
}

// Ranges from nothing to far, cones from a needle to all round, in one pixel and in many.
TEST_F(FrameLamps, ExtremeRangesConesAndSizesStayFinite) {
  for (const double range : {1e-3, 1e4})
    for (const double cone_rad : {0.0, 1e-3, 1.5707})
      for (const int side : {1, 32}) {
        GltfBuilder b = floor_and_square();
        add_lamp(b, lamp, cone_rad > 0 ? "spot" : "point", cone_rad, range);
        b.json["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"]["innerConeAngle"] = 0;
        if (cone_rad == 0) b.json["extensions"]["KHR_lights_punctual"]["lights"][0].erase("spot");
        Job job = looking_down(write(b));
        job.width_px = job.height_px = side;
        const Images images = images_of(job);
        for (const float v : images["beauty"].values<float>())
          ASSERT_TRUE(std::isfinite(v)) << range << " " << cone_rad;
        for (const float v : images["shadow_local"].values<float>()) ASSERT_TRUE(v >= 0 && v <= 1) << range;
      }
}

// In the middle of a wall's matter nothing is lit, on either side of it.
TEST_F(FrameLamps, ALightInsideAWallLightsNothing) {
  GltfBuilder b = floor_and_square();
  const int side = add_square_mesh(b, 10, add_material(b, diffuse_material(0.5, 0.5, 0.5)));
  for (const double face : {1.0, -1.0})
    add_node(b, {{"mesh", side},
                 {"rotation", rotation_between({0, 0, 1}, {0, 0, face})},
                 {"translation", {0, 0, -2 + 0.1 * face}}});
  add_lamp(b, {0.3, 2, -2}, "point");
  Job job = looking_down(write(b));
  job.samples = 1;  // lavapipe shades covered samples beside their places, which may lie inside of the wall
  const Images images = images_of(job);
  size_t lit = 0;
  for (size_t i = 0; i < images["beauty"].pixels(); ++i) lit += images["beauty"].values<float>()[4 * i] > 0;
  EXPECT_EQ(lit, 0u);
}

TEST_F(FrameLamps, WithoutShadowsTheFrameIsTheBareOne) {
  Job shadowed = looking_down(lit_by({lamp})), off = shadowed, none = shadowed;
  shadowed.layers = off.layers = none.layers = {};
  set(off, "local", "lights", "none");
  none.effects = "none";
  const Images with = images_of(shadowed), without = images_of(off), bare = images_of(none);
  EXPECT_EQ(without["beauty"], bare["beauty"]);
  EXPECT_NE(with["beauty"], bare["beauty"]);
}

// Lists of lights and culling change time and no bit; nor does supersampling lose the maps.
TEST_F(FrameLamps, ListsAndCullingChangeNoBit) {
  std::vector<glm::dvec3> lamps;
  Rng rng(75);
  for (int i = 0; i < 12; ++i) lamps.push_back({rng.uniform(-6, 6), rng.uniform(0.3, 4), rng.uniform(-6, 4)});
  GltfBuilder b = floor_and_square();
  for (size_t i = 0; i < lamps.size(); ++i) add_lamp(b, lamps[i], i % 2 ? "spot" : "point", 0.9, 4.0);
  add_light(b, {{"type", "directional"}, {"intensity", 1.0}},
            {{"rotation", rotation_between({0, 0, -1}, {0.3, -1, 0.2})}});
  Job job = looking_down(write(b));
  const Images all = images_of(job);
  for (const char* technique : {"forward-plus", "brute-force"}) {
    Job other = job;
    other.technique = technique;
    EXPECT_EQ(images_of(other)["beauty"], all["beauty"]) << technique;
  }
  for (const auto& [table, knob, value] : {std::tuple{"cull", "enabled", "0"}, {"local", "draws", "9000"}}) {
    Job other = job;
    set(other, table, knob, value);
    EXPECT_EQ(images_of(other)["beauty"], all["beauty"]) << table << "." << knob;
  }
  Job bare = job, fine = job;
  bare.settings = {{"local", "lights", "0"}};
  EXPECT_NE(images_of(bare)["beauty"], all["beauty"]);
  EXPECT_EQ(images_of(bare)["shadow_local"].values<float>()[0], 1);
  fine.settings = {{"supersample", "n", "2"}};
  double differs = 0;
  const Images super = images_of(fine);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      differs += std::abs(super["beauty"].at<glm::vec4>(x, y).x - all["beauty"].at<glm::vec4>(x, y).x);
  EXPECT_LT(differs / (width * height), 0.5);
}

TEST_F(FrameLamps, NotesSayWhichLightsHaveNoShadowsAndWhichSmallerMaps) {
  Job job = looking_down(lit_by({{0, 3, 0}, {2, 3, 0}, {-2, 3, 0}}));
  EXPECT_EQ(note_of(job, "cast no shadows"), "");
  set(job, "local", "lights", "2");
  EXPECT_NE(note_of(job, "cast no shadows").find("1 of 3 point and spot lights"), std::string::npos);
  Job small = looking_down(lit_by({{0, 3, 0}, {2, 3, 0}, {-2, 3, 0}}));
  set(small, "local", "budget_mb", "1");
  EXPECT_NE(note_of(small, "smaller").find("local.budget_mb = 1"), std::string::npos);
  Job few = looking_down(lit_by({lamp}));
  set(few, "local", "draws", "1");
  const auto session = open(few);
  ASSERT_TRUE(session);
  const auto result = session->render(0);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("local.draws"), std::string::npos) << result.error().text();
}

// Those that the look marks have maps before all others, and alone with local.lights=marked.
TEST_F(FrameLamps, TheLookMarksLights) {
  GltfBuilder b = floor_and_square();
  add_lamp(b, {0, 3, 0}, "point");
  add_lamp(b, {0.4, 3, -1}, "point");
  b.json["nodes"].back()["name"] = "marked";
  Job job = looking_down(write(b));
  const std::string file = ::testing::TempDir() + "candela_marks.look.json";
  std::ofstream(file) << R"({"shadows": {"lights": ["marked", "nobody"]}})";
  const auto casts = [&](const std::string& lights, bool with_look) {
    Job one = job;
    set(one, "local", "lights", lights);
    if (with_look) one.look = file;
    return note_of(one, "cast no shadows");
  };
  const auto all = [](const std::string& note) { return note.find("nodes 2") != std::string::npos; };
  EXPECT_NE(casts("1", false).find("of the nodes 3"), std::string::npos) << casts("1", false);
  EXPECT_TRUE(all(casts("1", true))) << casts("1", true);
  EXPECT_TRUE(all(casts("marked", true))) << casts("marked", true);
  EXPECT_EQ(casts("2", true), "");
  Job marked = job, none = job;
  set(marked, "local", "lights", "marked"), set(none, "local", "lights", "none");
  EXPECT_EQ(images_of(marked)["beauty"], images_of(none)["beauty"]);
  marked.look = file;
  EXPECT_NE(note_of(marked, "'nobody'"), "");
  EXPECT_NE(images_of(marked)["shadow_local"], images_of(none)["shadow_local"]);
}

// A million metres away the same picture.
TEST_F(FrameLamps, FarFromTheOriginNothingChanges) {
  std::vector<Images> pictures;
  for (const double away : {0.0, 1048576.0}) {
    GltfBuilder b = floor_and_square({away, 0, -away});
    add_lamp(b, glm::dvec3(away, 3, -away), "point");
    Job job = looking_down(write(b));
    look(job, {away, 5, 6 - away}, {away, 0, -away}, 60);
    pictures.push_back(images_of(job));
  }
  size_t differing = 0;
  for (size_t i = 0; i < pictures[0]["shadow_local"].pixels(); ++i)
    differing += std::abs(pictures[0]["shadow_local"].values<float>()[i] -
                          pictures[1]["shadow_local"].values<float>()[i]) > 0.2f;
  EXPECT_LT(differing, 10u);
}

// Lamps and suns by rays in one shader, on a scene with many of both's casters: lavapipe also loads for lanes that have
// left the search, and such a look-up once left its table and ended the program (lib/trace.glsl).
TEST_F(FrameLamps, RaysOfSunsAndLampsInOneShader) {
  Job job = job_for(std::string(CANDELA_SOURCE_DIR) + "/scenes/street/street.glb", 40, 22, 1);
  job.settings = {
      {"local", "method", "traced"}, {"local", "samples", "1"}, {"sun", "mode", "traced"}, {"sun", "samples", "1"}};
  const auto mean = [](const Job& j) {
    const auto session = open(j);
    const Image beauty = images(render(*session))["beauty"];
    double sum = 0;
    for (const float v : beauty.values<float>()) sum += v / double(beauty.pixels());
    return sum;
  };
  const double a = mean(job);
  job.settings = {};
  const double b = mean(job);
  EXPECT_GT(a, 0);
  EXPECT_NEAR(a / b, 1, 0.1);  // of the same lights in the same places
}

}  // namespace candela::test::frame_lamps
