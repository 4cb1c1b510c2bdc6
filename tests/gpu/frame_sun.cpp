#include "../unit/reference_fixture.h"
#include "base/rng.h"
#include "frame_fixture.h"

// Shadows of directional lights in whole frames.
namespace candela::test::frame_sun {
namespace {

constexpr int width = 96, height = 64;
// The sun stands above and behind the camera's left shoulder.
const glm::dvec3 shines = glm::normalize(glm::dvec3(0.5, -1, -0.7));

}  // namespace

class FrameSun : public FrameTest {
 protected:
  // A floor of half size 20 at y = 0 and squares of half size 0.5 that lie above it at `places`.
  static std::string floor_and_squares(const std::vector<glm::dvec3>& places, int suns = 1, Json square_material = {}) {
    GltfBuilder b = empty_scene();
    const int floor = add_square_mesh(b, 20, add_material(b, diffuse_material(0.8, 0.8, 0.8)));
    const int square = add_square_mesh(
        b, 0.5f, add_material(b, square_material.is_null() ? diffuse_material(0.5, 0.2, 0.1) : square_material));
    const Json lying = rotation_between({0, 0, 1}, {0, 1, 0});
    add_node(b, {{"mesh", floor}, {"rotation", lying}});
    for (const glm::dvec3 p : places)
      add_node(b, {{"mesh", square}, {"rotation", lying}, {"translation", {p.x, p.y, p.z}}});
    for (int i = 0; i < suns; ++i)
      add_light(b, {{"type", "directional"}, {"intensity", 3.0 - 0.1 * i}},
                {{"rotation", rotation_between({0, 0, -1}, shines + 0.3 * i)}});
    return write(b);
  }
  static Job looking_down(const std::string& path) {
    Job job = job_for(path, width, height, 4);
    look(job, {0, 5, 6}, {0, 0, 0}, 60);
    job.layers = {"shadow_sun", "debug_cascades"};
    return job;
  }
  static void set(Job& job, const std::string& table, const std::string& knob, const std::string& value) {
    job.settings.push_back({table, knob, value});
  }
  static std::vector<glm::dvec3> scattered() {
    Rng rng(51);
    std::vector<glm::dvec3> places;
    for (int i = 0; i < 120; ++i) places.push_back({rng.uniform(-18, 18), rng.uniform(0.2, 6), rng.uniform(-18, 5)});
    return places;
  }
};

// A square a metre above the floor: its shadow is the square moved along the light, for a quarter of a texel.
TEST_F(FrameSun, AShadowLiesWhereTheLightCarriesIt) {
  const glm::dvec3 centre(0, 1, 0), moved = centre + shines / -shines.y;
  constexpr int columns = 2 * width, rows = 2 * height;
  Job job = looking_down(floor_and_squares({centre}));
  job.width_px = columns, job.height_px = rows;
  const Images images = images_of(job);
  const glm::dvec3 eye(0, 5, 6), forward = glm::normalize(-eye), right(1, 0, 0), up = glm::cross(right, forward);
  const double tan_y = std::tan(30 * 3.14159265358979 / 180), tan_x = tan_y * columns / rows;
  int dark = 0, lit = 0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const glm::dvec3 ray =
          forward + right * (tan_x * (2 * (x + 0.5) / columns - 1)) - up * (tan_y * (2 * (y + 0.5) / rows - 1));
      if (ray.y > -0.1) continue;
      const glm::dvec3 at = eye + ray * (-eye.y / ray.y), over = eye + ray * ((1 - eye.y) / ray.y);
      if (std::max(std::abs(over.x - centre.x), std::abs(over.z - centre.z)) < 0.6) continue;  // hidden by the square
      if (std::max(std::abs(at.x), std::abs(at.z)) > 19.9) continue;
      const double off = std::max(std::abs(at.x - moved.x), std::abs(at.z - moved.z));
      const float visibility = images["shadow_sun"].at<float>(x, y);
      if (off < 0.47) {
        EXPECT_EQ(visibility, 0) << x << "," << y;
        ++dark;
      }
      if (off > 0.53) {
        EXPECT_EQ(visibility, 1) << x << "," << y;
        ++lit;
      }
    }
  EXPECT_GT(dark, 20);
  EXPECT_GT(lit, 1000);
}

// A convex body does not darken itself, with several samples a pixel either, where a pixel on an edge is shaded at the
// centroid of the samples that a triangle covers.
TEST_F(FrameSun, ABallCastsNoShadowOnItsLitSide) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", reference::test::add_sphere_mesh(b, 1, add_material(b, diffuse_material(0.8, 0.8, 0.8)), 24)}});
  add_light(b, {{"type", "directional"}, {"intensity", 3.0}}, {{"rotation", rotation_between({0, 0, -1}, shines)}});
  for (const int samples : {1, 4}) {
    Job job = job_for(write(b), width, height, samples);
    look(job, {0, 1, 4}, {0, 0, 0}, 30);
    const Image shadowed = images_of(job)["beauty"];
    job.effects = "none";
    const Image bare = images_of(job)["beauty"];
    int facing = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const float expected = bare.at<glm::vec4>(x, y).x;
        if (expected < 0.2f) continue;  // near the terminator facets turn away from the sun
        ++facing;
        EXPECT_NEAR(shadowed.at<glm::vec4>(x, y).x, expected, 0.01f * expected) << samples << ": " << x << "," << y;
      }
    EXPECT_GT(facing, 500);
  }
}

TEST_F(FrameSun, WithoutShadowsTheFrameIsTheBareOne) {
  const std::string path = floor_and_squares(scattered());
  Job shadowed = looking_down(path), off = shadowed, none = shadowed;
  shadowed.layers = off.layers = none.layers = {};
  set(off, "sun", "mode", "off");
  none.effects = "none";
  const Images with = images_of(shadowed), without = images_of(off), bare = images_of(none);
  EXPECT_EQ(without["beauty"], bare["beauty"]);
  EXPECT_NE(with["beauty"], bare["beauty"]);
  const auto plan = open(none);
  ASSERT_TRUE(plan);
}

// Rule A and culling change time and no bit; so does the room for draw commands.
TEST_F(FrameSun, WhatIsLeftOutOfACascadeIsNotMissed) {
  Job job = looking_down(floor_and_squares(scattered()));
  set(job, "sun", "least_texels", "0");
  const Images all = images_of(job);
  for (const auto& [table, knob, value] :
       {std::tuple{"sun", "skip_served", "0"}, {"cull", "enabled", "0"}, {"sun", "draws", "700"}}) {
    Job other = job;
    set(other, table, knob, value);
    const Images images = images_of(other);
    EXPECT_EQ(images["beauty"], all["beauty"]) << table << "." << knob;
    EXPECT_EQ(images["shadow_sun"], all["shadow_sun"]) << table << "." << knob;
  }
  const auto cascades = all["debug_cascades"].values<float>();
  for (const float wanted : {1.0f, 2.0f, 3.0f})
    EXPECT_GT(std::count(cascades.begin(), cascades.end(), wanted), 50) << "the view takes several";
}

TEST_F(FrameSun, MoreDrawsThanThereIsRoomForAreAnError) {
  Job job = looking_down(floor_and_squares(scattered()));
  set(job, "sun", "draws", "100");
  const auto session = open(job);
  ASSERT_TRUE(session);
  const auto result = session->render(0);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::usage);
  EXPECT_NE(result.error().message.find("sun.draws"), std::string::npos) << result.error().text();
}

TEST_F(FrameSun, MaskedSurfacesCastTheirMaskAndBlendedOnesNothing) {
  Json masked = unlit_material(1, 1, 1, 0.25), blended = masked;
  masked["alphaMode"] = "MASK";
  masked["alphaCutoff"] = 0.5;
  blended["alphaMode"] = "BLEND";
  for (const Json& material : {masked, blended}) {
    const auto values =
        images_of(looking_down(floor_and_squares({{0, 1, 0}}, 1, material)))["shadow_sun"].values<float>();
    EXPECT_EQ(*std::min_element(values.begin(), values.end()), 1) << material.dump();
  }
  masked["alphaCutoff"] = 0.2;
  const auto values = images_of(looking_down(floor_and_squares({{0, 1, 0}}, 1, masked)))["shadow_sun"].values<float>();
  EXPECT_GT(std::count(values.begin(), values.end(), 0.0f), 20);
}

TEST_F(FrameSun, TheBrightestLightsHaveShadowsAndANoteNamesTheOthers) {
  Job job = looking_down(floor_and_squares({{0, 1, 0}}, 3));
  set(job, "sun", "lights", "2");
  const auto session = open(job);
  ASSERT_TRUE(session);
  const FrameResult result = render(*session);
  const auto named = std::find_if(result.notes.begin(), result.notes.end(), [](const std::string& note) {
    return note.find("1 of 3 directional lights cast no shadows") != std::string::npos;
  });
  EXPECT_NE(named, result.notes.end());
}

// One map for all of the scene, and cascades of a tenth of the size: the shadow is where it was.
TEST_F(FrameSun, ASingleMapAgreesWithCascades) {
  Job job = looking_down(floor_and_squares({{0, 1, 0}, {-3, 0.5, 1}})), single = job;
  set(single, "sun", "mode", "single");
  const Images a = images_of(job), b = images_of(single);
  size_t differing = 0;
  for (size_t i = 0; i < a["shadow_sun"].pixels(); ++i)
    differing += std::abs(a["shadow_sun"].values<float>()[i] - b["shadow_sun"].values<float>()[i]) > 0.5f;
  EXPECT_LT(differing, a["shadow_sun"].pixels() / 100);
}

// A million metres away the same picture: nothing is placed in float before it is relative to the camera.
TEST_F(FrameSun, FarFromTheOriginNothingChanges) {
  std::vector<Images> pictures;
  for (const double away : {0.0, 1048576.0}) {
    GltfBuilder b = empty_scene();
    const int floor = add_square_mesh(b, 20, add_material(b, diffuse_material(0.8, 0.8, 0.8)));
    const int square = add_square_mesh(b, 0.5f, add_material(b, diffuse_material(0.5, 0.2, 0.1)));
    const Json lying = rotation_between({0, 0, 1}, {0, 1, 0});
    add_node(b, {{"mesh", floor}, {"rotation", lying}, {"translation", {away, 0, -away}}});
    add_node(b, {{"mesh", square}, {"rotation", lying}, {"translation", {away, 1, -away}}});
    add_light(b, {{"type", "directional"}}, {{"rotation", rotation_between({0, 0, -1}, shines)}});
    Job job = looking_down(write(b));
    look(job, {away, 5, 6 - away}, {away, 0, -away}, 60);
    pictures.push_back(images_of(job));
  }
  size_t differing = 0;
  for (size_t i = 0; i < pictures[0]["shadow_sun"].pixels(); ++i)
    differing +=
        std::abs(pictures[0]["shadow_sun"].values<float>()[i] - pictures[1]["shadow_sun"].values<float>()[i]) > 0.2f;
  EXPECT_LT(differing, 10u) << "the grid of texels lies elsewhere, the shadow does not";
}

}  // namespace candela::test::frame_sun
