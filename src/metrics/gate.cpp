#include "metrics/gate.h"

#include "base/json.h"
#include "metrics/flip.h"
#include "metrics/planes.h"

namespace candela {
namespace {

constexpr std::array<std::pair<std::string_view, double GateLimits::*>, 5> members = {
    {{"max_abs", &GateLimits::max_abs},
     {"small_abs", &GateLimits::small_abs},
     {"small_share", &GateLimits::small_fraction},
     {"flip_mean", &GateLimits::flip_mean},
     {"flip_p99", &GateLimits::flip_p99}}};

constexpr std::array<std::pair<std::string_view, double GateLimits::Warn::*>, 3> warn_members = {
    {{"max_abs", &GateLimits::Warn::max_abs},
     {"flip_mean", &GateLimits::Warn::flip_mean},
     {"flip_p99", &GateLimits::Warn::flip_p99}}};

// The numbers of an object; keys that `others` names are read elsewhere.
template <class Limits, size_t N>
Expected<void> read_numbers(const nlohmann::ordered_json& object,
                            const std::array<std::pair<std::string_view, double Limits::*>, N>& known,
                            std::initializer_list<std::string_view> others, Limits& limits, const std::string& place) {
  if (!object.is_object()) return fail(ErrorKind::input, place, "must be an object of gate limits");
  for (const auto& [key, value] : object.items()) {
    if (std::find(others.begin(), others.end(), key) != others.end()) continue;
    const auto member = std::find_if(known.begin(), known.end(), [&](const auto& m) { return m.first == key; });
    if (member == known.end()) return fail(ErrorKind::input, place, "unknown gate limit \"{}\"", key);
    if (!value.is_number() || !(value.template get<double>() >= 0))
      return fail(ErrorKind::input, place, "gate limit \"{}\" must be a number of at least 0", key);
    limits.*(member->second) = value.template get<double>();
  }
  return {};
}

Expected<void> read_members(const nlohmann::ordered_json& object, GateLimits& limits, const std::string& place) {
  if (auto read = read_numbers(object, members, {"device_classes", "warn"}, limits, place); !read) return read;
  const auto warn = object.find("warn");
  if (warn != object.end()) {
    GateLimits::Warn& own = limits.warn ? *limits.warn : limits.warn.emplace();
    if (auto read = read_numbers(*warn, warn_members, {}, own, place + "/warn"); !read) return read;
  }
  const auto beyond = [](double warned, double failed) { return std::isfinite(warned) && warned > failed; };
  if (limits.warn &&
      (beyond(limits.warn->flip_mean, limits.flip_mean) || beyond(limits.warn->flip_p99, limits.flip_p99)))
    return fail(ErrorKind::input, place + "/warn",
                "is beyond what fails (flip_mean {}, flip_p99 {}): it would never warn", limits.flip_mean,
                limits.flip_p99);
  return {};
}

// Largest difference of any channel and the fraction of pixels that differ by more than small_abs, of the values that
// the display shows: colour encoded and clamped, alpha as stored.
struct Spread {
  double largest = 0, fraction = 0;
};
Spread spread_of(const FloatImage& golden, const FloatImage& actual, double small_abs, Encoding encoding) {
  auto a = display_planes(golden, encoding), b = display_planes(actual, encoding);
  if (const Channel* alpha = golden.find("A"); alpha && alpha->type != ChannelType::uint32) {
    a.push_back(alpha->f);
    b.push_back(actual.find("A")->f);
  }
  // Codes are quotients of whole numbers rounded to float: one step must not read as a little more than one step.
  constexpr double rounding = 1e-6;
  Spread spread;
  size_t over = 0;
  const size_t count = size_t(golden.width) * size_t(golden.height);
  for (size_t i = 0; i < count; ++i) {
    double largest = 0;
    for (size_t c = 0; c < a.size(); ++c)
      largest = std::max(largest, std::abs(double(a[c][i]) - double(b[c][i])) - rounding);
    spread.largest = std::max(spread.largest, largest);
    over += largest > small_abs;
  }
  spread.fraction = double(over) / double(count);
  return spread;
}

bool within(const GateLimits::Warn& warn, double largest, double flip_mean, double flip_p99) {
  return largest <= warn.max_abs && flip_mean <= warn.flip_mean && flip_p99 <= warn.flip_p99;
}

}  // namespace

Expected<GateLimits> parse_gate_limits(std::string_view text, std::string_view device_class, const std::string& place) {
  const auto json = read_json(text, place);
  if (!json) return std::unexpected(json.error());
  if (!json->is_object()) return fail(ErrorKind::input, place, "is not a JSON object");
  GateLimits limits;
  const auto gate = json->find("gate");
  if (gate == json->end()) return limits;
  if (auto read = read_members(*gate, limits, place + ": /gate"); !read) return std::unexpected(read.error());
  const auto classes = gate->find("device_classes");
  if (classes == gate->end()) return limits;
  if (!classes->is_object()) return fail(ErrorKind::input, place + ": /gate/device_classes", "must be an object");
  const auto own = classes->find(std::string(device_class));
  if (own == classes->end()) return limits;
  const std::string own_place = fmt::format("{}: /gate/device_classes/{}", place, device_class);
  if (auto read = read_members(*own, limits, own_place); !read) return std::unexpected(read.error());
  return limits;
}

std::string gate_limits_json(const GateLimits& limits) {
  nlohmann::ordered_json json;
  for (const auto& [name, member] : members) json["gate"][std::string(name)] = limits.*member;
  if (limits.warn)
    for (const auto& [name, member] : warn_members)
      if (std::isfinite((*limits.warn).*member)) json["gate"]["warn"][std::string(name)] = (*limits.warn).*member;
  return json.dump(2);
}

std::string_view gate_level_name(GateLevel level) {
  static constexpr std::array<std::string_view, 5> names = {"identical", "nearly identical", "similar", "warned",
                                                            "failed"};
  return names[size_t(level)];
}

GateResult judge_golden(const FloatImage& golden, const FloatImage& actual, const GateLimits& limits,
                        Encoding encoding) {
  GateResult result;
  result.blank = is_blank(actual);
  result.comparison = compare(golden, actual, {encoding, false});
  const Comparison& quick = result.comparison;
  if (!quick.refusal.empty()) {
    result.message = quick.refusal;
    return result;
  }
  if (quick.metrics.at("differing") == 0) {
    result.level = GateLevel::identical;
    return result;
  }
  result.comparison = compare(golden, actual, {encoding, true});
  const auto flip = result.comparison.metrics.find("flip");
  if (flip == result.comparison.metrics.end()) {
    result.message = "the images differ and have no colour to judge the difference by";
    return result;
  }
  result.flip_p99 = flip_percentile(result.comparison.flip_map, 0.99);
  const Spread spread = spread_of(golden, actual, limits.small_abs, encoding);
  result.largest = spread.largest;
  result.small_fraction = spread.fraction;
  result.message = fmt::format(
      "{} pixels differ, by at most {:.2f}/255; {:.4f} % by more than {:.2f}/255; FLIP mean {:.5f}, p99 {:.4f}",
      quick.metrics.at("differing"), spread.largest * 255, spread.fraction * 100, limits.small_abs * 255, flip->second,
      result.flip_p99);
  if (spread.largest <= limits.max_abs && spread.fraction <= limits.small_fraction)
    result.level = GateLevel::nearly_identical;
  else if (flip->second <= limits.flip_mean && result.flip_p99 <= limits.flip_p99)
    result.level = limits.warn && within(*limits.warn, spread.largest, flip->second, result.flip_p99)
                       ? GateLevel::similar
                       : GateLevel::warned;
  return result;
}

}  // namespace candela
