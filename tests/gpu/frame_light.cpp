#include <numbers>

#include "frame_fixture.h"
#include "reference/albedo.h"

namespace candela::test::frame_light {
namespace {

using std::numbers::pi;
constexpr int width = 80, height = 60;
const glm::dvec3 albedo(0.8, 0.4, 0.2);

// The point of the plane z = 0 that the centre of a pixel sees from `eye` along -Z.
glm::dvec3 seen(glm::dvec3 eye, double yfov_deg, int x, int y) {
  const double tan_y = std::tan(yfov_deg * pi / 360), tan_x = tan_y * width / height;
  return {eye.x + eye.z * tan_x * (2 * (x + 0.5) / width - 1), eye.y - eye.z * tan_y * (2 * (y + 0.5) / height - 1), 0};
}

// KHR_lights_punctual without its cone: intensity over squared distance, windowed by the range, on a diffuse plane that
// faces +Z.
double diffuse_factor(glm::dvec3 light, double range_m, glm::dvec3 point) {
  const glm::dvec3 to_light = light - point;
  const double d2 = glm::dot(to_light, to_light), cosine = std::max(to_light.z / std::sqrt(d2), 0.0);
  const double window = std::isfinite(range_m) ? std::clamp(1 - std::pow(d2 / (range_m * range_m), 2), 0.0, 1.0) : 1;
  return window / d2 * cosine / pi;
}

}  // namespace

class FrameLight : public FrameTest {
 protected:
  static constexpr double yfov_deg = 50;
  const glm::dvec3 eye{0.25, -0.5, 4};

  // The square is not much larger than what is seen: interpolated positions err in proportion to its corners.
  Images lit_plane(const Json& light, const Json& node) {
    GltfBuilder b = empty_scene();
    const int material = add_material(b, diffuse_material(albedo.x, albedo.y, albedo.z));
    add_node(b, {{"mesh", add_square_mesh(b, 4, material)}});
    add_light(b, light, node);
    Job job = job_for(write(b), width, height);
    job.layers = {"direct"};
    job.settings = {{"lights", "floor_lux", "0"}};  // no range of ours
    look(job, eye, eye - glm::dvec3(0, 0, 1), yfov_deg);
    return images_of(job);
  }
  // Every pixel against radiance(point), to 1e-5 of `scale(point)`; where radiance is 0, exactly.
  template <class F, class G>
  void expect_radiance(const Images& images, F&& radiance, G&& scale) {
    size_t dark = 0, lit = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const glm::dvec3 point = seen(eye, yfov_deg, x, y);
        const glm::vec4 p = images["beauty"].at<glm::vec4>(x, y);
        const glm::vec4 direct = images["direct"].at<glm::vec4>(x, y);
        const double expected = radiance(point);
        for (int c = 0; c < 3; ++c) {
          if (expected == 0) {
            EXPECT_EQ(p[c], 0.0f) << x << " " << y;
          } else {
            EXPECT_NEAR(p[c], expected * albedo[c], 1e-5 * scale(point) * albedo[c]) << x << " " << y;
          }
          EXPECT_EQ(p[c], direct[c]);
        }
        EXPECT_EQ(p.w, 1.0f);
        (expected == 0 ? dark : lit)++;
        if (HasFailure()) return;
      }
    dark_pixels = dark, lit_pixels = lit;
  }
  size_t dark_pixels = 0, lit_pixels = 0;
};

TEST_F(FrameLight, APointLightFallsWithTheSquareOfItsDistance) {
  const glm::dvec3 at(0.5, -0.25, 0.75);
  const double range_m = std::numeric_limits<double>::infinity();
  const Images images =
      lit_plane({{"type", "point"}, {"intensity", 40.0}, {"color", {1, 1, 1}}}, {{"translation", {at.x, at.y, at.z}}});
  const auto expected = [&](glm::dvec3 p) { return 40 * diffuse_factor(at, range_m, p); };
  expect_radiance(images, expected, expected);
}

// Near the cutoff the window is a difference of nearly equal numbers, so there the bound is relative to the radiance
// without the window.
TEST_F(FrameLight, ThePointLightEndsAtItsRangeExactly) {
  const glm::dvec3 at(0, 0, 0.5);
  const Images images =
      lit_plane({{"type", "point"}, {"intensity", 10.0}, {"range", 1.5}}, {{"translation", {at.x, at.y, at.z}}});
  expect_radiance(
      images, [&](glm::dvec3 p) { return 10 * diffuse_factor(at, 1.5, p); },
      [&](glm::dvec3 p) { return 10 * diffuse_factor(at, std::numeric_limits<double>::infinity(), p); });
  EXPECT_GT(dark_pixels, 500u);
  EXPECT_GT(lit_pixels, 500u);
}

// A light that stands in the plane, or behind it, gives nothing.
TEST_F(FrameLight, LightFromBehindIsExactlyZero) {
  const Images images = lit_plane({{"type", "point"}, {"intensity", 10.0}}, {{"translation", {0.1, 0.2, -1.0}}});
  expect_radiance(
      images, [](glm::dvec3) { return 0.0; }, [](glm::dvec3) { return 0.0; });
}

TEST_F(FrameLight, ADirectionalLightIsTheSameEverywhere) {
  // Turned by 40 degrees about X: shines along -Z of its node.
  const double half = 20 * pi / 180;
  const Images images =
      lit_plane({{"type", "directional"}, {"intensity", 3.0}}, {{"rotation", {std::sin(half), 0, 0, std::cos(half)}}});
  const auto expected = [&](glm::dvec3) { return 3 * std::cos(2 * half) / pi; };
  expect_radiance(images, expected, expected);
}

TEST_F(FrameLight, ASpotLightFadesBetweenItsCones) {
  const glm::dvec3 at(0.25, -0.5, 2);
  const double inner = 0.3, outer = 0.6;
  const double half = 10 * pi / 180;  // tilted about Y
  const glm::dvec3 direction(-std::sin(2 * half), 0, -std::cos(2 * half));
  const Images images = lit_plane(
      {{"type", "spot"}, {"intensity", 25.0}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}},
      {{"translation", {at.x, at.y, at.z}}, {"rotation", {0, std::sin(half), 0, std::cos(half)}}});
  size_t full = 0, penumbra = 0;
  const double range_m = std::numeric_limits<double>::infinity();
  const auto cone = [&](glm::dvec3 p) {
    const double cosine = glm::dot(glm::normalize(p - at), direction);
    return std::clamp((cosine - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
  };
  expect_radiance(
      images,
      [&](glm::dvec3 p) {
        const double c = cone(p);
        full += c == 1, penumbra += c > 0 && c < 1;
        return 25 * diffuse_factor(at, range_m, p) * c * c;
      },
      [&](glm::dvec3 p) { return 25 * diffuse_factor(at, range_m, p); });
  EXPECT_GT(full, 100u);
  EXPECT_GT(penumbra, 100u);
  EXPECT_GT(dark_pixels, 100u);
}

// The whole BRDF in double, of a rough metal and of a dielectric with its specular lobe, from glTF 2.0 appendix B.
class FrameBrdf : public FrameLight, public ::testing::WithParamInterface<std::pair<double, double>> {};

TEST_P(FrameBrdf, AgreesWithDoublePrecision) {
  const auto [metallic, roughness] = GetParam();
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json pbr = base_color(albedo.x, albedo.y, albedo.z);
  pbr["metallicFactor"] = metallic;
  pbr["roughnessFactor"] = roughness;
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, {{"pbrMetallicRoughness", pbr}}))}});
  const glm::dvec3 at(-2, 0.25, 0.75);
  add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {at.x, at.y, at.z}}});
  Job job = job_for(write(b), width, height);
  job.settings = {{"lights", "floor_lux", "0"}};  // no range of ours: it would take (0.01 lux/E)^2 of the light away
  const glm::dvec3 n(0, 0, 1), low_eye(2.5, -0.5, 1);  // grazing: the Fresnel term counts
  look(job, low_eye, glm::dvec3(0), yfov_deg);
  const Images images = images_of(job);
  const glm::dvec3 back = glm::normalize(low_eye), right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back)),
                   up = glm::cross(back, right);
  const double tan_y = std::tan(yfov_deg * pi / 360), tan_x = tan_y * width / height;
  size_t compared = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 ray =
          tan_x * (2 * (x + 0.5) / width - 1) * right - tan_y * (2 * (y + 0.5) / height - 1) * up - back;
      const glm::dvec3 point = low_eye - ray * (low_eye.z / ray.z);
      if (ray.z > -0.05 || std::max(std::abs(point.x), std::abs(point.y)) > 3.9) continue;
      const glm::dvec3 v = glm::normalize(low_eye - point), to_light = at - point;
      const glm::dvec3 l = glm::normalize(to_light), h = glm::normalize(l + v);
      const double nl = glm::dot(n, l), nv = glm::dot(n, v), nh = glm::dot(n, h), vh = glm::dot(v, h);
      const double a2 = std::pow(roughness, 4);
      const double d = a2 / (pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
      const double visibility =
          0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
      const double grazing = std::pow(1 - vh, 5);
      const glm::vec4 p = images["beauty"].at<glm::vec4>(x, y);
      for (int c = 0; c < 3; ++c) {
        const double fresnel = 0.04 + 0.96 * grazing, metal = albedo[c] + (1 - albedo[c]) * grazing;
        const double f0 = metallic * albedo[c] + (1 - metallic) * 0.04;
        const double specular = reference::specular_gain(glm::dvec3(f0), roughness, nv).x * d * visibility;
        const double dielectric = (1 - fresnel) * albedo[c] / pi + fresnel * specular;
        const double brdf = (1 - metallic) * dielectric + metallic * metal * specular;
        const double expected = 20 / glm::dot(to_light, to_light) * nl * brdf;
        EXPECT_NEAR(p[c], expected, 2e-5 * expected) << x << " " << y;
      }
      ++compared;
      if (HasFailure()) return;
    }
  EXPECT_GT(compared, 1500u);
}
INSTANTIATE_TEST_SUITE_P(Materials, FrameBrdf,
                         ::testing::Values(std::pair(0.0, 1.0), std::pair(0.0, 0.5), std::pair(1.0, 0.5),
                                           std::pair(0.5, 0.3)));

}  // namespace candela::test::frame_light
