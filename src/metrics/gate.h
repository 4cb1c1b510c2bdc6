#pragma once
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "metrics/compare.h"

namespace candela {

// What a golden allows; values in display-encoded [0,1]. They lie in the JSON beside each golden, never in the program:
// these are the ones a new golden starts with.
struct GateLimits {
  double max_abs = 2.0 / 255;     // level 2: no channel differs by more,
  double small_abs = 1.0 / 255;   //         and by more than this ...
  double small_fraction = 0.001;  //         ... only in this fraction of the pixels
  double flip_mean = 0.01;        // levels 3 and 4: mean of the FLIP map
  double flip_p99 = 0.10;         //         and its 99th percentile
  // Rung 3 alone: what is beyond passes with a warning. Without it all that reaches the FLIP map is warned of.
  struct Warn {
    double max_abs = std::numeric_limits<double>::infinity();    // no channel, alpha too, differs by more,
    double flip_mean = std::numeric_limits<double>::infinity();  // nor these, which lie below those above
    double flip_p99 = std::numeric_limits<double>::infinity();
  };
  std::optional<Warn> warn;
};

// The object "gate" of a JSON text, with the members of GateLimits, all optional; "device_classes": {"cpu": {...}}
// inside it replaces values for one class. A member that "warn" leaves out gives no warning of its own. Other top-level
// keys belong to others. Errors (input): bad JSON, an unknown or bad member, a warning that is beyond failing.
Expected<GateLimits> parse_gate_limits(std::string_view json, std::string_view device_class, const std::string& place);
std::string gate_limits_json(const GateLimits& limits);

// The ladder: the first level that holds decides.
enum class GateLevel { identical, nearly_identical, similar, warned, failed };
std::string_view gate_level_name(GateLevel level);

struct GateResult {
  GateLevel level = GateLevel::failed;
  std::string message;        // why not a better level; empty for identical
  Comparison comparison;      // its FLIP map is there unless the images are identical or were refused
  double largest = 0;         // of all channels' differences
  double small_fraction = 0;  // pixels that differ by more than small_abs
  double flip_p99 = 0;
  bool blank = false;  // the new image shows a single colour
  bool passed() const { return level != GateLevel::failed; }
};
GateResult judge_golden(const FloatImage& golden, const FloatImage& actual, const GateLimits& limits,
                        Encoding encoding = Encoding::display);

}  // namespace candela
