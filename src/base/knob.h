#pragma once
#include <fmt/format.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"

namespace candela {

// What a knob changes. `look` is how the picture is meant to be, where no value is more exact than another.
enum class Trades { error, time, look };

// One row of a knob table. Every approximation has a ladder whose last rung is the exact thing (DESIGN section 3).
// Values are numbers; a knob that names choices lists them in `choices` and its value is the index.
// K is a plain struct of knobs; member points at a float or int (flags are ints) of it.
template <class K>
struct Knob {
  std::string_view name;  // "samples": set by --set TABLE.NAME=VALUE
  std::variant<int K::*, float K::*> member;
  std::string_view unit;                  // "px", "m", "" for a count
  double lowest, highest;                 // outside is an error, never a clamp
  std::vector<double> ladder;             // from draft to exact: what the quality presets take; empty: the default
  std::string_view trades;                // one sentence: what it costs and what it leaves wrong
  std::vector<std::string_view> choices;  // names for the values 0, 1, ...; empty for plain numbers
  Trades kind = Trades::error;
  // What `bench --error` walks: the ladder's last value and others, which presets need not take; empty: the ladder.
  std::vector<double> walk = {};
  std::vector<double> only = {};  // the values it takes; empty: all from lowest to highest
  std::string_view beside = {};   // settings that must stand beside it, or it does nothing: "a.b=1 c.d=2"
  std::vector<std::pair<double, std::string_view>> named = {};  // values with a name, also beyond lowest and highest

  double value(const K& knobs) const {
    return std::visit([&](auto m) { return double(knobs.*m); }, member);
  }
  void set(K& knobs, double to) const {
    std::visit([&](auto m) { knobs.*m = std::remove_reference_t<decltype(knobs.*m)>(to); }, member);
  }
  // As it is printed and as --set takes it: a choice by its name, a float by its shortest digits.
  std::string text(double v) const {
    if (!choices.empty()) return std::string(choices[size_t(v)]);
    for (const auto& [value, name_of_value] : named)
      if (value == v) return std::string(name_of_value);
    return std::holds_alternative<float K::*>(member) ? fmt::format("{}", float(v)) : fmt::format("{}", v);
  }
};

// A table of knobs is a plain struct with a name (the TABLE of --set) and its rows:
//   struct Knobs {
//     static constexpr std::string_view name = "bloom";
//     int levels = 6;
//     static std::span<const Knob<Knobs>> table();
//   };
template <class K>
concept KnobTable = requires {
  { K::name } -> std::convertible_to<std::string_view>;
  { K::table() } -> std::same_as<std::span<const Knob<K>>>;
};

// What --set and the quality presets ask for: pass, knob, value text, in the order given.
struct KnobSetting {
  std::string pass, knob, value;
};

}  // namespace candela
