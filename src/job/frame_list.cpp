#include "job/frame_list.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "base/text.h"
#include "job/job.h"

namespace candela {
namespace {

// More than any film has; a slip such as 1-1000000000 is refused instead of filling the memory.
constexpr size_t max_frames = 10'000'000;

bool read_integer(std::string_view& text, int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(size_t(end - text.data()));
  return true;
}

Expected<void> add_range(std::string_view part, FrameList& list) {
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
  list.add(first, uint64_t(step), size_t(length / uint64_t(step)) + 1);
  return {};
}

}  // namespace

std::optional<size_t> FrameList::Range::place_of(int64_t frame) const {
  if (frame < first || frame > last()) return {};
  const uint64_t apart = uint64_t(frame) - uint64_t(first);
  return apart % step == 0 ? std::optional(size_t(apart / step)) : std::nullopt;
}

FrameList::FrameList(std::initializer_list<int64_t> frames) {
  for (const int64_t frame : frames) add(frame, 1, 1);
}

int64_t FrameList::operator[](size_t place) const {
  const auto behind =
      std::ranges::upper_bound(ranges_, place, std::less<>{}, [](const Range& range) { return range.before; });
  const Range& range = *std::prev(behind);
  return range.at(place - range.before);
}

std::optional<size_t> FrameList::place_of(int64_t frame) const {
  for (const Range& range : ranges_)
    if (const auto place = range.place_of(frame)) return range.before + *place;
  return {};
}

FrameList FrameList::every(size_t step, size_t first) const {
  FrameList some;
  for (const Range& range : ranges_) {
    const size_t skipped = range.before <= first ? first - range.before : (step - (range.before - first) % step) % step;
    if (skipped < range.count)
      some.append(range.at(skipped), range.step * step, (range.count - 1 - skipped) / step + 1);
  }
  return some;
}

void FrameList::append(int64_t first, uint64_t step, size_t count) {
  ranges_.push_back({first, std::max<uint64_t>(step, 1), count, size()});
}

// Longer ranges where it goes on as the last one does.
void FrameList::append_one(int64_t frame) {
  if (!ranges_.empty() && frame > ranges_.back().last()) {
    Range& back = ranges_.back();
    const uint64_t step = uint64_t(frame) - uint64_t(back.last());
    if (back.count == 1 || step == back.step) {
      back.step = step;
      ++back.count;
      return;
    }
  }
  append(frame, 1, 1);
}

void FrameList::add(int64_t first, uint64_t step, size_t count) {
  const Range added{first, step, count};
  for (const Range& range : ranges_)
    if (range.place_of(first) && range.place_of(added.last()) && (count == 1 || step % range.step == 0)) return;
  const bool apart = std::ranges::all_of(
      ranges_, [&](const Range& range) { return range.last() < added.first || range.first > added.last(); });
  if (apart && count > 1) return append(first, step, count);
  for (size_t i = 0; i < count; ++i)
    if (apart || !contains(added.at(i))) append_one(added.at(i));
}

bool FrameList::operator==(const FrameList& other) const {
  return size() == other.size() && std::equal(begin(), end(), other.begin());
}

Expected<FrameList> parse_frame_list(const std::string& text) {
  FrameList frames;
  for (std::string part : split(text, ',')) {
    std::erase(part, ' ');
    if (auto added = add_range(part, frames); !added) return std::unexpected(added.error());
    if (frames.size() > max_frames)
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
