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
};
std::vector<LimitVerdict> judge_limits(const Comparison& comparison, std::span<const Limit> limits);

// True when the images could be compared and every limit holds.
bool passes(const Comparison& comparison, std::span<const LimitVerdict> verdicts);

// {"metrics": {...}, "pass": true}, with "limits" and "refusal" where there are any (DESIGN section 11).
std::string comparison_json(const Comparison& comparison, std::span<const LimitVerdict> verdicts);

}  // namespace candela
