#include <algorithm>
#include <cmath>

#include "demoscenes/city.h"
#include "demoscenes/demo_scenes.h"
#include "demoscenes/sound.h"
#include "testscenes/procedural_textures.h"

// What the city sounds like: a low hum, and the saucer, heard from where the camera is.
namespace candela {
namespace city {
namespace {

constexpr double speed_of_sound_m_s = 343;

// Nearer to the traffic at the crossing; levels cross at the cuts as the pictures do, without a click.
double hum_level(double t) {
  constexpr double above = 0.075, crossing = 0.12, square = 0.07, blend_s = 0.04;
  return above + (crossing - above) * smooth_step(first_cut_s - blend_s, first_cut_s + blend_s, t) +
         (square - crossing) * smooth_step(second_cut_s - blend_s, second_cut_s + blend_s, t);
}

struct Heard {
  double distance_m, towards_m_s, side, speed_m_s;  // side: -1 is left
};

Heard heard(double t) {
  constexpr double step_s = 0.01;
  const glm::dvec3 from = saucer_at(t) - camera_at(t), later = saucer_at(t + step_s) - camera_at(t);
  const glm::dvec3 forward = camera_target(t) - camera_at(t);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
  const double distance = glm::length(from);
  return {.distance_m = distance,
          .towards_m_s = (distance - glm::length(later)) / step_s,
          .side = glm::dot(from, right) / distance,
          .speed_m_s = glm::length(later - from) / step_s};
}

// Two tones a little apart and their octave, the higher the faster it flies, by Doppler's shift for who stands at the
// camera; louder the nearer.
class Sweep {
 public:
  glm::dvec2 next(double t) {
    const Heard h = heard(t);
    const double doppler = speed_of_sound_m_s / std::max(speed_of_sound_m_s - h.towards_m_s, 100.0);
    const double hertz = doppler * (128 + 6.5 * std::min(h.speed_m_s, 90.0)) * (1 + 0.012 * wobble_.next(5.5));
    const double level = 0.5 * std::pow(20 / (20 + h.distance_m), 1.5) *
                         smooth_step(second_cut_s - 0.1, second_cut_s + 0.5, t) * smooth_step(end_s, end_s - 0.5, t);
    const double value = low_.next(hertz) + 0.8 * beside_.next(1.008 * hertz) + 0.35 * octave_.next(2.003 * hertz);
    return panned(level * value, 0.8 * h.side);
  }

 private:
  Tone low_, beside_, octave_, wobble_;
};

// A chord that trembles and rises with what it lifts.
class Beam {
 public:
  glm::dvec2 next(double t) {
    const double level = 0.05 * smooth_step(beam_from_s, beam_full_s, t) * smooth_step(beam_off_s, beam_to_s, t);
    const double root = 262 * (1 + 0.5 * smooth_step(lift_from_s, lift_to_s, t));
    const double value = root_.next(root) + 0.8 * fifth_.next(1.498 * root) + 0.6 * above_.next(2.52 * root);
    return panned(level * (0.7 + 0.3 * tremble_.next(11)) * value, 0.6 * heard(t).side);
  }

 private:
  Tone root_, fifth_, above_, tremble_;
};

}  // namespace
}  // namespace city

std::vector<std::byte> make_city_sound(uint64_t seed) {
  Sound sound(city::end_s);
  Hum hum(49, seed);
  city::Sweep sweep;
  city::Beam beam;
  sound.add([&](double t) {
    const double open = smooth_step(0, 0.5, t) * smooth_step(city::end_s, city::end_s - 0.6, t);
    return open * city::hum_level(t) * hum.next(t);
  });
  sound.add([&](double t) { return sweep.next(t); });
  sound.add([&](double t) { return beam.next(t); });
  return sound.wav();
}

}  // namespace candela
