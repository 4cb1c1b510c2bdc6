#pragma once
#include <span>

namespace candela {
// Robust statistics of raw samples; empty input gives 0. mad is the median absolute deviation from the median, unscaled.
double median(std::span<const double> samples);
double mad(std::span<const double> samples);
double percentile(std::span<const double> samples, double fraction);  // linear between ranks, fraction in [0,1]
}  // namespace candela
