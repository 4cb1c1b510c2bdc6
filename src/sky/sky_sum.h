#pragma once
#include <span>
#include <vector>

#include "sky/job_sky.h"
#include "sky/prefilter_sky.h"

namespace candela {

// Filtering is linear: the filtered sum of skies is the sum of filtered skies of one size. Each part keeps its own
// bright spots.
struct WeightedSky {
  const FilteredSky* sky = nullptr;
  glm::vec3 weight{1};
};
// Of maps of one size, four floats a texel: the fourth is the first part's. sum: as large as each.
void sum_texels(std::span<const WeightedSky> parts, std::vector<float> FilteredSky::*map, std::span<std::byte> sum);
// lights: whatever it held.
void sum_lights(std::span<const WeightedSky> parts, std::vector<shared::SkyLight>& lights);
DividedSky sum_of(std::span<const DividedSky> divided, std::span<const SkyPart> weights);

}  // namespace candela
