#include "metrics/regions.h"

#include <charconv>

#include "base/text.h"

namespace candela {
namespace {

template <class T>
std::vector<T> cropped(const std::vector<T>& from, int width, const Region& r) {
  std::vector<T> result;
  if (from.empty()) return result;  // a channel holds floats or integers
  result.reserve(size_t(r.width) * size_t(r.height));
  for (int y = r.y; y < r.y + r.height; ++y) {
    const auto row = from.begin() + std::ptrdiff_t(y) * width + r.x;
    result.insert(result.end(), row, row + r.width);
  }
  return result;
}

}  // namespace

Expected<Region> parse_region(std::string_view text) {
  const std::vector<std::string> parts = split(text, ',');
  int values[4] = {};
  bool fine = parts.size() == 4;
  for (size_t i = 0; fine && i < 4; ++i) {
    const auto parsed = std::from_chars(parts[i].data(), parts[i].data() + parts[i].size(), values[i]);
    fine = parsed.ec == std::errc() && parsed.ptr == parts[i].data() + parts[i].size() && values[i] >= (i < 2 ? 0 : 1);
  }
  if (!fine)
    return fail(ErrorKind::usage, {},
                "region \"{}\" is not of the form X,Y,WIDTH,HEIGHT in whole pixels, for example 0,0,64,64", text);
  return Region{values[0], values[1], values[2], values[3]};
}

Expected<void> check_region(const Region& r, int width, int height) {
  if (int64_t(r.x) + r.width <= width && int64_t(r.y) + r.height <= height) return {};
  return fail(ErrorKind::usage, {}, "region {} reaches beyond the image of {}x{}", r.text(), width, height);
}

FloatImage crop(const FloatImage& image, const Region& region) {
  FloatImage result{.width = region.width, .height = region.height};
  for (const Channel& channel : image.channels)
    result.channels.push_back(
        {channel.name, channel.type, cropped(channel.f, image.width, region), cropped(channel.u, image.width, region)});
  return result;
}

Plane crop(const Plane& plane, int width, const Region& region) { return cropped(plane, width, region); }

}  // namespace candela
