#include "plan/stand_ins.h"

#include <algorithm>
#include <cmath>

namespace candela {
namespace {

constexpr int most_halvings = 40;  // of ranges, each half the last; what is dimmer has the last one's

// One light, or several as one.
struct Source {
  glm::dvec3 intensity{0}, position{0};  // of several: the middle by intensity
};
double brightest(glm::dvec3 intensity) { return std::max({intensity.x, intensity.y, intensity.z}); }

// The sources by a grid over all of them whose cells are about `wide_m` wide: none along an axis that is much shorter,
// but at least `layers` along the shortest.
struct Grid {
  glm::dvec3 low{0}, step{1};
  glm::ivec3 cells{0};
  bool is_last = false;  // one cell wide
};
Grid grid_over(const std::vector<Source>& sources, double wide_m, int layers) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const Source& s : sources) low = glm::min(low, s.position), high = glm::max(high, s.position);
  Grid grid{.low = low};
  const glm::dvec3 extent = high - low;
  const int shortest = extent.x < std::min(extent.y, extent.z) ? 0 : extent.y < extent.z ? 1 : 2;
  grid.is_last = true;
  for (int a = 0; a < 3; ++a) {
    grid.cells[a] = int(std::min(std::round(extent[a] / wide_m), 0x1p20));
    grid.is_last &= grid.cells[a] <= 1;
    if (a == shortest && layers > 1 && extent[a] > 0) grid.cells[a] = std::max(grid.cells[a], layers);
    if (grid.cells[a] == 0) continue;
    const double beyond = 0.0618 * (high[a] - low[a]);
    grid.low[a] -= beyond;
    grid.step[a] = (high[a] - grid.low[a]) / grid.cells[a];
  }
  return grid;
}

// One source for all of a cell.
std::vector<Source> joined(const std::vector<Source>& sources, const Grid& grid) {
  std::vector<std::pair<uint64_t, uint32_t>> by_cell;
  by_cell.reserve(sources.size());
  for (size_t i = 0; i < sources.size(); ++i) {
    uint64_t cell = 0;
    for (int a = 0; a < 3; ++a) {
      const double at = grid.cells[a] > 0 ? (sources[i].position[a] - grid.low[a]) / grid.step[a] : 0;
      cell = cell << 20 | uint64_t(std::clamp(int(at), 0, std::max(grid.cells[a] - 1, 0)));
    }
    by_cell.emplace_back(cell, uint32_t(i));
  }
  std::ranges::sort(by_cell);
  std::vector<Source> out;
  for (size_t i = 0; i < by_cell.size();) {
    Source all;
    double weight = 0;
    const size_t first = i;
    for (; i < by_cell.size() && by_cell[i].first == by_cell[first].first; ++i) {
      const Source& s = sources[by_cell[i].second];
      all.intensity += s.intensity;
      all.position += brightest(s.intensity) * s.position;
      weight += brightest(s.intensity);
    }
    all.position /= weight;
    out.push_back(all);
  }
  return out;
}

}  // namespace

double window_of(const LightItem& light, double distance_m) {
  const auto window = [&](float range_m) {
    const double x = distance_m / double(range_m), x2 = x * x;  // 0 without a range
    return std::max(1 - x2 * x2, 0.0);
  };
  return window(light.range_m) - (light.inner_m > 0 ? window(light.inner_m) : 0.0);
}

size_t end_with_stand_ins(std::vector<LightItem>& lights, float floor_lux, double spacing, int layers) {
  const auto ends_at = [&](const LightItem& l) {  // 0: not of those
    const double strongest = brightest(glm::dvec3(l.intensity));
    const bool known = l.type == LightType::point && std::isinf(l.range_m) && strongest > 0 &&
                       std::isfinite(glm::length(glm::dvec3(l.position)) + strongest);
    return known ? std::min(std::sqrt(strongest / double(floor_lux)), 1e18) : 0.0;
  };
  double farthest_m = 0;
  for (const LightItem& l : lights) farthest_m = std::max(farthest_m, ends_at(l));
  if (!(farthest_m > 0)) return 0;
  size_t count = 0;
  std::vector<std::vector<Source>> by_step(most_halvings);  // of the farthest end, halved so many times
  for (LightItem& l : lights) {
    const double end_m = ends_at(l);
    if (!(end_m > 0)) continue;
    const int step = std::clamp(int(std::lround(std::log2(farthest_m / end_m))), 0, most_halvings - 1);
    l.range_m = float(std::ldexp(farthest_m, -step));
    by_step[size_t(step)].push_back({glm::dvec3(l.intensity), glm::dvec3(l.position)});
    ++count;
  }
  std::vector<Source> sources;
  for (int step = most_halvings - 1; step >= 0 || !sources.empty(); --step) {
    if (step >= 0) sources.insert(sources.end(), by_step[size_t(step)].begin(), by_step[size_t(step)].end());
    if (sources.empty()) continue;
    const double inner_m = std::ldexp(farthest_m, -step);
    const Grid grid = grid_over(sources, spacing * inner_m, layers);
    sources = joined(sources, grid);
    // The last need no end: they are so few.
    const bool last = grid.is_last;
    for (const Source& s : sources) {
      LightItem light{};
      light.type = LightType::point;
      light.position = glm::vec3(s.position), light.intensity = glm::vec3(s.intensity);
      light.inner_m = float(inner_m);
      light.range_m = last ? std::numeric_limits<float>::infinity() : float(2 * inner_m);
      lights.push_back(light);
    }
    if (last) sources.clear();
  }
  return count;
}

}  // namespace candela
