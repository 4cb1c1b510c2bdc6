// Ambient occlusion alone, over depths of analytic scenes, against the traced term in double.
#include "passes/occlusion/occlusion.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "passes_fixture.h"
#include "shared/scene.h"

namespace candela::gpu::test {
namespace {

using std::numbers::pi;
constexpr double near_m = 0.1;

struct Camera {
  int width = 96, height = 54;
  bool perspective = true;
  glm::dvec2 half{1.0, 0.5625};  // tangents, or metres
  glm::dvec3 origin(glm::dvec2 px) const { return perspective ? glm::dvec3(0) : glm::dvec3(across(px), 0); }
  glm::dvec3 direction(glm::dvec2 px) const {  // of length 1 along the view axis
    return perspective ? glm::dvec3(across(px), -1) : glm::dvec3(0, 0, -1);
  }
  glm::dvec2 across(glm::dvec2 px) const {
    const glm::dvec2 ndc = 2.0 * px / glm::dvec2(width, height) - 1.0;
    return glm::dvec2(ndc.x, -ndc.y) * half;
  }
};

// Points p with dot(normal, p) = offset, seen from the side the normal points to.
struct Plane {
  glm::dvec3 normal;
  double offset;
};
// The nearest of some planes along a ray: distance in lengths of the direction; infinity: none.
struct Met {
  double t = std::numeric_limits<double>::infinity();
  const Plane* plane = nullptr;
};
Met meet(const std::vector<Plane>& planes, glm::dvec3 origin, glm::dvec3 direction, const Plane* leaving = nullptr) {
  Met met;
  for (const Plane& plane : planes) {
    const double slope = glm::dot(plane.normal, direction);
    if (&plane == leaving || !(slope < 0)) continue;
    const double t = (plane.offset - glm::dot(plane.normal, origin)) / slope;
    if (t > 0 && t < met.t) met = {t, &plane};
  }
  return met;
}

class OcclusionTest : public PassTest {
 protected:
  struct Settings {
    int texel_px = 1, slices = 64, samples = 64, denoise = 0;
    Occlusion look{.radius_m = 1};
    uint32_t seed = 0;
  };
  // The texels that the pass gives: V and the point's distance.
  std::vector<glm::vec2> run_pass(const Camera& camera, const std::vector<float>& depths, const Settings& settings) {
    GraphBuilder builder;
    imports.clear();
    shared::FrameConstants constants{};
    constants.tan_half = camera.half;
    constants.size_px = {uint32_t(camera.width), uint32_t(camera.height)};
    constants.perspective = camera.perspective ? 1 : 0;
    // Orthographic: 1000 metres deep.
    constants.clip_from_relative = glm::mat4(0);
    constants.clip_from_relative[3][2] = camera.perspective ? float(near_m) : 1.0f;
    constants.clip_from_relative[2][2] = camera.perspective ? 0.0f : 1e-3f;
    std::vector<glm::vec4> texels;
    for (const float d : depths) texels.emplace_back(d, 0, 0, 0);
    const Buffer frame = upload(std::vector{constants}, "constants"), source = upload(texels, "depths");
    AmbientOcclusion pass;
    pass.knobs = {.texel_px = settings.texel_px,
                  .slices = settings.slices,
                  .samples = settings.samples,
                  .denoise = settings.denoise};
    AmbientOcclusion::In in;
    in.scene.constants = import(builder, frame, "constants");
    in.scene.width_px = uint32_t(camera.width), in.scene.height_px = uint32_t(camera.height);
    in.depth.image = make_image(builder, import(builder, source, "depths"), in.scene.width_px, in.scene.height_px);
    in.look = settings.look;
    in.seed = settings.seed;
    const AmbientOcclusion::Out out = add(builder, pass, in);
    const glm::uvec2 size = pass.texels(in.scene);
    const uint64_t bytes = uint64_t(size.x) * size.y * sizeof(glm::vec2);
    const BufferHandle open = add_readback(builder, "open", out.open, bytes);
    const FrameRun run = run_all(builder);
    return values_of<glm::vec2>(*run.readbacks.at(open.resource));
  }
  static std::vector<float> depths_of(const Camera& camera, const std::function<double(glm::dvec2)>& metres) {
    std::vector<float> depths;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double z = metres(glm::dvec2(x, y) + 0.5);
        depths.push_back(!std::isfinite(z) ? 0.0f : camera.perspective ? float(near_m / z) : float(1 - 1e-3 * z));
      }
    return depths;
  }
  static std::vector<float> depths_of(const Camera& camera, const std::vector<Plane>& planes) {
    return depths_of(camera, [&](glm::dvec2 px) { return meet(planes, camera.origin(px), camera.direction(px)).t; });
  }
  // V of what a pixel's centre shows, by quadrature over the hemisphere.
  static double truth(const Camera& camera, const std::vector<Plane>& planes, int x, int y, const Occlusion& look) {
    const glm::dvec2 px = glm::dvec2(x, y) + 0.5;
    const Met met = meet(planes, camera.origin(px), camera.direction(px));
    const glm::dvec3 p = camera.origin(px) + met.t * camera.direction(px), n = met.plane->normal;
    const glm::dvec3 a = glm::normalize(glm::cross(n, std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 b = glm::cross(n, a);
    constexpr int rings = 48, around = 192;
    double hidden = 0;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < around; ++j) {
        const double sine = std::sqrt((i + 0.5) / rings), phi = 2 * pi * (j + 0.5) / around;  // even in cosine
        const glm::dvec3 l = sine * (std::cos(phi) * a + std::sin(phi) * b) + std::sqrt(1 - sine * sine) * n;
        hidden += look.hidden(meet(planes, p, l, met.plane).t) / (rings * around);
      }
    return 1 - look.strength * hidden;
  }
  // A room's corner, as a depth buffer holds it: every side is seen, and nothing is behind anything.
  static std::vector<Plane> room() {
    return {
        {glm::normalize(glm::dvec3(0, 1, 0.3)), -2.4}, {{0, 0, 1}, -5}, {glm::normalize(glm::dvec3(-1, 0, 0.3)), -2.2}};
  }
  double room_error(const Camera& camera, const Settings& settings) {
    const std::vector<Plane> planes = room();
    const auto texels = run_pass(camera, depths_of(camera, planes), settings);
    const int side = settings.texel_px, across = (camera.width + side - 1) / side;
    const int coarser = camera.width / 96, stride = 7 * coarser;  // of the pixels that are compared
    double sum = 0;
    int count = 0;
    for (int y = 0; y < camera.height; y += side * coarser)
      for (int x = 0; x < camera.width; x += stride * side) {
        const int tx = x / side, ty = y / side;
        const glm::vec2 texel = texels[size_t(ty) * size_t(across) + size_t(tx)];
        const uint32_t name = std::bit_cast<uint32_t>(texel.y) & uint32_t(side * side - 1);
        // Beyond the picture's edge there is nothing.
        const double z = double(texel.y), r = settings.look.radius_m,
                     reach = camera.perspective ? r / std::sqrt(z * z - r * r) : r;
        const double border = reach * camera.width / (2 * camera.half.x);
        if (x < border || y < border || x > camera.width - border || y > camera.height - border) continue;
        const double d = double(texel.x) - truth(camera, planes, tx * side + int(name) % side,
                                                 ty * side + int(name) / side, settings.look);
        sum += d * d, ++count;
      }
    return std::sqrt(sum / count);
  }
};

// Where nothing rises over the plane V is 1, whatever its slope, the number of slices and the camera.
TEST_F(OcclusionTest, AFreePlaneIsWhollyOpen) {
  double least = 1;
  for (const bool perspective : {true, false})
    for (const double tilt : {0.0, 0.5, 1.0, 1.3, 1.5})
      for (const double turn : {0.0, 0.7, 2.0, 4.0}) {
        Camera camera;
        camera.perspective = perspective;
        const glm::dvec3 n(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
        const std::vector<Plane> plane = {{n, (perspective ? -4 : -20) * n.z}};
        for (const auto& [texel_px, slices, denoise] :
             {std::tuple(2, 3, 1), std::tuple(2, 1, 0), std::tuple(1, 4, 0)}) {
          Settings settings{texel_px, slices, 6, denoise};
          for (const glm::vec2 texel : run_pass(camera, depths_of(camera, plane), settings)) {
            if (!(texel.y > 0)) continue;
            least = std::min(least, double(texel.x));
            ASSERT_GT(texel.x, 0.995) << perspective << " " << tilt << " " << turn << " " << texel_px << " " << texel.y;
            ASSERT_LE(texel.x, 1.0);
          }
        }
      }
  RecordProperty("least", fmt::format("{}", least));
  fmt::print("least V of a free plane: {}\n", least);
}

// The exact end against quadrature of the same term. What is left is the height of a pixel: no depth tells of what is
// nearer than the next one, which counts most where the falloff begins at the point. So it shrinks with the pixels.
TEST_F(OcclusionTest, TheExactEndIsTheTracedTerm) {
  for (const bool perspective : {true, false})
    for (const Occlusion& look : {Occlusion{.radius_m = 1}, Occlusion{0.6, 1, 1}, Occlusion{1, 0.3, 0.5}}) {
      Camera camera;
      camera.perspective = perspective;
      if (!perspective) camera.half = {3, 3 * 0.5625};
      const double coarse = room_error(camera, {.look = look});
      camera.width *= 2, camera.height *= 2;
      const double fine = room_error(camera, {.samples = 128, .look = look});
      const std::string line = fmt::format("RMSE of V {:.5f}, with 4 times the pixels {:.5f} (radius {} falloff {})",
                                           coarse, fine, look.radius_m, look.falloff);
      fmt::print("{}\n", line);
      RecordProperty(fmt::format("{} {} {}", perspective ? "perspective" : "orthographic", look.radius_m, look.falloff),
                     line);
      EXPECT_LT(coarse, 0.015) << perspective << " " << look.radius_m;
      EXPECT_LT(fine, 0.65 * coarse) << perspective << " " << look.radius_m;
    }
}

TEST_F(OcclusionTest, EachKnobTendsToIt) {
  const Camera camera;
  const auto falls = [&](const char* what, const std::vector<Settings>& walk) {
    std::vector<double> errors;
    for (const Settings& s : walk) errors.push_back(room_error(camera, s));
    fmt::print("{}: {}\n", what, fmt::join(errors, " "));
    for (size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1] * 1.02) << what << " " << i;
    EXPECT_LT(errors.back(), 0.7 * errors.front()) << what;
  };
  falls("slices", {{1, 1, 64}, {1, 2, 64}, {1, 4, 64}, {1, 16, 64}, {1, 64, 64}});
  falls("samples", {{1, 64, 1}, {1, 64, 2}, {1, 64, 4}, {1, 64, 16}, {1, 64, 64}});
}

// Whatever the depths, the radius and the size: numbers from 0 to 1.
TEST_F(OcclusionTest, IsANumberWhateverTheDepths) {
  Rng rng(5);
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 9), std::pair(33, 17), std::pair(64, 2)})
    for (const double radius : {1e-3, 1.0, 1e4})
      for (int kind = 0; kind < 5; ++kind) {
        Camera camera{width, height, kind != 4};
        const auto depths = depths_of(camera, [&](glm::dvec2) {
          return kind == 0   ? std::numeric_limits<double>::infinity()
                 : kind == 1 ? 3.0
                 : kind == 2 ? std::exp2(rng.uniform(-3, 40))
                 : kind == 3 ? (rng.uniform() < 0.5 ? 2.0 : std::numeric_limits<double>::infinity())
                             : rng.uniform(0, 999);
        });
        for (const auto& [texel_px, denoise] : {std::pair(2, 1), std::pair(1, 0), std::pair(4, 1)}) {
          Settings settings{texel_px, 3, 6, denoise, {.radius_m = radius, .falloff = kind == 2 ? 0.0 : 0.6}, 77};
          for (const glm::vec2 texel : run_pass(camera, depths, settings)) {
            ASSERT_TRUE(texel.x >= 0 && texel.x <= 1) << kind << " " << radius << " " << texel.x;
            ASSERT_TRUE(std::isfinite(texel.y) && texel.y >= 0);
            if (kind == 0) ASSERT_EQ(texel, glm::vec2(1, 0));
            if (kind == 1 && camera.perspective) ASSERT_GT(texel.x, 0.999f);
          }
        }
      }
}

}  // namespace
}  // namespace candela::gpu::test
