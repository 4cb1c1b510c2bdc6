#pragma once
#include <fmt/format.h>

#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"

namespace candela {

// What a knob changes. `look` is how the picture is meant to be, where no value is more exact than another.
enum class Trades { error, time, look };

// Which member of a struct of knobs a row is of: a float or an int (flags are ints).
class KnobMember {
 public:
  template <class K, class T>
  requires std::same_as<T, int> || std::same_as<T, float> KnobMember(T K::*member) : is_float_(std::same_as<T, float>) {
    const K knobs{};
    offset_ = size_t(reinterpret_cast<const char*>(&(knobs.*member)) - reinterpret_cast<const char*>(&knobs));
  }
  bool is_float() const { return is_float_; }
  // knobs: the struct that it is a member of.
  double get(const void* knobs) const {
    const char* const at = static_cast<const char*>(knobs) + offset_;
    return is_float_ ? *reinterpret_cast<const float*>(at) : *reinterpret_cast<const int*>(at);
  }
  void set(void* knobs, double to) const {
    char* const at = static_cast<char*>(knobs) + offset_;
    if (is_float_)
      *reinterpret_cast<float*>(at) = float(to);
    else
      *reinterpret_cast<int*>(at) = int(to);
  }

 private:
  size_t offset_ = 0;
  bool is_float_ = false;
};

// One row of a knob table. Every approximation has levels whose last one is the exact thing. Values are numbers; a knob
// that names choices lists them in `choices` and its value is the index.
struct Knob {
  std::string_view name;  // "samples": set by --set TABLE.NAME=VALUE
  KnobMember member;
  std::string_view unit = {};             // "px", "m", "" for a count
  double lowest = 0, highest = 1;         // outside is an error, never a clamp
  std::vector<double> levels = {};        // from draft to exact: what the quality presets take; empty: the default
  std::string_view description;           // one sentence: what it costs and what it leaves wrong
  std::vector<std::string_view> choices;  // names for the values 0, 1, ...; empty for plain numbers
  Trades kind = Trades::error;
  // What `bench --error` sweeps: the exact level and others, which presets need not take; empty: the levels.
  std::vector<double> sweep = {};
  std::vector<double> only = {};   // the values it takes; empty: all from lowest to highest
  std::string_view required = {};  // settings without which it does nothing: "a.b=1 c.d=2"
  std::vector<std::pair<double, std::string_view>> named = {};  // values with a name, also beyond lowest and highest

  double value(const void* knobs) const { return member.get(knobs); }
  void set(void* knobs, double to) const { member.set(knobs, to); }
  // As it is printed and as --set takes it: a choice by its name, a float by its shortest digits.
  std::string text(double v) const {
    if (!choices.empty()) return std::string(choices[size_t(v)]);
    for (const auto& [value, name_of_value] : named)
      if (value == v) return std::string(name_of_value);
    return member.is_float() ? fmt::format("{}", float(v)) : fmt::format("{}", v);
  }
};

// A table of knobs is a plain struct of ints and floats with a name (the TABLE of --set) and its rows:
//   struct Knobs {
//     static constexpr std::string_view name = "bloom";
//     int levels = 6;
//     static std::span<const Knob> table();
//   };
template <class K>
concept KnobTable = requires {
  { K::name } -> std::convertible_to<std::string_view>;
  { K::table() } -> std::same_as<std::span<const Knob>>;
};

// Of a table, whose name others may have too.
using KnobTableId = const void*;
template <class K>
inline constexpr char knob_table_tag = 0;
template <class K>
constexpr KnobTableId knob_table_id() {
  return &knob_table_tag<K>;
}

// What --set and the quality presets ask for: pass, knob, value text, in the order given.
struct KnobSetting {
  std::string pass, knob, value;
};

}  // namespace candela
