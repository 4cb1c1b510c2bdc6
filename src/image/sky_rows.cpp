#include "image/sky_rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/input.h"

namespace candela {
namespace {

// The rows of the image that cover these rows of the source.
int first_covering(int row, int source, int size) { return int(int64_t(row) * size / source); }

// Weights of the texels of one axis between two places, which may lie within texels.
double overlap(double from, double to, int at) { return std::min(to, at + 1.0) - std::max(from, double(at)); }

}  // namespace

TexelFaults usable_texel(float* texel) {
  TexelFaults faults;
  for (int c = 0; c < 3; ++c) {
    float& value = texel[c];
    faults.nonfinite |= !std::isfinite(value);
    faults.negative |= value < 0 && std::isfinite(value);
    if (std::isnan(value) || value < 0) value = 0;
    if (std::isinf(value)) value = 65504;  // what half could not hold: the sun stays the brightest
  }
  return faults;
}

void warn_of_faults(size_t nonfinite, size_t negative, const std::string& place, std::vector<std::string>& warnings) {
  if (nonfinite)
    warnings.push_back(
        fmt::format("{}: {} texels are not finite; infinity is taken as 65504, the rest as 0", place, nonfinite));
  if (negative)
    warnings.push_back(fmt::format("{}: {} texels are negative; those values are taken as 0", place, negative));
}

uint64_t sky_bytes(int width, int height) {
  const uint64_t texels = uint64_t(width) * uint64_t(height);
  return width > most_sky_width / 2 ? texels * 24 : texels * 16 / 3 * 4;
}

Expected<void> SkyMeans::begin(const ImageInfo& info) {
  info_ = info;
  const auto parts = [](int size, int most) { return (size + most - 1) / most; };
  times_ = std::max(parts(info.width, most_sky_width), parts(info.height, most_sky_width / 2));
  image_ = {std::max(info.width / times_, 1),
            std::max(info.height / times_, 1),
            DecodedImage::Format::rgba32f,
            info.channels == 1 ? 1 : 3,
            {}};
  if (auto fits = charge_decoded(before_bytes_, sky_bytes(image_.width, image_.height), place_); !fits) return fits;
  image_.pixels.resize(size_t(image_.width) * size_t(image_.height) * 16);
  counts_.resize(size_t(image_.height));
  return {};
}

double SkyMeans::solid_angle(double top, double bottom) const {
  const double row = std::numbers::pi / info_.height;
  return std::cos(row * top) - std::cos(row * bottom);
}

void SkyMeans::add(int first, int count, const SkyRow& row) {
  const int from = first_covering(first, info_.height, image_.height),
            to = first_covering(first + count - 1, info_.height, image_.height);
  // A row of the source may lie in two of the image.
  tbb::parallel_for(from, std::min(to + 2, image_.height), [&](int target) { add_to(target, first, count, row); });
}

void SkyMeans::add_to(int target, int first, int count, const SkyRow& row) {
  const int width = image_.width;
  auto* out = reinterpret_cast<float*>(image_.pixels.data()) + size_t(target) * size_t(width) * 4;
  Counts& counts = counts_[size_t(target)];
  const auto make_usable = [&](float* texels) {
    // Finite and not negative are the bits below those of infinity: mostly all are.
    using Bits = uint32_t __attribute__((vector_size(16)));
    Bits most{};
    for (int x = 0; x < info_.width; ++x) {
      Bits bits;
      std::memcpy(&bits, texels + 4 * x, sizeof bits);
      most = most > bits ? most : bits;
    }
    constexpr uint32_t infinity = 0x7f800000;
    if (most[0] < infinity && most[1] < infinity && most[2] < infinity) return;
    for (int x = 0; x < info_.width; ++x) {
      const TexelFaults faults = usable_texel(texels + 4 * x);
      counts.nonfinite += faults.nonfinite, counts.negative += faults.negative;
    }
  };
  if (times_ == 1) {
    if (target < first || target >= first + count) return;
    row(target, out);
    make_usable(out);
    return;
  }
  const double top = double(target) * info_.height / image_.height,
               bottom = double(target + 1) * info_.height / image_.height;
  const double all = solid_angle(top, bottom), across = double(info_.width) / width;
  using Texel = float __attribute__((vector_size(16)));
  thread_local std::vector<Texel> texels;
  texels.resize(size_t(info_.width));
  const bool whole = info_.width == width * times_;
  for (int y = std::max(first, int(top)); y < std::min(first + count, info_.height) && y < bottom; ++y) {
    const double share = solid_angle(std::max(top, double(y)), std::min(bottom, y + 1.0)) / all;
    if (!(share > 0)) continue;
    row(y, reinterpret_cast<float*>(texels.data()));
    const Counts before = counts;
    make_usable(reinterpret_cast<float*>(texels.data()));
    if (y < top) counts = before;  // counted by the row above
    const float weight = float(share / across);
    for (int x = 0; x < width; ++x) {
      Texel sum{};
      if (whole) {
        const Texel* at = texels.data() + size_t(x) * size_t(times_);
        for (int i = 0; i < times_; ++i) sum += at[i];
      } else {
        const double left = x * across, right = left + across;
        for (int i = int(left); i < info_.width && i < right; ++i)
          sum += float(overlap(left, right, i)) * texels[size_t(i)];
      }
      auto* texel = reinterpret_cast<Texel*>(out) + x;
      *texel += weight * sum;
    }
  }
}

DecodedImage SkyMeans::finish(std::vector<std::string>& warnings) {
  Counts all;
  for (const Counts& row : counts_) all.nonfinite += row.nonfinite, all.negative += row.negative;
  warn_of_faults(all.nonfinite, all.negative, place_, warnings);
  if (times_ > 1) {
    auto* texels = reinterpret_cast<float*>(image_.pixels.data());
    for (size_t i = 0; i < image_.pixels.size() / 16; ++i) texels[4 * i + 3] = 1;
    warnings.push_back(
        fmt::format("{}: is {}x{}, and is made into {}x{}, means over {}x{} texels: skies are at most {} wide", place_,
                    info_.width, info_.height, image_.width, image_.height, times_, times_, most_sky_width));
  }
  return std::move(image_);
}

}  // namespace candela
