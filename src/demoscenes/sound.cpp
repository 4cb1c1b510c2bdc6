#include "demoscenes/sound.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace candela {
namespace {

using std::numbers::pi;

void put(std::vector<std::byte>& bytes, std::string_view text) {
  for (char c : text) bytes.push_back(std::byte(c));
}
void put(std::vector<std::byte>& bytes, uint32_t value, int size) {
  for (int b = 0; b < size; ++b) bytes.push_back(std::byte(value >> (8 * b) & 0xff));
}

}  // namespace

void Sound::add(const std::function<glm::dvec2(double time_s)>& source) {
  for (size_t i = 0; i < samples_.size(); ++i) samples_[i] += source(double(i) / sound_rate_hz);
}

std::vector<std::byte> Sound::wav() const {
  constexpr uint32_t channels = 2, bytes_each = 2, pcm = 1;
  const uint32_t size = uint32_t(samples_.size()) * channels * bytes_each;
  std::vector<std::byte> bytes;
  bytes.reserve(size + 44);
  put(bytes, "RIFF"), put(bytes, size + 36, 4), put(bytes, "WAVEfmt "), put(bytes, 16, 4);
  put(bytes, pcm, 2), put(bytes, channels, 2), put(bytes, uint32_t(sound_rate_hz), 4);
  put(bytes, uint32_t(sound_rate_hz) * channels * bytes_each, 4), put(bytes, channels * bytes_each, 2);
  put(bytes, 8 * bytes_each, 2), put(bytes, "data"), put(bytes, size, 4);
  for (const glm::dvec2& sample : samples_)
    for (int c = 0; c < 2; ++c) put(bytes, uint32_t(int32_t(std::lround(32767 * std::tanh(sample[c])))) & 0xffff, 2);
  return bytes;
}

double Tone::next(double hertz) {
  turns_ += hertz / sound_rate_hz;
  turns_ -= std::floor(turns_);
  return std::sin(2 * pi * turns_);
}

double Rumble::next(double hertz) {
  const double share = 1 - std::exp(-2 * pi * hertz / sound_rate_hz);
  value_ += share * (rng_.uniform(-1, 1) - value_);
  // The variance of what is left is share / (2 - share) of that of the noise, which is 1/3.
  return value_ * std::sqrt(3 * (2 - share) / share);
}

glm::dvec2 Hum::next(double time_s) {
  const double swell = 0.85 + 0.15 * std::sin(2 * pi * 0.13 * time_s);
  const double low = tones_[0].next(hertz_) + 0.6 * tones_[1].next(1.503 * hertz_);
  const double left = 0.35 * tones_[2].next(2.011 * hertz_), right = 0.35 * tones_[3].next(1.993 * hertz_);
  return swell *
         (glm::dvec2(low + left, low + right) + 0.5 * glm::dvec2(left_.next(4 * hertz_), right_.next(4 * hertz_)));
}

glm::dvec2 panned(double value, double side) {
  const double angle = 0.25 * pi * (std::clamp(side, -1.0, 1.0) + 1);
  return value * glm::dvec2(std::cos(angle), std::sin(angle));
}

}  // namespace candela
