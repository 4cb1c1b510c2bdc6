#include "sky/sky_sum.h"

#include <tbb/parallel_for.h>

#include "base/check.h"

namespace candela {
namespace {

// Four floats a texel; the fourth stays as the first part has it.
void add_texels(std::vector<float>& sum, const std::vector<float>& part, glm::vec3 weight, bool first) {
  CHECK(sum.size() == part.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, sum.size() / 4, 4096), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i)
      for (size_t c = 0; c < 4; ++c) {
        const float value = (c < 3 ? weight[int(c)] : first ? 1.0f : 0.0f) * part[4 * i + c];
        sum[4 * i + c] = first ? value : sum[4 * i + c] + value;
      }
  });
}

void add_lights(std::vector<shared::SkyLight>& sum, const std::vector<shared::SkyLight>& part, glm::vec3 weight) {
  if (weight == glm::vec3(0)) return;
  for (shared::SkyLight light : part) {
    light.illuminance *= weight;
    sum.push_back(light);
  }
}

}  // namespace

FilteredSky sum_of(std::span<const WeightedSky> parts) {
  FilteredSky sum = *parts.front().sky;
  sum.lights.clear();
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto& [sky, weight] = parts[i];
    CHECK(sky->width == sum.width && sky->height == sum.height && sky->irradiance_px == sum.irradiance_px);
    add_texels(sum.texels, sky->texels, weight, i == 0);
    add_texels(sum.irradiance, sky->irradiance, weight, i == 0);
    add_lights(sum.lights, sky->lights, weight);
  }
  return sum;
}

DividedSky sum_of(std::span<const DividedSky> divided, std::span<const SkyPart> weights) {
  DividedSky sum{divided.front().rest, {}};
  for (size_t i = 0; i < divided.size(); ++i) {
    const glm::vec3 w = weights[i].weight;
    const SkyTexel weight{w.x, w.y, w.z, 0};
    for (size_t level = 0; level < sum.rest.size(); ++level)
      for (size_t t = 0; t < sum.rest[level].texels.size(); ++t) {
        const SkyTexel value = weight * divided[i].rest[level].texels[t];
        sum.rest[level].texels[t] = i == 0 ? value : sum.rest[level].texels[t] + value;
      }
    add_lights(sum.lights, divided[i].lights, w);
  }
  return sum;
}

}  // namespace candela
