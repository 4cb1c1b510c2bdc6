#include <charconv>
#include <numeric>
#include <set>

#include "base/text.h"
#include "job/job.h"

namespace candela {
namespace {

// More than any film has; a slip such as 1-1000000000 is refused instead of filling the memory.
constexpr int64_t max_frames = 10'000'000;

bool read_integer(std::string_view& text, int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(size_t(end - text.data()));
  return true;
}

Expected<std::vector<int64_t>> parse_range(std::string_view part) {
  const auto refuse = [&](std::string_view why) {
    return fail(ErrorKind::usage, "",
                "'{}' in the frame list {}; write frames as 7, 0-249, 1-100x5 or 2,4,10-20 (ends included)", part, why);
  };
  std::string_view rest = part;
  int64_t first = 0, last = 0, step = 1;
  if (!read_integer(rest, first)) return refuse("is not a frame number");
  last = first;
  if (rest.starts_with('-')) {
    rest.remove_prefix(1);
    if (!read_integer(rest, last)) return refuse("has no last frame");
    if (rest.starts_with('x')) {
      rest.remove_prefix(1);
      if (!read_integer(rest, step)) return refuse("has no step");
      if (step < 1) return refuse("has a step below 1");
    }
  }
  if (!rest.empty()) return refuse("is not a frame range");
  if (first > last) return refuse(fmt::format("runs backwards: {}-{} are the same frames", last, first));
  // Differences as unsigned: the ends may be anywhere in 64 bits.
  const uint64_t length = uint64_t(last) - uint64_t(first);
  if (length / uint64_t(step) >= uint64_t(max_frames)) return refuse("holds more than ten million frames");
  std::vector<int64_t> frames;
  for (uint64_t i = 0; i <= length / uint64_t(step); ++i) frames.push_back(first + int64_t(i) * step);
  return frames;
}

}  // namespace

Expected<std::vector<int64_t>> parse_frame_list(const std::string& text) {
  std::vector<int64_t> frames;
  std::set<int64_t> seen;
  for (std::string part : split(text, ',')) {
    std::erase(part, ' ');
    const auto range = parse_range(part);
    if (!range) return std::unexpected(range.error());
    for (const int64_t frame : *range)
      if (seen.insert(frame).second) frames.push_back(frame);
    if (frames.size() > size_t(max_frames))
      return fail(ErrorKind::usage, "", "the frame list holds more than ten million frames");
  }
  return frames;
}

std::string FrameRate::text() const {
  return denominator == 1 ? fmt::format("{}", numerator) : fmt::format("{}/{}", numerator, denominator);
}

namespace {
// What broadcasters mean by the rounded decimals (SMPTE ST 12-1): N * 1000/1001.
struct BroadcastRate {
  std::string_view text;
  int64_t numerator;
};
constexpr BroadcastRate broadcast_rates[] = {{"23.976", 24000}, {"23.98", 24000}, {"29.97", 30000},  {"47.952", 48000},
                                             {"47.95", 48000},  {"59.94", 60000}, {"119.88", 120000}};
}  // namespace

Expected<FrameRate> parse_frame_rate(const std::string& text) {
  const auto refuse = [&] {
    return fail(ErrorKind::usage, "", "'{}' is not a frame rate; write 24, 23.976, 12.5 or 30000/1001", text);
  };
  for (const BroadcastRate& rate : broadcast_rates)
    if (text == rate.text) return FrameRate{rate.numerator, 1001};
  std::string_view rest = text;
  int64_t numerator = 0, denominator = 1;
  if (rest.empty() || rest[0] == '-' || !read_integer(rest, numerator)) return refuse();
  if (rest.starts_with('/')) {
    rest.remove_prefix(1);
    if (rest.starts_with('-') || !read_integer(rest, denominator)) return refuse();
  } else if (rest.starts_with('.')) {
    rest.remove_prefix(1);
    if (rest.empty() || rest.size() > 6) return refuse();
    for (; !rest.empty() && rest[0] >= '0' && rest[0] <= '9'; rest.remove_prefix(1)) {
      if (numerator > 1'000'000'000) return refuse();
      numerator = numerator * 10 + (rest[0] - '0');
      denominator *= 10;
    }
  }
  constexpr int64_t highest = 1'000'000'000'000;
  if (!rest.empty() || numerator <= 0 || denominator <= 0 || numerator > highest || denominator > highest)
    return refuse();
  const int64_t divisor = std::gcd(numerator, denominator);
  return FrameRate{numerator / divisor, denominator / divisor};
}

}  // namespace candela
