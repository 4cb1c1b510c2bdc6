#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "base/rng.h"

// Sound of the films, by sums of sines and noise.
namespace candela {

constexpr int sound_rate_hz = 32000;

// Two channels at moments 1 / sound_rate_hz apart. What is louder than 1 is bent down softly.
class Sound {
 public:
  explicit Sound(double length_s) : samples_(size_t(length_s * sound_rate_hz + 0.5)) {}
  // Adds what a source gives at each moment; moments come in order, so that it may keep phases and filters.
  void add(const std::function<glm::dvec2(double time_s)>& source);
  std::vector<std::byte> wav() const;  // PCM of 16 bits

 private:
  std::vector<glm::dvec2> samples_;
};

// A sine whose pitch may change from moment to moment.
class Tone {
 public:
  double next(double hertz);

 private:
  double turns_ = 0;
};

// Noise without what is above a frequency (one pole), of about unit loudness.
class Rumble {
 public:
  explicit Rumble(uint64_t seed) : rng_(seed) {}
  double next(double hertz);

 private:
  Rng rng_;
  double value_ = 0;
};

// A few low tones that beat slowly against each other.
class Hum {
 public:
  Hum(double hertz, uint64_t seed) : hertz_(hertz), left_(seed), right_(seed + 1) {}
  glm::dvec2 next(double time_s);

 private:
  double hertz_;
  Tone tones_[4];
  Rumble left_, right_;
};

// Equal power: -1 is left, 1 right.
glm::dvec2 panned(double value, double side);

}  // namespace candela
