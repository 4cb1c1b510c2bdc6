#pragma once
#include <string_view>
#include <vector>

#include "base/error.h"
#include "metrics/planes.h"

namespace candela {

// Exposures in stops, `count` of them evenly from start to stop, both ends included.
struct ExposureRange {
  double start = 0, stop = 0;
  int count = 1;
  bool operator==(const ExposureRange&) const = default;
};

// "-4,4,9". Errors: usage.
Expected<ExposureRange> parse_exposure_range(std::string_view text);

// The range that the authors take from a reference: its brightest pixel, then its median pixel, comes to 0.85 after the
// tone curve. A picture that is mostly black has a median of 0 and no such exposure; the median of its pixels above 0
// is taken there, and one exposure of 0 stops where no pixel is above 0. Values that are not finite have no part.
ExposureRange automatic_exposures(const std::vector<Plane>& linear_reference);

// HDR-FLIP (Andersson, Nilsson, Shirley, Akenine-Moeller, "Visualizing Errors in Rendered High Dynamic Range Images",
// 2021): scene-linear red, green and blue are shown at each exposure through Narkowicz's fit of the ACES curve, and a
// pixel's error is the largest of its LDR-FLIPs, in [0,1]. Results of two ranges are not comparable.
Plane hdr_flip_map(const std::vector<Plane>& linear_reference, const std::vector<Plane>& linear_test, int width,
                   int height, const ExposureRange& range);

}  // namespace candela
