// The mathematics of fog on the device alone, against double precision.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "passes_fixture.h"
#include "plan/frame_fog.h"
#include "reference/medium.h"
#include "shared/scene.h"

namespace candela::gpu::test {
namespace {

struct Place {
  glm::vec3 origin, direction;
  float distance_m, cosine;
};
struct Result {
  float metres;
  glm::vec3 through, held;
  float phase;
  glm::vec3 sky;  // through to the sky, by the cosine about the direction
};
static_assert(sizeof(Place) == 32 && sizeof(Result) == 44);

}  // namespace

class FogMath : public PassTest {
 protected:
  std::vector<Result> evaluated(const Fog& fog, glm::dvec3 eye, const std::vector<Place>& places,
                                uint32_t sky_directions = 16) {
    View view;
    view.position = eye;
    view.view_from_relative = glm::dmat4(1);
    shared::FrameConstants frame{};
    Look look;
    look.fog = fog;
    frame.fog = frame_fog(look, view, FrameData{}, 100, {16, 9, 8}, sky_directions);
    const Buffer constants = upload(std::vector{frame}, "constants"), input = upload(places, "places");
    GraphBuilder builder;
    const BufferHandle frame_buffer = import(builder, constants, "constants"), in = import(builder, input, "places");
    builder.begin_pass("fog medium");
    builder.read(frame_buffer, Access::uniform_read, "constants");
    builder.read(in, Access::compute_read, "places");
    BufferHandle out = builder.create(
        BufferDesc{.name = "results", .size_bytes = places.size() * sizeof(Result), .memory = BufferMemory::host_read});
    out = builder.write(out, Access::compute_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "fog_medium.comp"});
    builder.end_pass([=, count = uint32_t(places.size())](CommandList& commands) {
      struct {
        uint64_t places, results;
        uint32_t count;
      } const push{commands.address(in), commands.address(out), count};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(count);
    });
    builder.sink(out);
    const FrameRun run = run_all(builder);
    std::vector<Result> results(places.size());
    std::memcpy(results.data(), run.readbacks.at(out.resource)->bytes().data(), places.size() * sizeof(Result));
    return results;
  }

  static std::vector<Place> places(uint64_t seed) {
    Rng rng(seed);
    std::vector<Place> all;
    for (int i = 0; i < 2000; ++i) {
      glm::dvec3 d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
      if (i % 7 == 0) d.y = 0;
      if (i % 11 == 0) d = {i % 2 ? 1 : -1, 0, 0};
      all.push_back({glm::vec3(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-5, 5)),
                     glm::vec3(glm::normalize(d)), float(std::pow(10, rng.uniform(-3, 3))), float(rng.uniform(-1, 1))});
    }
    return all;
  }
};

// Extinctions from 0 to 1e6, with and without falloff and bounds: lengths, transmittance, its integral and the phase.
TEST_F(FogMath, IsThatOfTheReference) {
  const glm::dvec3 eye(1e6, 3, -2e6);
  for (const double extinction : {0.0, 1e-8, 1e-3, 0.1, 10.0, 1e6})
    for (const double falloff : {0.0, 0.2, 20.0})
      for (const bool bounded : {false, true}) {
        SCOPED_TRACE(fmt::format("extinction {} falloff {} bounded {}", extinction, falloff, bounded));
        Fog fog;
        fog.extinction_per_m = glm::dvec3(extinction) * glm::dvec3(1, 0.5, 2);
        fog.scattering_per_m = 0.9 * fog.extinction_per_m;
        fog.falloff_per_m = falloff;
        fog.height_m = eye.y + 1;
        fog.anisotropy = bounded ? 0.98 : -0.7;
        if (bounded) fog.lowest = eye + glm::dvec3(-3, -2, -4), fog.highest = eye + glm::dvec3(4, 2, 3);
        const reference::Medium medium(fog, eye);
        const std::vector<Place> all = places(uint64_t(extinction * 1e9) + bounded);
        const std::vector<Result> results = evaluated(fog, eye, all);
        for (size_t i = 0; i < all.size(); ++i) {
          const glm::dvec3 o(all[i].origin), d(all[i].direction);
          const double distance = double(all[i].distance_m);
          const reference::Span span = medium.inside(o, d, {0, distance});
          const double metres = medium.length(o, d, span);
          // A float's place is off by a unit in its last place, which the slope of the density multiplies.
          const double place = 2e-6 * (10 + distance * (span.empty() ? 0 : 1)) * (1 + falloff * 10);
          if (metres < 1e30)
            EXPECT_NEAR(results[i].metres, metres, metres * (2e-5 + place) + 4e-6 * (10 + distance)) << i;
          for (int c = 0; c < 3; ++c) {
            ASSERT_TRUE(std::isfinite(results[i].through[c]) && std::isfinite(results[i].held[c])) << i;
            const double depth = fog.extinction_per_m[c] * double(results[i].metres);  // from the float's own length on
            EXPECT_NEAR(results[i].through[c], std::exp(-depth), 4e-6 + 2e-6 * std::exp(-depth) * depth) << i;
            const double held = depth > 0 ? -std::expm1(-depth) / fog.extinction_per_m[c] : double(results[i].metres);
            EXPECT_NEAR(results[i].held[c], held, 3e-5 * held) << i << " depth " << depth;
          }
          const double phase = reference::henyey_greenstein(double(all[i].cosine), fog.anisotropy);
          EXPECT_NEAR(results[i].phase, phase, 2e-5 * phase) << i;
        }
        if (HasFailure()) return;
      }
}

// What fog without bounds leaves of the sky's light on a surface, up the ladder of fog.sky_directions, against the
// hemisphere's integral in double.
TEST_F(FogMath, LightOfTheSkyTendsToTheIntegral) {
  const glm::dvec3 eye(5, 3, -2);
  const std::vector<Place> all = [] {
    std::vector<Place> some = places(3);
    some.resize(60);
    return some;
  }();
  std::array<double, 3> worst{};
  for (const double extinction : {0.0, 0.01, 0.3, 1e6}) {
    Fog fog;
    fog.extinction_per_m = glm::dvec3(extinction) * glm::dvec3(1, 0.3, 3);
    fog.falloff_per_m = 0.2, fog.height_m = eye.y + 1;
    const reference::Medium medium(fog, eye);
    const std::array<uint32_t, 3> ladder = {16, 64, 1024};
    for (size_t rung = 0; rung < ladder.size(); ++rung) {
      const std::vector<Result> results = evaluated(fog, eye, all, ladder[rung]);
      for (size_t i = 0; i < all.size(); ++i) {
        const glm::dvec3 n(all[i].direction), o(all[i].origin);
        const glm::dvec3 x =
            glm::normalize(glm::cross(std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), n));
        const glm::dvec3 y = glm::cross(n, x);
        glm::dvec3 exact(0);
        constexpr int rings = 48, sectors = 96;
        for (int r = 0; r < rings; ++r)
          for (int k = 0; k < sectors; ++k) {
            const double u = (r + 0.5) / rings, phi = 2 * std::numbers::pi * (k + 0.5) / sectors;
            const glm::dvec3 d = std::sqrt(u) * (std::cos(phi) * x + std::sin(phi) * y) + std::sqrt(1 - u) * n;
            const double metres =
                medium.length(o, d, medium.inside(o, d, {0, std::numeric_limits<double>::infinity()}));
            for (int c = 0; c < 3; ++c)
              if (fog.extinction_per_m[c] > 0) exact[c] += std::exp(-fog.extinction_per_m[c] * metres);
          }
        exact /= double(rings * sectors);
        for (int c = 0; c < 3; ++c) {
          const double sky = double(results[i].sky[c]);
          ASSERT_TRUE(std::isfinite(sky)) << i;
          if (extinction > 0) worst[rung] = std::max(worst[rung], std::abs(sky - exact[c]));
        }
      }
    }
  }
  fmt::print("sky through fog: off by {:.4f}, {:.4f}, {:.4f}\n", worst[0], worst[1], worst[2]);
  EXPECT_LT(worst[0], 0.035);
  EXPECT_LT(worst[1], 0.5 * worst[0]);
  EXPECT_LT(worst[2], 0.005);  // what the sum in double is off by, where the horizon cuts the hemisphere
}

}  // namespace candela::gpu::test
