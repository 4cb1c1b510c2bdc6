#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/compare.h"

namespace candela {

// "flip=0.02": the most that a metric may be; psnr and ssim are the least, as more is better there.
struct Limit {
  std::string metric;
  double value = 0;
};
Expected<Limit> parse_limit(std::string_view text);  // errors: usage

struct LimitVerdict {
  Limit limit;
  double measured = 0;  // NaN when the metric was not computed
  bool pass = false;
  std::string region;  // empty: the whole image
};
// A limit holds in the whole image and in every region: a small one must not hide in the mean.
std::vector<LimitVerdict> judge_limits(const Comparison& comparison, std::span<const Limit> limits);

// True when the images could be compared and every limit holds.
bool passes(const Comparison& comparison, std::span<const LimitVerdict> verdicts);

// Which of the metrics say nothing, being no more than the reference's noise.
std::vector<std::string> below_noise(const std::map<std::string, double>& metrics, const NoiseFloor& noise);

// {"nonfinite": {...}, "metrics": {...}, "pass": true}, with limits, refusal, layers, regions and what else there is
// (docs/using/outputs.md).
std::string comparison_json(const Comparison& comparison, std::span<const LimitVerdict> verdicts);

}  // namespace candela
