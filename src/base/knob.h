#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/error.h"

namespace candela {

// What a knob changes. `look` is how the picture is meant to be, where no value is more exact than another.
enum class Trades { error, time, look };

// One row of a pass's knob table. Every approximation has a ladder whose last rung is the exact thing (DESIGN section
// 3). Values are numbers; a knob that names choices lists them in `choices` and its value is the index. K is the pass's
// plain Knobs struct; member points at a float, int, bool (stored as int) field.
template <class K>
struct Knob {
  std::string_view name;  // "samples": set by --set PASS.NAME=VALUE
  std::variant<int K::*, float K::*> member;
  std::string_view unit;                  // "px", "m", "" for a count
  double lowest, highest;                 // outside is an error, never a clamp
  std::vector<double> ladder;             // from draft to exact: what the quality presets take
  std::string_view trades;                // one sentence: what it costs and what it leaves wrong
  std::vector<std::string_view> choices;  // names for the values 0, 1, ...; empty for plain numbers
  Trades kind = Trades::error;
  // What `bench --error` walks: the ladder's last value and others, which presets need not take; empty: the ladder.
  std::vector<double> walk = {};
  // Passes whose work it changes; empty: the one whose table this is. With plans that keep none of them it does
  // nothing.
  std::vector<std::string_view> passes = {};
};

// What --set and the quality presets ask for: pass, knob, value text, in the order given.
struct KnobSetting {
  std::string pass, knob, value;
};

}  // namespace candela
