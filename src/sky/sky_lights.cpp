#include "sky/sky_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

namespace candela {

double luminance(const SkyTexel& t) { return 0.2126 * double(t[0]) + 0.7152 * double(t[1]) + 0.0722 * double(t[2]); }

namespace {

// Measured over five skies (docs/understanding/image-based-light.md): more would take light out that maps blur well,
// less leaves spots whose reflections maps blur across the horizon of the surface.
constexpr double times_mean = 8;
constexpr double wide_rad = 0.02, too_wide_rad = 0.04;  // root mean squares of the angle from the middle
constexpr double least_fraction = 1e-4;                 // of the sky's light

// One texel above the threshold.
struct Bright {
  int x, y;
  glm::dvec3 direction;
  glm::dvec3 excess;  // illuminance
  double weight;      // its luminance
};

struct Spot {
  std::vector<Bright> texels;
  double weight = 0, spread2 = 0;  // square of the root mean square angle
  glm::dvec3 middle{0};
  double importance() const { return weight * spread2; }
};

void measure(Spot& spot) {
  glm::dvec3 sum(0);
  spot.weight = 0;
  for (const Bright& b : spot.texels) sum += b.weight * b.direction, spot.weight += b.weight;
  const double length = glm::length(sum);
  spot.middle = length > 0 ? sum / length : glm::dvec3(0, 1, 0);
  spot.spread2 = std::max(2 * (1 - length / spot.weight), 0.0);
}

// In two, at the middle, across the axis along which it is widest.
std::pair<Spot, Spot> cut(const Spot& spot) {
  glm::dmat3 moments(0.0);
  for (const Bright& b : spot.texels) {
    const glm::dvec3 off = b.direction - spot.middle;
    moments += b.weight * glm::outerProduct(off, off);
  }
  // The power method; squaring the matrix five times is thirty-two steps of it.
  for (int i = 0; i < 5; ++i) {
    const double size = moments[0][0] + moments[1][1] + moments[2][2];
    moments = (1 / size) * moments;
    moments = moments * moments;
  }
  const int column = moments[0][0] >= moments[1][1] && moments[0][0] >= moments[2][2] ? 0
                     : moments[1][1] >= moments[2][2]                                 ? 1
                                                                                      : 2;
  const glm::dvec3 axis = moments[column];
  std::pair<Spot, Spot> parts;
  for (const Bright& b : spot.texels)
    (glm::dot(b.direction - spot.middle, axis) < 0 ? parts.first : parts.second).texels.push_back(b);
  for (Spot* part : {&parts.first, &parts.second})
    if (!part->texels.empty()) measure(*part);
  return parts;
}

// Of texels that touch, across the seam too.
std::vector<Spot> bright_spots(const SkyLevel& sky, double threshold) {
  std::vector<Spot> spots;
  std::vector<bool> seen(sky.texels.size());
  const auto bright = [&](int x, int y) { return luminance(sky.at(x, y)) > threshold; };
  std::vector<glm::ivec2> open;
  for (int y0 = 0; y0 < sky.height; ++y0)
    for (int x0 = 0; x0 < sky.width; ++x0) {
      const auto place = [&](int x, int y) { return size_t(y) * size_t(sky.width) + size_t(x); };
      if (seen[place(x0, y0)] || !bright(x0, y0)) continue;
      Spot spot;
      open = {{x0, y0}};
      seen[place(x0, y0)] = true;
      while (!open.empty()) {
        const glm::ivec2 p = open.back();
        open.pop_back();
        const SkyTexel& t = sky.at(p.x, p.y);
        const double light = luminance(t), over = (light - threshold) / light * sky.solid_angle(p.y);
        const glm::dvec3 excess = over * glm::dvec3(double(t[0]), double(t[1]), double(t[2]));
        spot.texels.push_back({p.x, p.y, sky.direction(p.x, p.y), excess, light * over});
        for (int y = std::max(p.y - 1, 0); y <= std::min(p.y + 1, sky.height - 1); ++y)
          for (int i = -1; i <= 1; ++i) {
            const int x = (p.x + i + sky.width) % sky.width;
            if (seen[place(x, y)] || !bright(x, y)) continue;
            seen[place(x, y)] = true;
            open.push_back({x, y});
          }
      }
      measure(spot);
      spots.push_back(std::move(spot));
    }
  std::stable_sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.weight > b.weight; });
  return spots;
}

}  // namespace

// Eight times the mean luminance of the sky cut off at this very value.
double light_threshold(const SkyLevel& sky) {
  double threshold = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < 24; ++pass) {
    double sum = 0;
    for (int y = 0; y < sky.height; ++y) {
      double row = 0;
      for (int x = 0; x < sky.width; ++x) row += std::min(luminance(sky.at(x, y)), threshold);
      sum += row * sky.solid_angle(y);
    }
    const double next = times_mean * sum / (4 * std::numbers::pi);
    if (next > 0.999 * threshold) break;
    threshold = next;
  }
  return threshold > 0 ? threshold : std::numeric_limits<double>::infinity();
}

SkyParts take_lights(const SkyLevel& sky, int most) {
  SkyParts parts{sky, {}};
  if (most == 0) return parts;
  const double threshold = light_threshold(sky);
  if (!std::isfinite(threshold)) return parts;
  std::vector<Spot> spots = bright_spots(sky, threshold);
  const double all = threshold / times_mean * 4 * std::numbers::pi;
  std::erase_if(spots, [&](const Spot& s) { return s.weight < least_fraction * all; });
  if (spots.size() > size_t(most)) spots.resize(size_t(most));
  // The widest, weighed by their light, are cut first.
  while (spots.size() < size_t(most)) {
    const auto widest = std::max_element(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) {
      const double wa = a.spread2 > wide_rad * wide_rad ? a.importance() : 0;
      return wa < (b.spread2 > wide_rad * wide_rad ? b.importance() : 0);
    });
    if (widest == spots.end() || widest->spread2 <= wide_rad * wide_rad) break;
    auto [one, other] = cut(*widest);
    if (one.texels.empty() || other.texels.empty()) break;
    *widest = std::move(one);
    spots.push_back(std::move(other));
  }
  std::erase_if(spots, [](const Spot& s) { return s.spread2 > too_wide_rad * too_wide_rad; });
  std::stable_sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.weight > b.weight; });
  for (const Spot& spot : spots) {
    glm::dvec3 illuminance(0);
    for (const Bright& b : spot.texels) {
      illuminance += b.excess;
      SkyTexel& t = parts.rest.texels[size_t(b.y) * size_t(sky.width) + size_t(b.x)];
      t = float(threshold / luminance(t)) * t;
    }
    parts.lights.push_back({glm::vec3(spot.middle), glm::vec3(illuminance)});
  }
  return parts;
}

}  // namespace candela
