#include <numbers>

#include "base/rng.h"
#include "frame_fixture.h"

// Light of many lamps, and of one that nearly touches, on a diffuse plane: against the sum in double.
namespace candela::test::frame_light_sums {
namespace {

using std::numbers::pi;
constexpr int width = 96, height = 72;
constexpr double yfov_deg = 50;
const glm::dvec3 albedo(0.8, 0.4, 0.2);

// The point of the plane z = 0 that the centre of a pixel sees from `eye` along -Z.
glm::dvec3 seen(glm::dvec3 eye, int x, int y) {
  const double tan_y = std::tan(yfov_deg * pi / 360), tan_x = tan_y * width / height;
  return {eye.x + eye.z * tan_x * (2 * (x + 0.5) / width - 1), eye.y - eye.z * tan_y * (2 * (y + 0.5) / height - 1), 0};
}

// Of one candela, per unit of albedo, with KHR_lights_punctual's range.
double lit_by(glm::dvec3 light, double range_m, glm::dvec3 point) {
  const glm::dvec3 to_light = light - point;
  const double d2 = glm::dot(to_light, to_light);
  const double window = std::clamp(1 - std::pow(d2 / (range_m * range_m), 2), 0.0, 1.0);
  return window / d2 * to_light.z / std::sqrt(d2) / pi;
}

}  // namespace

class FrameLightSums : public FrameTest {
 protected:
  static GltfBuilder plane() {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(albedo.x, albedo.y, albedo.z)))}});
    return b;
  }
};

// Every one of some thousand lamps arrives: each stands alone over its own spot of the plane.
TEST_F(FrameLightSums, NoneOfAThousandLampsIsLost) {
  GltfBuilder b = plane();
  const glm::dvec3 eye(0.1, -0.2, 4);
  constexpr double range_m = 0.2;
  std::vector<glm::dvec3> lamps;
  Rng rng(3);
  for (int y = 0; y < 33; ++y)
    for (int x = 0; x < 40; ++x)
      lamps.push_back({eye.x - 2 + 0.1 * x + 0.02 * rng.uniform(), eye.y - 1.6 + 0.1 * y + 0.02 * rng.uniform(), 0.1});
  for (const glm::dvec3& l : lamps)
    add_light(b, {{"type", "point"}, {"intensity", 1.0}, {"range", range_m}}, {{"translation", {l.x, l.y, l.z}}});
  ASSERT_GT(lamps.size(), 1000u);
  Job job = job_for(write(b), width, height);
  look(job, eye, eye - glm::dvec3(0, 0, 1), yfov_deg);
  const Images images = images_of(job);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 point = seen(eye, x, y);
      double expected = 0;
      for (const glm::dvec3& l : lamps) expected += lit_by(l, range_m, point);
      // Near a range's end the window is a difference of nearly equal numbers.
      ASSERT_NEAR(images["beauty"].at<glm::vec4>(x, y).x, expected * albedo.x, 1e-4 * expected * albedo.x + 1e-3)
          << x << " " << y;
    }
}

// The inverse square holds down to a centimetre.
TEST_F(FrameLightSums, ALampCloseToTheSurface) {
  GltfBuilder b = plane();
  const glm::dvec3 eye(0.02, -0.03, 0.2), at(0.01, -0.02, 0.02);
  add_light(b, {{"type", "point"}, {"intensity", 1.0}, {"range", 1.0}}, {{"translation", {at.x, at.y, at.z}}});
  Job job = job_for(write(b), width, height);
  look(job, eye, eye - glm::dvec3(0, 0, 1), yfov_deg);
  const Images images = images_of(job);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double expected = lit_by(at, 1, seen(eye, x, y)) * albedo.x;
      ASSERT_NEAR(images["beauty"].at<glm::vec4>(x, y).x, expected, 1e-3 * expected) << x << " " << y;
    }
}

// Layers of light are exposed as beauty is.
TEST_F(FrameLightSums, ExposureScalesTheDirectLayerToo) {
  GltfBuilder b = plane();
  add_light(b, {{"type", "point"}, {"intensity", 3.0}}, {{"translation", {0, 0, 1}}});
  Job job = job_for(write(b), 16, 12);
  job.layers = {"direct"};
  job.settings = {{"lights", "floor_lux", "0"}};  // where lights end depends on the exposure
  look(job, {0, 0, 3}, {0, 0, 0}, yfov_deg);
  const auto plain = images_of(job)["direct"].values<glm::vec4>();
  job.exposure_ev = 2;
  const auto brighter = images_of(job)["direct"].values<glm::vec4>();
  for (size_t i = 0; i < plain.size(); ++i) {
    EXPECT_GT(plain[i].x, 0.0f);
    EXPECT_EQ(glm::vec3(plain[i]) * 4.0f, glm::vec3(brighter[i]));
  }
}

// A white metal mirrors a sky that is linear in the direction: whatever share it reflects, the channels' ratios are
// those of the mirrored direction, not of the normal's.
TEST_F(FrameLightSums, AmbientReflectionsComeFromTheMirroredDirection) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json pbr = base_color(1, 1, 1);
  pbr["metallicFactor"] = 1, pbr["roughnessFactor"] = 0.3;
  const double angle = 0.5;
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, {{"pbrMetallicRoughness", pbr}}))},
               {"rotation", {0, std::sin(angle / 2), 0, std::cos(angle / 2)}}});
  Job job = job_for(write(b), 16, 16);
  look(job, {0, 0, 100}, {0, 0, 0}, 0.5);  // as good as parallel
  // The neutral light: brighter above, where nothing else lights a scene. Its gradient is along +Y alone.
  const glm::vec4 level = images_of(job)["beauty"].at<glm::vec4>(8, 8);
  look(job, {0, 0.8 * 100, 0.6 * 100}, {0, 0, 0}, 0.5);
  const glm::vec4 steep = images_of(job)["beauty"].at<glm::vec4>(8, 8);
  // A radiance of 0.45 + 0.25 y, convolved: 0.45 + y/6. Seen level, the plane mirrors the horizon; from above, with the
  // normal (sin a, 0, cos a), the direction (2 n.v n - v).y = -0.8.
  EXPECT_NEAR(level.x, level.z, 1e-6);
  const double below = 0.45 - 0.8 / 6, horizon = 0.45;
  EXPECT_LT(steep.x / level.x, 1.1 * below / horizon) << "the fraction reflected grows little at this angle";
}

}  // namespace candela::test::frame_light_sums
