#pragma once
#include "base/statistics.h"
#include "bench/row.h"

namespace candela {

// How one way of rendering (technique and knobs) answers to the number of lights, all else equal. Vectors run along
// `lights`, which rises; only measured rows are in them. NaN: no lists
// were counted.
struct Scaling {
  std::string way;
  std::vector<double> lights, frame_ms, gpu_ms, lights_per_pixel, waste_fraction, memory_mib;
  std::vector<Interval> frame_ci;  // 95 % of the medians in frame_ms
  PowerFit all, top;               // of frame_ms: over all, and over the last factor of 64 in the number of lights
};
// Rows must be of one axis (row_axis).
std::vector<Scaling> scalings(const std::vector<const BenchRow*>& rows);

}  // namespace candela
