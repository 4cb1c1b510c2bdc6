#include "sky/prefilter_sky.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <numbers>

#include "passes/surfaces/ibl_knobs.h"
#include "scene/environment.h"
#include "shared/split_sum.h"
#include "sky/sky_lights.h"

namespace candela::frame_prefilter_sky {
namespace {

using std::numbers::pi;

DecodedImage sky_of(int width, int height, const std::function<glm::dvec3(glm::dvec3)>& f) {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  std::vector<glm::vec4> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      texels.emplace_back(glm::vec3(f(equirect_direction((x + 0.5) / width, (y + 0.5) / height))), 1);
  const auto bytes = std::as_bytes(std::span(texels));
  image.pixels.assign(bytes.begin(), bytes.end());
  return image;
}

IblKnobs quick() {
  IblKnobs knobs;
  knobs.size_px = 64;
  return knobs;
}

glm::dvec2 octahedral(glm::dvec3 d) {
  d /= std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  if (d.y >= 0) return {d.x, d.z};
  return {std::copysign(1 - std::abs(d.z), d.x), std::copysign(1 - std::abs(d.x), d.z)};
}
// Bilinear, as a texture unit reads.
glm::dvec3 read(const std::vector<float>& texels, glm::uvec2 size, glm::dvec2 uv) {
  const glm::dvec2 at = uv * glm::dvec2(size) - 0.5;
  const glm::ivec2 low = glm::floor(at);
  const glm::dvec2 t = at - glm::dvec2(low);
  glm::dvec3 sum(0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const float* p = texels.data() + (size_t(low.y + j) * size.x + size_t(low.x + i)) * 4;
      sum += (i ? t.x : 1 - t.x) * (j ? t.y : 1 - t.y) * glm::dvec3(p[0], p[1], p[2]);
    }
  return sum;
}
glm::dvec3 slice(const FilteredSky& sky, size_t i, glm::dvec3 d) {
  return read(sky.texels, {sky.width, sky.height},
              glm::dvec2(sky.slices[i].offset) + glm::dvec2(sky.slices[i].scale) * (octahedral(d) * 0.5 + 0.5));
}
glm::dvec3 irradiance(const FilteredSky& sky, glm::dvec3 n) {
  const double side = sky.irradiance_px;
  return read(sky.irradiance, glm::uvec2(sky.irradiance_px), (1.0 + (side - 2) * (octahedral(n) * 0.5 + 0.5)) / side);
}

// Directions all over, edges and corners of the octahedron among them.
std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> list;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z)
        if (x || y || z) list.push_back(glm::normalize(glm::dvec3(x, y, z)));
  return list;
}

// The mean cosine from its middle of a slice's lobe, by the midpoint rule over the polar angle.
double mean_cosine(double roughness) {
  const double a2 = std::pow(roughness, 4);
  double sum = 0, all = 0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count, angle = t * t * pi / 2, c = std::cos(angle);
    const double k = 0.5 * (1 + c) * (a2 - 1) + 1;
    const double weight = c / (k * k) * std::sin(angle) * t;
    all += weight, sum += weight * c;
  }
  return sum / all;
}

// The mean square of a coordinate across the lobe of a slice, and across the BRDF's own, without Fresnel's term, of
// light that a viewer at n.v = 1 sees.
double spread_across(double roughness, bool seen_from_above) {
  const double a2 = std::pow(roughness, 4);
  double sum = 0, all = 0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count, angle = t * t * pi / 2, c = std::cos(angle);
    const double k = 0.5 * (1 + c) * (a2 - 1) + 1, masking = c + std::sqrt(c * c * (1 - a2) + a2);
    const double weight = (seen_from_above ? c / masking : c) / (k * k) * std::sin(angle) * t;
    all += weight, sum += weight * (1 - c * c) / 2;
  }
  return sum / all;
}

double roughness_of(double i) { return std::exp2((i - 14) / 3); }

}  // namespace

// Uniform light stays as it is, to the last digits of a float's sums.
TEST(PrefilterSky, KeepsUniformLight) {
  const FilteredSky sky = prefilter_sky(sky_of(64, 32, [](glm::dvec3) { return glm::dvec3(2, 1, 0.5); }), quick());
  EXPECT_TRUE(sky.lights.empty());
  ASSERT_EQ(sky.slices.size(), shared::sky_slice_count);
  for (const glm::dvec3 d : directions()) {
    for (size_t i = 0; i < sky.slices.size(); ++i) EXPECT_NEAR(slice(sky, i, d).x, 2, 2e-5) << i;
    EXPECT_NEAR(irradiance(sky, d).y, 1, 1e-3);
  }
}

// Light that is linear in the direction is so after filtering, by the lobe's mean cosine. What is left at the folds of
// the octahedral maps, where no bilinear lookup is exact, goes with the size of their texels.
TEST(PrefilterSky, MeansALinearSkyByTheLobe) {
  const DecodedImage image = sky_of(512, 256, [](glm::dvec3 d) { return 2.0 + d; });
  std::array<double, 2> at_folds{};
  for (const int size : {64, 256}) {
    IblKnobs knobs = quick();
    knobs.size_px = size, knobs.filter_samples = 1024;
    const FilteredSky sky = prefilter_sky(image, knobs);
    for (size_t i = 0; i < sky.slices.size(); i += 2) {
      const double c = mean_cosine(roughness_of(i));
      for (const glm::dvec3 d : directions()) {
        const bool folded = d.x == 0 || d.y == 0 || d.z == 0;
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(slice(sky, i, d)[k], 2 + c * d[k], folded ? 0.04 : 0.01) << i << " " << k;
          if (i == 0 && folded)
            at_folds[size == 256] = std::max(at_folds[size == 256], std::abs(slice(sky, i, d)[k] - (2 + c * d[k])));
        }
      }
    }
    for (const glm::dvec3 d : directions())
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(irradiance(sky, d)[k], 2 + 2.0 / 3 * d[k], d.x == 0 || d.y == 0 || d.z == 0 ? 0.025 : 0.004);
  }
  EXPECT_LT(at_folds[1], 0.35 * at_folds[0]);
}

// A sun of one texel, at the seam or near a pole, becomes a light that shines from it; nothing is lost or made.
TEST(PrefilterSky, SunsBecomeLightsAndKeepTheirEnergy) {
  for (const glm::dvec3 sun : {glm::dvec3(-1, 0.3, 0.001), glm::dvec3(0.05, 1, 0.02), glm::dvec3(0.4, -0.2, 0.7)}) {
    const glm::dvec3 towards = glm::normalize(sun);
    const DecodedImage image = sky_of(256, 128, [&](glm::dvec3 d) {
      return glm::dot(d, towards) > std::cos(0.03) ? glm::dvec3(5000, 4000, 3000) : glm::dvec3(0.5);
    });
    const SkyLevel sky = sky_level(image);
    const SkyParts parts = take_lights(sky, 8);
    ASSERT_FALSE(parts.lights.empty());
    glm::dvec3 before(0), after(0), moment_before(0), moment_after(0);
    for (int y = 0; y < sky.height; ++y)
      for (int x = 0; x < sky.width; ++x) {
        const auto light = [&](const SkyLevel& l) {
          const SkyTexel& t = l.at(x, y);
          return sky.solid_angle(y) * glm::dvec3(t[0], t[1], t[2]);
        };
        before += light(sky), after += light(parts.rest);
        moment_before += light(sky).x * sky.direction(x, y), moment_after += light(parts.rest).x * sky.direction(x, y);
        EXPECT_LE(luminance(parts.rest.at(x, y)), 8 * 0.502);  // the sun itself, cut off, raises the mean by 0.2 %
      }
    for (const shared::SkyLight& l : parts.lights) {
      after += glm::dvec3(l.illuminance), moment_after += double(l.illuminance.x) * glm::dvec3(l.direction);
      EXPECT_GT(glm::dot(glm::dvec3(l.direction), towards), std::cos(0.05));
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(after[k], before[k], 1e-4 * before[k]);
      EXPECT_NEAR(moment_after[k], moment_before[k], 1e-3 * glm::length(moment_before));
    }
  }
}

// Wide spots are cut, as far as lights go; a bright half of the sky is none.
TEST(PrefilterSky, WideSpotsAreCut) {
  const auto with_box = [](double half_rad) {
    return sky_level(sky_of(256, 128, [=](glm::dvec3 d) {
      return glm::dvec3(glm::dot(d, glm::dvec3(0, 0, 1)) > std::cos(half_rad) ? 100.0 : 0.1);
    }));
  };
  EXPECT_EQ(take_lights(with_box(0.03), 16).lights.size(), 1u);
  const size_t wide = take_lights(with_box(0.2), 32).lights.size();
  EXPECT_GT(wide, 8u);
  EXPECT_LE(wide, 32u);
  EXPECT_EQ(take_lights(with_box(0.2), 2).lights.size(), 0u);  // two would be too wide
  EXPECT_EQ(take_lights(with_box(1.5), 32).lights.size(), 0u);
  EXPECT_EQ(take_lights(with_box(0.03), 0).lights.size(), 0u);
}

// A sun far brighter than all else comes back from diffuse surfaces as the cosine, and from smooth ones as itself.
TEST(PrefilterSky, HoldsABrightSun) {
  const glm::dvec3 towards = glm::normalize(glm::dvec3(0.3, 0.8, 0.5));
  const DecodedImage image =
      sky_of(256, 128, [&](glm::dvec3 d) { return glm::dvec3(glm::dot(d, towards) > std::cos(0.04) ? 1e6 : 1e-3); });
  IblKnobs knobs = quick();
  knobs.irradiance_px = 64;
  const FilteredSky sky = prefilter_sky(image, knobs);
  ASSERT_FALSE(sky.lights.empty());
  double lux = 0;
  for (const shared::SkyLight& l : sky.lights) lux += double(l.illuminance.x);
  for (const glm::dvec3 n : directions()) {
    // The kink where the sun rises is a texel of the map wide.
    EXPECT_NEAR(irradiance(sky, n).x, std::max(glm::dot(n, towards), 0.0) * lux / pi, 0.02 * lux / pi);
    for (size_t i = shared::sky_lights_from; i < sky.slices.size(); ++i) {
      EXPECT_GE(slice(sky, i, n).x, 0);
      EXPECT_LT(slice(sky, i, n).x, 0.1);
    }
  }
  EXPECT_GT(slice(sky, 4, towards).x, 1e5);
}

TEST(PrefilterSky, LobesLieBetweenNormalAndMirrorAndWidenWithRoughness) {
  const FilteredSky sky = prefilter_sky(sky_of(16, 8, [](glm::dvec3) { return glm::dvec3(1); }), quick());
  constexpr size_t size = shared::sky_lobe_size;
  const double low = std::sqrt(shared::least_roughness);
  for (size_t row = 0; row < size; ++row)
    for (size_t column = 0; column < size; ++column) {
      const float* const entry = &sky.lobes[4 * (row * size + column)];
      for (int part = 0; part < 2; ++part) {
        const float place = entry[2 * part], slice = entry[2 * part + 1];
        EXPECT_GE(place, 0) << row << " " << column;
        EXPECT_LE(place, 1.6f) << row << " " << column;
        EXPECT_GE(slice, 0);
        EXPECT_LE(slice, shared::sky_slice_count - 1);
      }
    }
  // At a slant the light of grazing half vectors leans further from the normal.
  for (size_t row = size / 3; row < size; ++row)
    for (size_t column = 4; column < 2 * size / 3; ++column) {
      const float* const entry = &sky.lobes[4 * (row * size + column)];
      EXPECT_GT(entry[2], entry[0]) << row << " " << column;
    }
  // Seen from above, the true lobe has masking but no cosine, so it is a little wider than its roughness's slice: the
  // table names one that is as wide, as long as there is one.
  for (size_t row = 0; row < size; ++row) {
    const double roughness = std::pow(low + (1 - low) * double(row) / (size - 1), 2);
    const double slice = double(sky.lobes[4 * (row * size + size - 1) + 1]);
    const double seen = spread_across(roughness, true);
    const double below = spread_across(roughness_of(std::floor(slice)), false);
    const double beyond = spread_across(roughness_of(std::floor(slice) + 1), false);
    if (slice < shared::sky_slice_count - 1.001)
      EXPECT_NEAR(std::lerp(below, beyond, slice - std::floor(slice)), seen, 0.02 * seen + 1e-5) << roughness;
    else
      EXPECT_GT(seen, 0.98 * spread_across(1, false)) << roughness;
  }
}

TEST(PrefilterSky, IsKeptByItsContent) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "prefiltered";
  const DecodedImage image = sky_of(32, 16, [](glm::dvec3 d) { return 2.0 + d; });
  const FilteredSky first = filtered_sky(image, quick(), folder);
  const auto files = [&] {
    std::vector<std::filesystem::path> list;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "skies")) list.push_back(entry);
    return list;
  };
  ASSERT_EQ(files().size(), 1u);
  const FilteredSky again = filtered_sky(image, quick(), folder);
  EXPECT_EQ(first.texels, again.texels);
  EXPECT_EQ(first.lobes, again.lobes);
  EXPECT_EQ(first.irradiance, again.irradiance);
  // Damage is found, and the file made anew.
  {
    std::fstream file(files().front(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(2000);
    file.put(char(0x7f));
  }
  EXPECT_EQ(filtered_sky(image, quick(), folder).texels, first.texels);
  IblKnobs other = quick();
  other.filter_samples = 16;
  (void)filtered_sky(image, other, folder);
  EXPECT_EQ(files().size(), 2u);
}

}  // namespace candela::frame_prefilter_sky
