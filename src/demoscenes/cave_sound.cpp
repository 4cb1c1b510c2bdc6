#include <algorithm>
#include <cmath>
#include <numbers>

#include "demoscenes/demo_scenes.h"
#include "demoscenes/sound.h"
#include "testscenes/procedural_textures.h"

// What a cave sounds like: a low hum, and drops that fall into water and are heard again from the walls.
namespace candela {
namespace {

struct Drop {
  double at_s, hertz, level, side;
};

std::vector<Drop> drops(double length_s, uint64_t seed) {
  Rng rng(seed);
  std::vector<Drop> made;
  for (double t = 0.4; t < length_s - 0.6; t += rng.uniform(0.25, 1.6))
    made.push_back({t, rng.uniform(700, 1900), rng.uniform(0.05, 0.25), rng.uniform(-0.9, 0.9)});
  return made;
}

// A bubble that rings, rises in pitch and dies away.
double ring(const Drop& drop, double after_s) {
  if (after_s < 0 || after_s > 0.25) return 0;
  const double phase = drop.hertz * (after_s + 1.5 * after_s * after_s);
  return drop.level * std::exp(-24 * after_s) * smooth_step(0, 0.002, after_s) * std::sin(2 * std::numbers::pi * phase);
}

}  // namespace

std::vector<std::byte> make_cave_sound(uint64_t seed) {
  constexpr double length_s = 15;
  Sound sound(length_s);
  Hum hum(41, seed);
  sound.add(
      [&](double t) { return 0.1 * smooth_step(0, 0.5, t) * smooth_step(length_s, length_s - 0.6, t) * hum.next(t); });
  const std::vector<Drop> all = drops(length_s, seed + 7);
  // The drop itself and three walls, each later, fainter and from elsewhere.
  constexpr double echo_s[] = {0, 0.11, 0.19, 0.34}, echo_level[] = {1, 0.4, 0.25, 0.13},
                   echo_turn[] = {1, -0.6, 0.4, -1};
  sound.add([&](double t) {
    glm::dvec2 sum(0);
    for (const Drop& drop : all)
      for (int e = 0; e < 4; ++e)
        if (const double after = t - drop.at_s - echo_s[e]; after >= 0 && after < 0.25)
          sum += panned(echo_level[e] * ring(drop, after), echo_turn[e] * drop.side);
    return sum;
  });
  return sound.wav();
}

}  // namespace candela
