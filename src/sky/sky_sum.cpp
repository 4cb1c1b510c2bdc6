#include "sky/sky_sum.h"

#include <tbb/parallel_for.h>

#include <cstring>

#include "base/check.h"

namespace candela {
namespace {

void add_lights(std::vector<shared::SkyLight>& sum, const std::vector<shared::SkyLight>& part, glm::vec3 weight) {
  if (weight == glm::vec3(0)) return;
  for (shared::SkyLight light : part) {
    light.illuminance *= weight;
    sum.push_back(light);
  }
}

}  // namespace

void sum_texels(std::span<const WeightedSky> parts, std::vector<float> FilteredSky::*map, std::span<std::byte> sum) {
  using Texel = float __attribute__((vector_size(16)));
  for (const WeightedSky& part : parts) CHECK((part.sky->*map).size() * sizeof(float) == sum.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, sum.size() / sizeof(Texel), 4096), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      Texel all{};
      for (size_t p = 0; p < parts.size(); ++p) {
        const glm::vec3 w = parts[p].weight;
        Texel t;
        std::memcpy(&t, (parts[p].sky->*map).data() + 4 * i, sizeof t);
        const Texel value = Texel{w.x, w.y, w.z, p == 0 ? 1.0f : 0.0f} * t;
        all = p == 0 ? value : all + value;
      }
      std::memcpy(sum.data() + i * sizeof(Texel), &all, sizeof all);
    }
  });
}

void sum_lights(std::span<const WeightedSky> parts, std::vector<shared::SkyLight>& lights) {
  lights.clear();
  for (const auto& [sky, weight] : parts) add_lights(lights, sky->lights, weight);
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
