#include "sky/prefilter_sky.h"

#include <tbb/parallel_for.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/check.h"
#include "shared/split_sum.h"
#include "sky/sky_lights.h"
#include "sky/sky_pyramid.h"

namespace candela {
namespace {

using std::numbers::pi;
constexpr uint32_t last_slice = shared::sky_slice_count - 1;

double roughness_of_slice(double slice) { return std::exp2((slice - last_slice) / shared::sky_slices_per_octave); }

double radical_inverse(uint32_t i) {
  i = (i << 16) | (i >> 16);
  i = ((i & 0x00ff00ffu) << 8) | ((i & 0xff00ff00u) >> 8);
  i = ((i & 0x0f0f0f0fu) << 4) | ((i & 0xf0f0f0f0u) >> 4);
  i = ((i & 0x33333333u) << 2) | ((i & 0xccccccccu) >> 2);
  i = ((i & 0x55555555u) << 1) | ((i & 0xaaaaaaaau) >> 1);
  return i * 0x1p-32;
}

// Of texel (x, y) of an octahedral map of this side with a texel of margin. Beyond an edge the map goes on where the
// edge's other half lies.
glm::dvec3 octahedral_direction(uint32_t x, uint32_t y, uint32_t size) {
  glm::dvec2 p = (glm::dvec2(x, y) - 0.5) / double(size - 2) * 2.0 - 1.0;
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(p[axis]) > 1)
      p = axis == 0 ? glm::dvec2(std::copysign(2 - std::abs(p.x), p.x), -p.y)
                    : glm::dvec2(-p.x, std::copysign(2 - std::abs(p.y), p.y));
  glm::dvec3 d(p.x, 1 - std::abs(p.x) - std::abs(p.y), p.y);
  if (d.y < 0) {
    d.x = std::copysign(1 - std::abs(p.y), p.x);
    d.z = std::copysign(1 - std::abs(p.x), p.y);
  }
  return glm::normalize(d);
}

// Within 1e-5 rad, a fraction of any sky's texel.
inline float fast_atan2(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y), high = std::max(ax, ay), low = std::min(ax, ay);
  const float t = high > 0 ? low / high : 0.0f, t2 = t * t;
  float a = t * (0.99997726f +
                 t2 * (-0.33262347f + t2 * (0.19354346f + t2 * (-0.11643287f + t2 * (0.05265332f - t2 * 0.0117212f)))));
  if (ay > ax) a = float(pi / 2) - a;
  if (x < 0) a = float(pi) - a;
  return y < 0 ? -a : a;
}
// Within 0.01.
inline float fast_log2(float v) {
  const uint32_t bits = std::bit_cast<uint32_t>(v);
  const float mantissa = std::bit_cast<float>((bits & 0x007fffffu) | 0x3f800000u);
  return float(int(bits >> 23) - 127) + (-0.344845f * mantissa + 2.024658f) * mantissa - 1.674873f;
}

class SkyReader {
 public:
  explicit SkyReader(const std::vector<SkyLevel>& levels) : levels_(levels) {}
  // Trilinear. lod: of a texel at the horizon.
  SkyTexel sample(glm::vec3 d, float lod) const {
    const float across = std::sqrt(d.x * d.x + d.z * d.z);
    const float u = fast_atan2(d.z, d.x) * float(0.5 / pi) + 0.5f, v = fast_atan2(across, d.y) * float(1 / pi);
    const float most = float(levels_.size() - 1);
    const float at = std::clamp(lod - 0.5f * fast_log2(std::max(across, 1e-4f)), 0.0f, most);
    const int level = std::min(int(at), int(levels_.size()) - 2);
    const float t = at - float(level);
    return (1 - t) * bilinear(levels_[size_t(level)], u, v) + t * bilinear(levels_[size_t(level) + 1], u, v);
  }

 private:
  static SkyTexel bilinear(const SkyLevel& level, float u, float v) {
    const float x = u * float(level.width) - 0.5f, y = v * float(level.height) - 0.5f;
    const float fx0 = std::floor(x), fy0 = std::floor(y);
    const int mask = level.width - 1, x0 = int(fx0) & mask, x1 = (x0 + 1) & mask;
    const int y0 = std::clamp(int(fy0), 0, level.height - 1), y1 = std::clamp(int(fy0) + 1, 0, level.height - 1);
    const float fx = x - fx0, fy = y - fy0;
    const SkyTexel *above = &level.at(0, y0), *below = &level.at(0, y1);
    return (1 - fy) * ((1 - fx) * above[x0] + fx * above[x1]) + fy * ((1 - fx) * below[x0] + fx * below[x1]);
  }
  const std::vector<SkyLevel>& levels_;
};

// A direction about +Z, its weight of all (the weights sum to 1) and its level.
struct LobeSample {
  glm::vec3 l;
  float weight, lod;
};
std::vector<LobeSample> lobe_samples(double roughness, uint32_t count, const SkyLevel& sky) {
  const double alpha = roughness * roughness, a2 = alpha * alpha;
  const double horizon_texel = 2 * pi / sky.width * pi / sky.height;
  std::vector<LobeSample> samples;
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const double u = (i + 0.5) / count, phi = 2 * pi * radical_inverse(i);
    const double n_h2 = (1 - u) / (1 + (a2 - 1) * u), n_l = 2 * n_h2 - 1;
    if (!(n_l > 0)) continue;
    const double k = n_h2 * (a2 - 1) + 1, pdf = a2 / (pi * k * k) / 4;
    const double across = 2 * std::sqrt(n_h2 * (1 - n_h2));
    samples.push_back({glm::vec3(across * std::cos(phi), across * std::sin(phi), n_l), float(n_l),
                       float(0.5 * std::log2(1 / (count * pdf) / horizon_texel) + 0.5)});
    sum += n_l;
  }
  for (LobeSample& s : samples) s.weight = float(double(s.weight) / sum);
  return samples;
}

// Axes about a direction (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
glm::mat3 axes_about(glm::dvec3 n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {glm::vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x), glm::vec3(b, sign + n.y * n.y * a, -n.y),
          glm::vec3(n)};
}

// What is far brighter than the rest, as a tree: seen from afar a part of it counts as one point (Barnes and Hut, "A
// Hierarchical O(N log N) Force-Calculation Algorithm", 1986).
class BrightTree {
 public:
  struct Point {
    glm::vec3 direction;
    SkyTexel light;  // radiance times solid angle
    float weight;    // its luminance
  };
  explicit BrightTree(std::vector<Point> points) {
    if (!points.empty()) build(points, 0, points.size());
  }
  // Of the lobe of a slice about d; scale makes the lobe's integral 1.
  SkyTexel seen(glm::vec3 d, float a2, float scale) const {
    SkyTexel sum{};
    // Children come before their parents, a left one right before its sibling's tree: walked from the end.
    for (size_t i = nodes_.size(); i > 0;) {
      const Node& node = nodes_[i - 1];
      const float c = glm::dot(d, node.direction);
      // The lobe changes over its width, and over the distance beyond; 2 (1 - c) is the distance squared.
      if (node.points > 1 && node.spread2 > 0.005f * (2 * (1 - c) + 4 * a2)) {
        --i;
        continue;
      }
      if (c > 0) {
        const float k = 0.5f * (1 + c) * (a2 - 1) + 1;
        sum += (scale * c / (k * k)) * node.light;
      }
      i -= node.nodes;
    }
    return sum;
  }
  bool empty() const { return nodes_.empty(); }

 private:
  struct Node {
    glm::vec3 direction;
    float spread2 = 0;  // mean square distance from it
    SkyTexel light{};
    uint32_t points = 0, nodes = 1;  // below it, and with itself
  };
  uint32_t build(std::vector<Point>& points, size_t first, size_t end) {
    glm::dvec3 sum(0), low(2), high(-2);
    double weight = 0;
    Node node;
    for (size_t i = first; i < end; ++i) {
      const glm::dvec3 at(points[i].direction);
      sum += double(points[i].weight) * at, weight += double(points[i].weight), node.light += points[i].light;
      low = glm::min(low, at), high = glm::max(high, at);
    }
    node.direction = glm::vec3(glm::normalize(sum));
    for (size_t i = first; i < end; ++i) {
      const glm::vec3 off = points[i].direction - node.direction;
      node.spread2 += points[i].weight / float(weight) * glm::dot(off, off);
    }
    node.points = uint32_t(end - first);
    if (node.points > 1) {
      const glm::dvec3 size = high - low;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      const size_t middle = (first + end) / 2;
      std::nth_element(points.begin() + long(first), points.begin() + long(middle), points.begin() + long(end),
                       [&](const Point& a, const Point& b) { return a.direction[axis] < b.direction[axis]; });
      node.nodes += build(points, first, middle) + build(points, middle, end);
    }
    nodes_.push_back(node);
    return node.nodes;
  }
  std::vector<Node> nodes_;
};

// Takes texels out of a sky that are brighter than eight times the threshold of lights, down to that threshold.
BrightTree take_brightest(SkyLevel& sky) {
  const double threshold = light_threshold(sky);
  std::vector<BrightTree::Point> points;
  if (std::isfinite(threshold))
    for (int y = 0; y < sky.height; ++y)
      for (int x = 0; x < sky.width; ++x) {
        SkyTexel& t = sky.texels[size_t(y) * size_t(sky.width) + size_t(x)];
        const double light = luminance(t);
        if (!(light > 8 * threshold)) continue;
        const float over = float((light - threshold) / light), solid_angle = float(sky.solid_angle(y));
        points.push_back({glm::vec3(sky.direction(x, y)), (over * solid_angle) * t, float(light) * over * solid_angle});
        t = (1 - over) * t;
      }
  return BrightTree(std::move(points));
}

// One over the integral of a slice's lobe, c over k squared, over all directions.
double lobe_scale(double roughness) {
  // The samples of lobe_samples() have the density a2 / (4 pi k^2).
  const double a2 = std::pow(roughness, 4);
  double sum = 0;
  constexpr int count = 4096;
  for (int i = 0; i < count; ++i) {
    const double u = (i + 0.5) / count, n_l = 2 * (1 - u) / (1 + (a2 - 1) * u) - 1;
    if (n_l > 0) sum += n_l;
  }
  return a2 / (4 * pi * sum / count);
}

struct Tile {
  uint32_t x, y, size;
};

// Slices of one size beside each other, two of the largest in a row.
std::vector<Tile> place_tiles(uint32_t size, uint32_t& width, uint32_t& height) {
  std::vector<Tile> tiles;
  width = 2 * size, height = 0;
  uint32_t x = 0, y = 0, row = 0;
  for (uint32_t i = 0; i <= last_slice; ++i) {
    const uint32_t shift = i < 6 ? 0 : i < 8 ? 1 : i < 10 ? 2 : 3;
    const uint32_t side = std::min(size, std::max(size >> shift, 32u));
    if (x + side > width || (row != 0 && side != row)) x = 0, y += row, row = 0;
    tiles.push_back({x, y, side});
    row = side, x += side;
    height = y + row;
  }
  return tiles;
}

void filter_slice(FilteredSky& out, const Tile& tile, double roughness, uint32_t samples,
                  const std::vector<SkyLevel>& levels, const BrightTree& bright, double share_of_bright) {
  const float a2 = float(std::pow(roughness, 4)), scale = float(share_of_bright * lobe_scale(roughness));
  const std::vector<LobeSample> lobe = lobe_samples(roughness, samples, levels.front());
  const SkyReader sky(levels);
  tbb::parallel_for(0u, tile.size, [&](uint32_t y) {
    float* texel = out.texels.data() + (size_t(tile.y + y) * out.width + tile.x) * 4;
    for (uint32_t x = 0; x < tile.size; ++x, texel += 4) {
      const glm::dvec3 d = octahedral_direction(x, y, tile.size);
      const glm::mat3 axes = axes_about(d);
      SkyTexel sum{};
      for (const LobeSample& s : lobe) sum += s.weight * sky.sample(axes * s.l, s.lod);
      if (scale > 0 && !bright.empty()) sum += bright.seen(glm::vec3(d), a2, scale);
      std::memcpy(texel, &sum, 16);
    }
  });
}

// The part of the sky's lights that a slice leaves to them.
double share_of_lights(uint32_t slice) {
  const double range = shared::sky_lights_from - shared::sky_lights_after;
  return std::clamp((double(slice) - shared::sky_lights_after) / range, 0.0, 1.0);
}

// The sky that a slice is of: with all bright spots, half of their light, or none.
std::vector<SkyLevel> blended(const SkyLevel& all, const SkyLevel& rest, float share_of_all) {
  SkyLevel sky = rest;
  for (size_t i = 0; i < sky.texels.size(); ++i)
    sky.texels[i] = share_of_all * all.texels[i] + (1 - share_of_all) * rest.texels[i];
  return sky_pyramid(std::move(sky));
}

void sum_irradiance(FilteredSky& out, uint32_t side, const std::vector<SkyLevel>& rest) {
  out.irradiance_px = side + 2;
  out.irradiance.resize(size_t(out.irradiance_px) * out.irradiance_px * 4);
  size_t at = 0;
  while (rest[at].width > 128) ++at;
  const SkyLevel& sky = rest[at];
  struct Source {
    glm::vec3 direction;
    SkyTexel light;  // illuminance over pi
  };
  std::vector<Source> sources;
  for (int y = 0; y < sky.height; ++y)
    for (int x = 0; x < sky.width; ++x)
      sources.push_back({glm::vec3(sky.direction(x, y)), float(sky.solid_angle(y) / pi) * sky.at(x, y)});
  for (const shared::SkyLight& l : out.lights)
    sources.push_back({l.direction, SkyTexel{l.illuminance.x, l.illuminance.y, l.illuminance.z, 0} / float(pi)});
  tbb::parallel_for(0u, out.irradiance_px, [&](uint32_t y) {
    for (uint32_t x = 0; x < out.irradiance_px; ++x) {
      const glm::vec3 n(octahedral_direction(x, y, out.irradiance_px));
      SkyTexel sum{};
      for (const Source& s : sources) sum += std::max(glm::dot(n, s.direction), 0.0f) * s.light;
      std::memcpy(out.irradiance.data() + (size_t(y) * out.irradiance_px + x) * 4, &sum, 16);
    }
  });
}

// Height-correlated Smith over 4 n.l n.v (Heitz 2014).
double smith_v(double n_l, double n_v, double a2) {
  return 0.5 / (n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) + n_v * std::sqrt(n_l * n_l * (1 - a2) + a2));
}

// How wide a slice's lobe is: the mean square of a coordinate across its middle.
double spread_of_slice(double roughness) {
  const double a2 = std::pow(roughness, 4);
  double sum = 0, all = 0;
  constexpr int count = 4096;
  for (int i = 0; i < count; ++i) {
    const double u = (i + 0.5) / count, n_h2 = (1 - u) / (1 + (a2 - 1) * u), n_l = 2 * n_h2 - 1;
    if (!(n_l > 0)) continue;
    all += n_l, sum += n_l * (1 - n_l * n_l) / 2;
  }
  return sum / all;
}

// Of a lobe that is seen at n.v: the mean direction (in the plane of n and v, n up, v on the side of x) and the mean
// square of a coordinate across it.
struct LobeShape {
  double x = 0, z = 1, spread = 0;
};
// What f0 scales and what f90 scales of the reflected light (split_sum.h): the same lobe times 1 - F and F, of which
// the second, the light of grazing half vectors, leans further from the normal.
std::array<LobeShape, 2> lobe_shapes(double roughness, double n_v) {
  const double a2 = std::pow(roughness, 4), sin_v = std::sqrt(1 - n_v * n_v);
  constexpr int rings = 64, sectors = 48;
  struct Sums {
    double all = 0, x = 0, z = 0, xx = 0, xz = 0, yy = 0, zz = 0;
  };
  std::array<Sums, 2> sums;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {  // half of the plane's two sides
      // Denser towards the lobe's flanks, which are wide and hold most of the second moments.
      const double t = 1 - (i + 0.5) / rings, u = 1 - t * t * t, phi = pi * (j + 0.5) / sectors;
      const double n_h2 = (1 - u) / (1 + (a2 - 1) * u), n_h = std::sqrt(n_h2), across = std::sqrt(1 - n_h2);
      const double v_h = sin_v * across * std::cos(phi) + n_v * n_h;
      const glm::dvec3 l(2 * v_h * across * std::cos(phi) - sin_v, 2 * v_h * across * std::sin(phi),
                         2 * v_h * n_h - n_v);
      if (!(v_h > 0) || !(l.z > 0)) continue;
      const double whole = 3 * t * t * smith_v(l.z, n_v, a2) * l.z * v_h / n_h, fresnel = std::pow(1 - v_h, 5);
      for (size_t part = 0; part < 2; ++part) {
        const double weight = whole * (part == 0 ? 1 - fresnel : fresnel);
        Sums& s = sums[part];
        s.all += weight, s.x += weight * l.x, s.z += weight * l.z;
        s.xx += weight * l.x * l.x, s.xz += weight * l.x * l.z, s.yy += weight * l.y * l.y, s.zz += weight * l.z * l.z;
      }
    }
  std::array<LobeShape, 2> shapes;
  for (size_t part = 0; part < 2; ++part) {
    const Sums& s = sums[part];
    const double length = std::hypot(s.x, s.z);
    LobeShape& shape = shapes[part];
    shape = {s.x / length, s.z / length, 0};
    const double along = shape.z * shape.z * s.xx - 2 * shape.x * shape.z * s.xz + shape.x * shape.x * s.zz;
    shape.spread = (along + s.yy) / (2 * s.all);
  }
  return shapes;
}

std::vector<float> lobe_table() {
  constexpr uint32_t size = shared::sky_lobe_size;
  std::array<double, shared::sky_slice_count> spread;
  for (uint32_t i = 0; i <= last_slice; ++i) spread[i] = spread_of_slice(roughness_of_slice(i));
  std::vector<float> table(4 * size * size);
  tbb::parallel_for(0u, size, [&](uint32_t row) {
    const double low = std::sqrt(shared::least_roughness);
    const double roughness = std::pow(low + (1 - low) * row / (size - 1), 2);
    for (uint32_t column = 0; column < size; ++column) {
      const double n_v = std::clamp(std::pow(double(column) / (size - 1), 2), 1e-3, 0.9995);
      const std::array<LobeShape, 2> shapes = lobe_shapes(roughness, n_v);
      for (size_t part = 0; part < 2; ++part) {
        const LobeShape& shape = shapes[part];
        const double aside = std::max(-shape.x / shape.z, 0.0);  // below 0 by the samples' noise alone
        uint32_t i = 0;
        while (i + 1 < last_slice && spread[i + 1] < shape.spread) ++i;
        const double between = std::clamp((shape.spread - spread[i]) / (spread[i + 1] - spread[i]), 0.0, 1.0);
        float* const entry = &table[4 * (row * size + column) + 2 * part];
        // From above, the second part is all around the horizon: it has no middle, and little weight.
        entry[0] = float(std::min(aside / (aside * (1 - n_v) + std::sqrt(1 - n_v * n_v)), 1.6));
        entry[1] = float(i + between);
      }
    }
  });
  return table;
}

// Slices finer than the sky's own texels would hold no more.
uint32_t side_of(const SkyLevel& sky, const IblKnobs& knobs) {
  return std::bit_floor(std::min(uint32_t(knobs.size_px), std::max(uint32_t(sky.width) / 2, 32u)));
}

}  // namespace

double slice_of_roughness(double roughness) {
  return std::clamp(last_slice + shared::sky_slices_per_octave * std::log2(std::max(roughness, 1e-4)), 0.0,
                    double(last_slice));
}

DividedSky divide_sky(const DecodedImage& sky, const IblKnobs& knobs) {
  SkyParts parts = take_lights(sky_level(sky), knobs.lights);
  return {sky_pyramid(std::move(parts.rest)), std::move(parts.lights)};
}

FilteredSky prefilter_sky(const DecodedImage& image, const IblKnobs& knobs) {
  CHECK(image.format == DecodedImage::Format::rgba32f || image.format == DecodedImage::Format::rgba16f);
  FilteredSky out;
  const SkyLevel sky = sky_level(image);
  const bool lights = IblMethod(knobs.method) == IblMethod::lobe;
  SkyParts parts = take_lights(sky, lights ? knobs.lights : 0);
  out.lights = std::move(parts.lights);
  const uint32_t side = side_of(sky, knobs);
  const std::vector<Tile> tiles = place_tiles(side, out.width, out.height);
  out.texels.resize(size_t(out.width) * out.height * 4);
  SkyLevel dimmed = sky;
  const BrightTree bright = take_brightest(dimmed);
  const bool lit = !out.lights.empty();
  std::vector<SkyLevel> levels;
  double whole = -1;  // how much of the lights the levels hold
  bool wide = false;  // what the tree has they lack
  for (uint32_t i = 0; i <= last_slice; ++i) {
    const Tile& tile = tiles[i];
    const double roughness = roughness_of_slice(i);
    const double of_lights = lit ? share_of_lights(i) : 0;
    // Points of the tree are texels: lobes are wider than a few. A lobe is about 2.5 alpha wide.
    const bool now_wide = !bright.empty() && roughness * roughness > 2 * pi / sky.width;
    if (whole != 1 - of_lights || wide != now_wide)
      levels = blended(now_wide ? dimmed : sky, parts.rest, float(1 - of_lights));
    whole = 1 - of_lights, wide = now_wide;
    const uint64_t samples = uint64_t(knobs.filter_samples) * (side / tile.size);
    filter_slice(out, tile, roughness, uint32_t(samples), levels, bright, wide ? whole : 0);
    const glm::vec2 size(out.width, out.height);
    out.slices.push_back({(glm::vec2(tile.x, tile.y) + 1.0f) / size, glm::vec2(tile.size - 2) / size});
  }
  if (knobs.irradiance_px > 0) sum_irradiance(out, uint32_t(knobs.irradiance_px), sky_pyramid(std::move(parts.rest)));
  out.lobes = lobe_table();
  return out;
}

}  // namespace candela
