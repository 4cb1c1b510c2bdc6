#include "passes_fixture.h"
#include "shared/scene.h"

// What the G-buffer's formats do to each channel, against the steps of their bits: bounds that hold on every device.
namespace candela::gpu::test {
namespace gbuffer_formats {

struct Point {
  glm::vec3 position, normal, base, f0, emission;
  float roughness, metallic, occlusion, f90, unlit;
};
static_assert(sizeof(Point) == 80);

double srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }
double degrees_between(glm::dvec3 a, glm::dvec3 b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

// Largest differences of each channel.
struct Off {
  double depth = 0;     // share of the distance along the view axis
  double place_px = 0;  // across the picture
  double normal_deg = 0;
  double base = 0, diffuse = 0, specular = 0;  // as sRGB codes, 0 to 1
  double f0 = 0;                               // its root
  double emission = 0;                         // share of its largest channel
  double roughness = 0, exponent = 0, metallic = 0, occlusion = 0;
};

class GBufferFormats : public PassTest {
 protected:
  static constexpr double tangent = 0.5;
  static constexpr double width = 128, height = 64;
  static std::vector<Point> some_points() {
    Rng rng(3);
    std::vector<Point> points;
    const auto color = [&] { return glm::vec3(rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(0, 1)); };
    for (int i = 0; i < 4096; ++i) {
      Point p;
      const double depth = std::exp(rng.uniform(std::log(0.2), std::log(200.0)));
      p.position = glm::dvec3(rng.uniform(-0.99, 0.99) * 2 * tangent, rng.uniform(-0.99, 0.99) * tangent, -1) * depth;
      const double z = rng.uniform(-1, 1), turn = rng.uniform(0, 6.2831853);
      p.normal = glm::dvec3(std::sqrt(1 - z * z) * glm::dvec2(std::cos(turn), std::sin(turn)), z);
      p.base = color();
      p.f0 = glm::vec3(float(rng.uniform(0, 0.2)));
      p.emission = color() * float(std::exp(rng.uniform(-6, 6)));
      p.roughness = float(rng.uniform(0.1, 1));
      p.metallic = i % 2 == 0 ? 0 : 1;
      p.occlusion = float(rng.uniform(0, 1));
      p.f90 = 1;
      p.unlit = i % 16 == 0;
      points.push_back(p);
    }
    return points;
  }
  std::vector<Point> back(const std::string& definitions, const std::vector<Point>& points) {
    shared::FrameConstants frame{};
    frame.camera_right = {1, 0, 0}, frame.camera_up = {0, 1, 0}, frame.camera_back = {0, 0, 1};
    frame.tan_half = {2 * tangent, tangent};
    frame.size_px = {uint32_t(width), uint32_t(height)};
    frame.perspective = 1;
    frame.pre_exposure = 0.25f;
    const Buffer constants = upload(std::vector{frame}, "constants"), source = upload(points, "points");
    GraphBuilder builder;
    const BufferHandle uniform = import(builder, constants, "constants"), from = import(builder, source, "points");
    builder.begin_pass("gbuffer formats");
    builder.read(uniform, Access::uniform_read, "constants");
    builder.read(from, Access::compute_read, "points");
    BufferHandle to = builder.create(
        BufferDesc{.name = "back", .size_bytes = points.size() * sizeof(Point), .memory = BufferMemory::host_read});
    to = builder.write(to, Access::compute_write);
    const PipelineHandle pipeline =
        builder.pipeline(ComputePipelineDesc{.shader = "gbuffer_formats.comp" + definitions});
    builder.end_pass([=, count = uint32_t(points.size())](CommandList& commands) {
      struct {
        uint64_t from, to;
        uint32_t count, unused = 0;
        glm::vec2 subsample_ndc{0};
        float subsample_footprint = 0, padding = 0;
        uint64_t deformed = 0, lights = 0;
      } push{commands.address(from), commands.address(to), count};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(count);
    });
    builder.sink(to);
    const FrameRun result = run_all(builder);
    if (!result.readbacks.contains(to.resource)) return {};
    return values_of<Point>(*result.readbacks.at(to.resource));
  }
  Off off(const std::string& definitions) {
    const std::vector<Point> points = some_points(), stored = back(definitions, points);
    EXPECT_EQ(stored.size(), points.size());
    Off most;
    const auto raise = [](double& value, double to) { value = std::max(value, std::abs(to)); };
    for (size_t i = 0; i < stored.size(); ++i) {
      const Point &a = points[i], &b = stored[i];
      EXPECT_EQ(a.unlit, b.unlit);
      const double za = -double(a.position.z), zb = -double(b.position.z);
      raise(most.depth, (zb - za) / za);
      for (int c = 0; c < 2; ++c)
        raise(most.place_px, (double(b.position[c]) / zb - double(a.position[c]) / za) * height / (2 * tangent));
      raise(most.normal_deg, degrees_between(a.normal, b.normal));
      const double emitted = std::max({a.emission.x, a.emission.y, a.emission.z});
      for (int c = 0; c < 3; ++c) {
        raise(most.emission, (double(b.emission[c]) - double(a.emission[c])) / emitted);
        if (a.unlit != 0) continue;
        raise(most.base, srgb(b.base[c]) - srgb(a.base[c]));
        raise(most.diffuse, srgb(b.base[c] * (1 - b.metallic)) - srgb(a.base[c] * (1 - a.metallic)));
        raise(most.specular,
              srgb(glm::mix(b.f0[c], b.base[c], b.metallic)) - srgb(glm::mix(a.f0[c], a.base[c], a.metallic)));
        raise(most.f0, std::sqrt(double(b.f0[c])) - std::sqrt(double(a.f0[c])));
      }
      raise(most.roughness, b.roughness - a.roughness);
      raise(most.exponent, 2 / std::pow(double(b.roughness), 4) - 2 / std::pow(double(a.roughness), 4));
      raise(most.metallic, b.metallic - a.metallic);
      raise(most.occlusion, b.occlusion - a.occlusion);
    }
    fmt::print(
        "{}: depth {:.1e}, place {:.4f} px, normal {:.4f} degrees, base {:.5f}, f0 {:.5f}, emission {:.5f}, "
        "roughness {:.5f}, occlusion {:.5f}\n",
        definitions, most.depth, most.place_px, most.normal_deg, most.base, most.f0, most.emission, most.roughness,
        most.occlusion);
    return most;
  }
};

// Half a step of a channel of so many bits, and what arithmetic in floats adds.
constexpr double half_step(int bits) { return 0.5 / double((1 << bits) - 1) + 2e-6; }
constexpr double of_floats = 2e-6;

TEST_F(GBufferFormats, FloatsComeBackAsTheyWere) {
  const std::vector<Point> points = some_points(), stored = back("#GBUFFER=5", points);
  ASSERT_EQ(stored.size(), points.size());
  EXPECT_EQ(std::memcmp(points.data(), stored.data(), points.size() * sizeof(Point)), 0);
}

TEST_F(GBufferFormats, PackedFieldsAreWrongByHalfAStep) {
  const Off most = off("#GBUFFER=2#PACKED=4");
  EXPECT_LE(most.depth, of_floats);
  EXPECT_LE(most.place_px, 0.5 * 0.5 / 127 + 1e-3);
  EXPECT_LE(most.normal_deg, 0.0038);
  EXPECT_LE(most.base, half_step(8));
  EXPECT_LE(most.f0, half_step(8));
  EXPECT_LE(most.emission, std::ldexp(1.0, -11) + of_floats);
  for (const double channel : {most.roughness, most.metallic, most.occlusion}) EXPECT_LE(channel, half_step(8));
}

TEST_F(GBufferFormats, OneHundredAndTwentyEightBitsAreWrongByHalfAStep) {
  const Off most = off("#GBUFFER=1#PACKED=2");
  EXPECT_LE(most.depth, of_floats);
  EXPECT_LE(most.place_px, 0.5 + 1e-3);  // at the middle of the pixel
  EXPECT_LE(most.normal_deg, 0.12);
  EXPECT_LE(most.base, half_step(8));
  EXPECT_LE(most.f0, half_step(8));
  EXPECT_LE(most.emission, std::ldexp(1.0, -7) + of_floats);  // up to 127 of 64 to 128
  EXPECT_LE(most.roughness, half_step(6));
  for (const double channel : {most.metallic, most.occlusion}) EXPECT_LE(channel, half_step(4));
}

TEST_F(GBufferFormats, StoredPositionsAreExactAndTheRestHalfAStep) {
  const Off most = off("#GBUFFER=2#PACKED=3");
  EXPECT_EQ(most.depth, 0);
  EXPECT_EQ(most.place_px, 0);
  // Half a step of 2 / 1023 in each of three coordinates.
  EXPECT_LE(most.normal_deg, glm::degrees(std::sqrt(3.0) / 1023) + 1e-3);
  EXPECT_LE(most.base, half_step(8));
  EXPECT_LE(most.f0, half_step(8));
  EXPECT_LE(most.emission, std::ldexp(1.0, -9) + of_floats);
  for (const double channel : {most.roughness, most.metallic, most.occlusion}) EXPECT_LE(channel, half_step(8));
}

TEST_F(GBufferFormats, DiffuseSpecularAndExponentAreWrongByHalfAStep) {
  const Off most = off("#GBUFFER=1#PACKED=1");
  EXPECT_LE(most.depth, std::ldexp(1.0, -17) + of_floats);
  EXPECT_LE(most.place_px, 0.5 + 1e-3);
  EXPECT_LE(most.normal_deg, 0.06);  // 2x12 (Cigolle et al. 2014)
  EXPECT_LE(most.diffuse, half_step(8));
  EXPECT_LE(most.specular, half_step(8));
  EXPECT_LE(most.exponent, 0.5 + 0.02);  // of up to 20,000
  EXPECT_LE(most.occlusion, half_step(6));
}

}  // namespace gbuffer_formats
}  // namespace candela::gpu::test
