#include "plan/light_end.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "base/rng.h"
#include "base/scratch.h"
#include "passes/lights/light_grid.h"
#include "plan/stand_ins.h"

namespace candela {
namespace {

constexpr size_t most_points = 256, least_points = 32, most_pairs = 4'000'000;
// A point may have so many lights on average, whatever usual_lux gives: the fewer, the more may be lost.
double least_lights(double most_lost) { return 3.2 / most_lost; }
// Points that did not choose lose more than those that did.
constexpr double care = 0.5;
// Illuminances by powers of two, two bins each.
constexpr int bins_per_octave = 2, least_exponent = -80, bins = 160 * bins_per_octave;

int bin_of(double lux) {
  const double at = (std::log2(lux) - least_exponent) * bins_per_octave;
  return int(std::clamp(std::floor(at), 0.0, double(bins - 1)));
}
double edge_of(int bin) { return std::exp2(least_exponent + double(bin) / bins_per_octave); }

struct Point {
  glm::dvec3 position, normal;  // relative
};

// On the surfaces of what is drawn, even by a power of the items' bounds' areas.
void add_points_on(const Scene& scene, const FrameData& data, size_t count, double power,
                   ScratchVector<Point>& points) {
  Scratch scratch;
  ScratchVector<double> ends(&scratch);  // of the items' parts of all
  ends.reserve(data.items.size());
  double sum = 0;
  for (const DrawItem& item : data.items) {
    const glm::dvec3 e(item.bounds_relative.extent());
    const double area = e.x * e.y + e.y * e.z + e.z * e.x;
    const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
    const bool known = section.topology == Topology::triangles && section.index.size() >= 3 &&
                       !section.position.empty() &&
                       std::isfinite(area);  // metaballs have no vertices here; what stands about them tells as much
    ends.push_back(sum += known ? std::pow(area, power) : 0);
  }
  if (!(sum > 0)) return;
  Rng rng(27);
  for (size_t i = 0; i < count; ++i) {
    const double at = (double(i) + rng.uniform()) / double(count) * sum;
    const size_t n = std::min(size_t(std::upper_bound(ends.begin(), ends.end(), at) - ends.begin()), ends.size() - 1);
    const DrawItem& item = data.items[n];
    const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
    const size_t triangle =
        std::min(size_t(rng.uniform() * double(section.index.size() / 3)), section.index.size() / 3 - 1);
    const double across = std::sqrt(rng.uniform()), v = rng.uniform();
    const glm::dmat4 m(data.relative_from_local[item.transform]);
    glm::dvec3 corner[3];
    for (size_t k = 0; k < 3; ++k)
      corner[k] = glm::dvec3(m * glm::dvec4(glm::dvec3(section.position[section.index[3 * triangle + k]]), 1));
    const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double size = glm::length(normal);
    if (!(size > 0) || !std::isfinite(size)) continue;
    points.push_back({(1 - across) * corner[0] + across * ((1 - v) * corner[1] + v * corner[2]), normal / size});
  }
}

// What a side of a point gets, by how much the lights give where they are faced.
struct Received {
  double all = 0;  // lux
  double lights = 0;
  std::array<double, bins> below{}, inverse{};  // by bin: of lights without range, sums of w c and w / c; w: the cosine
  std::array<double, bins> count{};             // of lights by bin
};

// Of a light at a point, on the side that it shines on: what it gives where it is faced, for an intensity of 1, without
// its range; and the cosine, which for spots has the cone's factor.
struct Arrival {
  double per_intensity = 0, distance_m = 0, weight = 0;
  bool behind = false;
};
Arrival arrival(const LightItem& light, const Point& p) {
  if (light.type == LightType::directional) {
    const double cosine = -glm::dot(glm::dvec3(light.direction), p.normal);
    return {1, 0, std::abs(cosine), cosine < 0};
  }
  const glm::dvec3 to_light = glm::dvec3(light.position) - p.position;
  const double d2 = glm::dot(to_light, to_light);
  if (!std::isfinite(d2)) return {};
  const double d = std::sqrt(std::max(d2, 1e-30));
  const glm::dvec3 l = to_light / d;
  double cone = 1;
  if (light.type == LightType::spot) {
    const double inner = std::cos(double(light.inner_cone_rad)), outer = std::cos(double(light.outer_cone_rad));
    cone = std::clamp((glm::dot(-l, glm::dvec3(light.direction)) - outer) / std::max(0.001, inner - outer), 0.0, 1.0);
    cone *= cone;
  }
  const double cosine = glm::dot(l, p.normal);
  return {1 / (d * d), d, cone * std::abs(cosine), cosine < 0};
}
double strongest(const LightItem& light) {
  return double(std::max({light.intensity.x, light.intensity.y, light.intensity.z}));
}

void receive(const LightItem& light, double weight, const Point& p, Received side[2]) {
  const Arrival a = arrival(light, p);
  const double w = weight * a.weight;
  if (!(strongest(light) > 0) || !(w > 0)) return;
  Received& r = side[a.behind];
  const double lux = strongest(light) * a.per_intensity;
  if (light.type == LightType::directional) {
    r.all += lux * a.weight;  // of few
    return;
  }
  const double c = std::clamp(lux, edge_of(0), edge_of(bins - 1));
  if (std::isfinite(light.range_m)) {
    r.all += w * c * window_of(light, a.distance_m);
    return;
  }
  const int bin = bin_of(c);
  r.all += w * c;
  r.below[size_t(bin)] += w * c;
  r.inverse[size_t(bin)] += w / c;
  r.count[size_t(bin)] += weight;
}

// The fraction of what counts that is lost with an end at each bin's lower edge; and how many lights there are then.
struct Losses {
  std::array<double, bins> lost{}, lights{};
};
void add_losses(const Received& r, double least_lux, Losses& out) {
  double below = 0, inverse = 0, count = 0;
  for (int b = 0; b < bins; ++b) inverse += r.inverse[size_t(b)], count += r.count[size_t(b)];
  for (int b = 0; b < bins; ++b) {
    const double lost = below + edge_of(b) * edge_of(b) * inverse;
    out.lost[size_t(b)] = std::max(out.lost[size_t(b)], lost / std::max(r.all, least_lux));
    out.lights[size_t(b)] += count;
    below += r.below[size_t(b)], inverse -= r.inverse[size_t(b)], count -= r.count[size_t(b)];
    inverse = std::max(inverse, 0.0);
  }
}

// Of a side of a point, by what lights with ends and stand-ins differ from those without, by colour.
struct Changed {
  glm::dvec3 all{0}, lost{0};
};
void add_change(const LightItem& before, const LightItem* after, const Point& p, Changed side[2]) {
  const Arrival a = arrival(after ? *after : before, p);
  if (!(a.weight > 0)) return;
  const glm::dvec3 lux = a.weight * a.per_intensity * glm::dvec3(before.intensity);
  const double given = before.type == LightType::directional ? 1 : window_of(before, a.distance_m);
  if (!after) {
    side[a.behind].lost -= lux * given;  // a stand-in
    return;
  }
  side[a.behind].all += lux * given;
  if (after->range_m != before.range_m) side[a.behind].lost += lux * (given - window_of(*after, a.distance_m));
}

double largest(glm::dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// How many of the lights from number `first` on reach a point, in the mean over a few.
double mean_reached(const std::vector<LightItem>& lights, size_t first, std::span<const Point> points) {
  constexpr size_t few = 24;
  const size_t stride = std::max<size_t>(points.size() / few, 1);
  double sum = 0, count = 0;
  for (size_t i = 0; i < points.size(); i += stride, ++count)
    for (size_t l = first; l < lights.size(); ++l)
      sum += glm::distance(glm::dvec3(lights[l].position), points[i].position) < double(lights[l].range_m);
  return sum / count;
}

// For each number of layers the widest spacing of stand-ins that leaves at most `most` wrong at every point, with at
// most most_stand_ins a point; or else the closest that fits. What leaves least takes its place in `out`, if it is
// better.
void choose_stand_ins(const std::vector<LightItem>& lights, std::span<const Point> points, double most,
                      double least_lux, double most_stand_ins, float floor_lux, LightEnd& out) {
  constexpr double spacings[] = {1, 0.7, 0.5, 0.35, 0.25, 0.18};
  std::vector<std::array<Changed, 2>> ended;  // by the lights' own ends, the same for all of these
  for (const int layers : {1, 4, 8}) {
    std::optional<std::vector<LightItem>> made[std::size(spacings)];
    const auto with = [&](size_t s) -> const std::vector<LightItem>& {
      if (!made[s]) {
        made[s] = lights;
        apply_light_end(*made[s], {.floor_lux = floor_lux, .spacing = spacings[s], .layers = layers});
      }
      return *made[s];
    };
    const auto fits = [&](size_t s) { return mean_reached(with(s), lights.size(), points) <= most_stand_ins; };
    size_t low = 0, high = std::size(spacings);  // `low` are known to fit, from `high` on none does
    while (low < high) {
      const size_t middle = (low + high) / 2;
      if (fits(middle))
        low = middle + 1;
      else
        high = middle;
    }
    if (low == 0) continue;
    if (with(0).size() == lights.size()) return;
    if (ended.empty()) {
      ended.resize(points.size());
      tbb::parallel_for(size_t(0), points.size(), [&](size_t i) {
        for (size_t l = 0; l < lights.size(); ++l) add_change(lights[l], &with(0)[l], points[i], ended[i].data());
      });
    }
    for (size_t s = low; s-- > 0;) {
      const std::vector<LightItem>& lit = with(s);
      std::vector<double> wrong(points.size());
      tbb::parallel_for(size_t(0), points.size(), [&](size_t i) {
        std::array<Changed, 2> sides = ended[i];
        for (size_t l = lights.size(); l < lit.size(); ++l) add_change(lit[l], nullptr, points[i], sides.data());
        for (const Changed& side : sides)
          wrong[i] = std::max(wrong[i], largest(side.lost) / std::max(largest(side.all), least_lux));
      });
      const double worst = *std::ranges::max_element(wrong);
      if (worst > most && s + 1 < low) break;  // the last one is the widest that holds
      if (worst < out.lost || worst <= most) out = {floor_lux, worst, out.held, spacings[s], layers};
      if (worst > most) break;
    }
    if (out.lost <= most) return;
  }
}

}  // namespace

LightEnd choose_light_end(const Scene& scene, const FrameData& data, double most_lost, double exposure_ev,
                          double usual_lux) {
  const auto is_endless = [](const LightItem& l) {
    return l.type != LightType::directional && !std::isfinite(l.range_m);
  };
  const size_t endless = size_t(std::ranges::count_if(data.lights, is_endless));
  if (endless == 0 || !(most_lost > 0)) return {};
  const size_t count = std::clamp(most_pairs / data.lights.size(), least_points, most_points);
  const size_t stride = std::max<size_t>(data.lights.size() * count / most_pairs, 1);
  Scratch scratch;
  ScratchVector<Point> points(&scratch);
  points.reserve(2 * count);  // before others ask
  add_points_on(scene, data, count, 1, points);
  if (points.empty()) return {float(usual_lux)};
  const size_t even = points.size();  // these say how long lists are
  // Small things beside a large floor have points, too.
  add_points_on(scene, data, count / 2, 0.5, points);
  const double least_lux = 0.01 * std::numbers::pi * std::exp2(-exposure_ev);
  ScratchVector<Losses> losses(points.size(), &scratch);
  tbb::parallel_for(size_t(0), points.size(), [&](size_t i) {
    Received side[2];
    for (size_t l = i % stride; l < data.lights.size(); l += stride)
      receive(data.lights[l], double(stride), points[i], side);
    for (const Received& r : side) add_losses(r, least_lux, losses[i]);
  });
  Losses all;
  for (size_t i = 0; i < points.size(); ++i)
    for (size_t b = 0; b < bins; ++b) {
      all.lost[b] = std::max(all.lost[b], losses[i].lost[b]);
      if (i < even) all.lights[b] += losses[i].lights[b] / double(even);
    }
  int chosen = bins - 1;
  while (chosen > 0 && all.lost[size_t(chosen)] > care * most_lost) --chosen;
  const double most_lights = std::max(1.5 * all.lights[size_t(bin_of(usual_lux))], least_lights(most_lost));
  const auto fitting = [&](double lights) {  // the bin whose lists are as long
    int bin = chosen;
    while (bin + 1 < bins && all.lights[size_t(bin)] > lights) ++bin;
    return bin;
  };
  const int own = fitting(most_lights);
  LightEnd out{float(edge_of(own)), all.lost[size_t(own)], own != chosen};
  out.held &= out.lost > most_lost;
  if (!out.held) return out;
  // Three times the lists, shared between lights and stand-ins.
  const double most_walked = 3 * most_lights;
  for (const double share : {1.0, 0.5}) {
    const int bin = fitting(share * most_lights);
    if (out.lost > care * most_lost)
      choose_stand_ins(data.lights, points, care * most_lost, least_lux, most_walked - all.lights[size_t(bin)],
                       float(edge_of(bin)), out);
  }
  if (const int bin = fitting(most_walked); all.lost[size_t(bin)] < out.lost && out.lost > care * most_lost)
    out = {float(edge_of(bin)), all.lost[size_t(bin)]};
  out.held = out.lost > most_lost;
  return out;
}

size_t apply_light_end(std::vector<LightItem>& lights, const LightEnd& end) {
  const size_t shared = end.spacing > 0 ? end_with_stand_ins(lights, end.floor_lux, end.spacing, end.layers) : 0;
  return shared + apply_light_floor(lights, end.floor_lux);
}

}  // namespace candela
