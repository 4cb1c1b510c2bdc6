#include "metrics/hdr_flip.h"

#include <tbb/parallel_for.h>

#include <charconv>

#include "base/check.h"
#include "base/text.h"
#include "metrics/flip.h"

namespace candela {
namespace {

// (a x^2 + b x) / (c x^2 + d x + e): Krzysztof Narkowicz's fit of ACES, with the factor 0.6 on x that takes its
// exposure back.
constexpr double a = 2.51 * 0.36, b = 0.03 * 0.6, c = 2.43 * 0.36, d = 0.59 * 0.6, e = 0.14;
constexpr double shown_at = 0.85;  // what the range brings the brightest and the median pixel to

// Radiance below zero goes through the curve as the authors' program lets it (it comes out bright, as of its absolute
// value): else pictures that a filter with negative lobes has resampled would have another result than theirs.
float tone_mapped(float radiance, double factor) {
  if (std::isnan(radiance)) return 0;
  const double x = std::clamp(double(radiance) * factor, -1e100, 1e100);  // an infinity would be infinity over infinity
  return float(std::clamp((a * x * x + b * x) / (c * x * x + d * x + e), 0.0, 1.0));
}

// Where the curve reaches shown_at.
double input_of_shown() {
  const double qa = a - shown_at * c, qb = b - shown_at * d, qc = -shown_at * e;
  return (-qb + std::sqrt(qb * qb - 4 * qa * qc)) / (2 * qa);
}

std::vector<Plane> exposed(const std::vector<Plane>& linear, int width, int height, double stops) {
  const double factor = std::exp2(stops);
  std::vector<Plane> result(3, Plane(linear[0].size()));
  tbb::parallel_for(0, height, [&](int y) {
    for (size_t k = 0; k < 3; ++k)
      for (size_t i = size_t(y) * size_t(width), end = i + size_t(width); i < end; ++i)
        result[k][i] = tone_mapped(linear[k][i], factor);
  });
  return result;
}

}  // namespace

Expected<ExposureRange> parse_exposure_range(std::string_view text) {
  const auto bad = [&] {
    return fail(
        ErrorKind::usage, {},
        "exposures \"{}\" are not of the form START,STOP,COUNT, for example -4,4,9: stops within -64 and 64, START "
        "no more than STOP, 1 to 256 of them",
        text);
  };
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) return bad();
  ExposureRange range;
  const auto read = [](const std::string& part, auto& value) {
    const auto parsed = std::from_chars(part.data(), part.data() + part.size(), value);
    return parsed.ec == std::errc() && parsed.ptr == part.data() + part.size();
  };
  if (!read(parts[0], range.start) || !read(parts[1], range.stop) || !read(parts[2], range.count)) return bad();
  const bool fine = range.start >= -64 && range.stop <= 64 && range.start <= range.stop && range.count >= 1 &&
                    range.count <= 256 && (range.count > 1 || range.start == range.stop);
  return fine ? Expected<ExposureRange>(range) : bad();
}

ExposureRange automatic_exposures(const std::vector<Plane>& linear_reference) {
  CHECK(linear_reference.size() == 3);
  std::vector<double> luminances;
  for (size_t i = 0; i < linear_reference[0].size(); ++i) {
    const double y =
        0.2126 * linear_reference[0][i] + 0.7152 * linear_reference[1][i] + 0.0722 * linear_reference[2][i];
    if (std::isfinite(y)) luminances.push_back(y);
  }
  const auto median_of = [](std::vector<double>& values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  if (luminances.empty()) return {};
  const double largest = *std::max_element(luminances.begin(), luminances.end());
  if (!(largest > 0)) return {};
  double median = median_of(luminances);
  if (!(median > 0)) {
    std::erase_if(luminances, [](double y) { return !(y > 0); });
    median = median_of(luminances);
  }
  ExposureRange range;
  range.start = std::log2(input_of_shown() / largest);
  range.stop = std::log2(input_of_shown() / median);
  range.count = std::max(2, int(std::ceil(range.stop - range.start)));
  return range;
}

Plane hdr_flip_map(const std::vector<Plane>& linear_reference, const std::vector<Plane>& linear_test, int width,
                   int height, const ExposureRange& range) {
  CHECK(range.count >= 1 && linear_reference.size() == 3 && linear_test.size() == 3);
  Plane largest(linear_reference[0].size(), 0.0f);
  for (int i = 0; i < range.count; ++i) {
    const double stops =
        range.count == 1 ? range.start : range.start + (range.stop - range.start) * i / (range.count - 1);
    const Plane map = flip_map_of_linear(exposed(linear_reference, width, height, stops),
                                         exposed(linear_test, width, height, stops), width, height);
    for (size_t p = 0; p < map.size(); ++p) largest[p] = std::max(largest[p], map[p]);
  }
  return largest;
}

}  // namespace candela
