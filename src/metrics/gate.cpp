#include "metrics/gate.h"

#include "base/json.h"
#include "metrics/flip.h"
#include "metrics/planes.h"

namespace candela {
namespace {

constexpr std::array<std::pair<std::string_view, double GateLimits::*>, 5> members = {
    {{"max_abs", &GateLimits::max_abs},
     {"small_abs", &GateLimits::small_abs},
     {"small_share", &GateLimits::small_share},
     {"flip_mean", &GateLimits::flip_mean},
     {"flip_p99", &GateLimits::flip_p99}}};

Expected<void> read_members(const nlohmann::ordered_json& object, GateLimits& limits, const std::string& place) {
  if (!object.is_object()) return fail(ErrorKind::input, place, "must be an object of gate limits");
  for (const auto& [key, value] : object.items()) {
    if (key == "device_classes") continue;
    const auto member = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.first == key; });
    if (member == members.end()) return fail(ErrorKind::input, place, "unknown gate limit \"{}\"", key);
    if (!value.is_number() || !(value.get<double>() >= 0))
      return fail(ErrorKind::input, place, "gate limit \"{}\" must be a number of at least 0", key);
    limits.*(member->second) = value.get<double>();
  }
  return {};
}

// Largest difference of any channel and the share of pixels that differ by more than small_abs, of the values that the
// display shows: colour encoded and clamped, alpha as stored.
struct Spread {
  double largest = 0, share = 0;
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
  spread.share = double(over) / double(count);
  return spread;
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
  return json.dump(2);
}

std::string_view gate_rung_name(GateRung rung) {
  static constexpr std::array<std::string_view, 4> names = {"identical", "nearly identical", "flagged", "failed"};
  return names[size_t(rung)];
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
    result.rung = GateRung::identical;
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
  result.small_share = spread.share;
  result.message = fmt::format(
      "{} pixels differ, by at most {:.2f}/255; {:.4f} % by more than {:.2f}/255; FLIP mean {:.5f}, p99 {:.4f}",
      quick.metrics.at("differing"), spread.largest * 255, spread.share * 100, limits.small_abs * 255, flip->second,
      result.flip_p99);
  if (spread.largest <= limits.max_abs && spread.share <= limits.small_share)
    result.rung = GateRung::nearly_identical;
  else if (flip->second <= limits.flip_mean && result.flip_p99 <= limits.flip_p99)
    result.rung = GateRung::flagged;
  return result;
}

}  // namespace candela
