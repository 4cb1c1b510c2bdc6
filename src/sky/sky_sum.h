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
FilteredSky sum_of(std::span<const WeightedSky> parts);
DividedSky sum_of(std::span<const DividedSky> divided, std::span<const SkyPart> weights);

}  // namespace candela
