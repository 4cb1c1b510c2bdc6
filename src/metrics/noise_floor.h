#pragma once
#include <optional>

#include "image/image.h"

namespace candela {

// What the reference's own noise alone makes of rmse and relmse: the perfect image would be this far from it. A
// difference below it says nothing about the image under test.
struct NoiseFloor {
  double rmse = 0, relmse = 0;
  double relmse_sd = 0;  // standard error that the noise gives the relmse of the image under test
};

// Expected squared errors of a pixel's mean: channels variance.R .G .B (docs/using/outputs.md), their mean brought to
// the file's candela:mse where there is one, which is measured from two halves of the samples and so knows that samples
// of a low-discrepancy sequence are not independent. nullopt without these channels, or where candela:spp says that
// there was one sample, of which no variance is known. channels: how many the two metrics run over; alpha counts as
// free of noise.
struct NoiseMap {
  const Channel* variance[3] = {};
  double scale = 1;
};
std::optional<NoiseMap> noise_map(const FloatImage& reference);
NoiseFloor noise_floor(const NoiseMap& map, const FloatImage& reference, const FloatImage& test, size_t channels);

}  // namespace candela
