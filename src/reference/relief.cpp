#include "reference/relief.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace candela::reference {
namespace {

constexpr int most_cells = 1 << 20;  // no end of a loop must hang on arithmetic

// A line in the layer's own coordinates: weights, depth, and texels (from the middle of the first) as functions of t.
struct Line {
  glm::dvec3 at{0}, by{0};  // weights and depth
  glm::dvec2 texel{0}, texels{0};
  glm::dvec2 uv{0}, uvs{0};
  bool is_flat = false;  // the layer has no inside: a triangle without area, or no depth
  double depth(double t) const { return at.z + t * by.z; }
};

glm::dvec2 texel_of(const ReliefLayer& l, glm::dvec2 uv) {
  return transformed_uv(*l.slot, uv) * glm::dvec2(l.heights->width(), l.heights->height()) - 0.5;
}

Line line_in(const ReliefLayer& l, glm::dvec3 origin, glm::dvec3 direction) {
  Line line;
  const glm::dvec3 across = glm::cross(l.edge[0], l.edge[1]);
  const double volume = glm::dot(across, l.below);
  const double inverse = 1 / volume;
  if (!(volume != 0) || !std::isfinite(inverse)) {
    line.is_flat = true;
    return line;
  }
  const glm::dvec3 rows[3] = {glm::cross(l.edge[1], l.below) * inverse, glm::cross(l.below, l.edge[0]) * inverse,
                              across * inverse};
  for (int i = 0; i < 3; ++i)
    line.at[i] = glm::dot(rows[i], origin - l.corner), line.by[i] = glm::dot(rows[i], direction);
  line.uv = l.uv + line.at.x * l.uv_edge[0] + line.at.y * l.uv_edge[1];
  line.uvs = line.by.x * l.uv_edge[0] + line.by.y * l.uv_edge[1];
  line.texel = texel_of(l, line.uv);
  line.texels = texel_of(l, line.uv + line.uvs) - line.texel;
  return line;
}

// Texels at the corners of a cell.
struct Cell {
  double h00, h10, h01, h11;
};
Cell cell_at(const ReliefLayer& l, glm::dvec2 low) {
  const glm::dvec2 size(l.heights->width(), l.heights->height());
  const auto at = [&](double x, double y) {
    Sampler nearest = *l.sampler;
    nearest.mag = Filter::nearest;
    return l.heights->sample((low + glm::dvec2(x, y) + 0.5) / size, nearest).x;
  };
  return {at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
}
double in_cell(const Cell& c, glm::dvec2 f) {
  return glm::mix(glm::mix(c.h00, c.h10, f.x), glm::mix(c.h01, c.h11, f.x), f.y);
}

ReliefHit hit_at(const Line& line, double t) {
  return {t, {line.at.x + t * line.by.x, line.at.y + t * line.by.y}, line.depth(t)};
}

}  // namespace

double ReliefLayer::height(glm::dvec2 weights) const {
  const glm::dvec2 at = texel_of(*this, uv + weights.x * uv_edge[0] + weights.y * uv_edge[1]), low = glm::floor(at);
  return in_cell(cell_at(*this, low), at - low);
}

glm::dvec2 ReliefLayer::slope(glm::dvec2 weights, bool smooth) const {
  const glm::dvec2 at = texel_of(*this, uv + weights.x * uv_edge[0] + weights.y * uv_edge[1]);
  glm::dvec2 by_texel;
  if (smooth) {
    const auto h = [&](double x, double y) {
      const glm::dvec2 there = at + glm::dvec2(x, y), low = glm::floor(there);
      return in_cell(cell_at(*this, low), there - low);
    };
    by_texel = glm::dvec2(h(1, 0) - h(-1, 0), h(0, 1) - h(0, -1)) / 2.0;
  } else {
    const glm::dvec2 low = glm::floor(at), f = at - low;
    const Cell c = cell_at(*this, low);
    by_texel = {glm::mix(c.h10 - c.h00, c.h11 - c.h01, f.y), glm::mix(c.h01 - c.h00, c.h11 - c.h10, f.x)};
  }
  const glm::dvec2 origin = texel_of(*this, uv);
  return {glm::dot(by_texel, texel_of(*this, uv + uv_edge[0]) - origin),
          glm::dot(by_texel, texel_of(*this, uv + uv_edge[1]) - origin)};
}

glm::dvec3 ReliefLayer::leaned(glm::dvec3 normal, glm::dvec2 slope) const {
  // The surface's sides are edge + slope * below: what their product has beside that of the edges.
  const glm::dvec3 across = glm::cross(edge[0], edge[1]);
  const double area = glm::length(across);
  if (!(area > 0)) return normal;
  glm::dvec3 lean = (slope.y * glm::cross(edge[0], below) + slope.x * glm::cross(below, edge[1])) / area;
  if (glm::dot(across, below) > 0) lean = -lean;
  return normal + lean;
}

std::optional<ReliefHit> meet_relief(const ReliefLayer& layer, glm::dvec3 origin, glm::dvec3 direction, double t_min,
                                     double t_max) {
  const Line line = line_in(layer, origin, direction);
  if (line.is_flat) return {};
  double begin = t_min, end = t_max;
  bool above = false;  // the line is known to be
  const auto enter = [&](double t) {
    if (t > begin) begin = t, above = true;
  };
  // Between surface and floor, and within the bounds.
  double floor_t = std::numeric_limits<double>::infinity();
  if (line.by.z > 0) {
    enter(-line.at.z / line.by.z);
    floor_t = (1 - line.at.z) / line.by.z;
    end = std::min(end, floor_t);
  } else if (line.by.z < 0) {
    const double from_behind = (1 - line.at.z) / line.by.z;
    if (from_behind > begin) {  // the floor, which is solid
      const ReliefHit met = hit_at(line, from_behind);
      const glm::dvec2 uv = line.uv + from_behind * line.uvs;
      const bool there = !layer.ends || (glm::all(glm::greaterThanEqual(uv, layer.least_uv)) &&
                                         glm::all(glm::lessThanEqual(uv, layer.most_uv)));
      if (there) return from_behind <= t_max ? std::optional(met) : std::nullopt;
      begin = from_behind, above = true;
    }
    end = std::min(end, -line.at.z / line.by.z);
  } else if (!(line.at.z >= 0 && line.at.z <= 1)) {
    return {};
  }
  if (layer.ends)
    for (int a = 0; a < 2; ++a) {
      const double slack = 1e-9 * (1 + std::abs(layer.least_uv[a]) + std::abs(layer.most_uv[a]));
      const double low = layer.least_uv[a] - slack - line.uv[a], high = layer.most_uv[a] + slack - line.uv[a];
      if (line.uvs[a] == 0) {
        if (!(low <= 0 && high >= 0)) return {};
        continue;
      }
      const double t0 = low / line.uvs[a], t1 = high / line.uvs[a];
      enter(std::min(t0, t1));
      end = std::min(end, std::max(t0, t1));
    }
  if (!(begin <= end)) return {};

  double t = begin;
  for (int cells = 0; cells < most_cells; ++cells) {
    // A little way on, so that the cell is the one ahead.
    glm::dvec2 low;
    double next = end;
    for (int a = 0; a < 2; ++a) {
      const double at = line.texel[a] + t * line.texels[a];
      low[a] = std::floor(at);
      if (line.texels[a] == 0) continue;
      const double slack = 1e-12 * (1 + std::abs(at));
      if (line.texels[a] > 0 && low[a] + 1 - at <= slack) low[a] += 1;
      if (line.texels[a] < 0 && at - low[a] <= slack) low[a] -= 1;
      const double boundary = (low[a] + (line.texels[a] > 0 ? 1 : 0) - line.texel[a]) / line.texels[a];
      next = std::min(next, std::max(boundary, t));
    }
    // Depth less height along the cell, s from t: a + b s + c s^2.
    const Cell cell = cell_at(layer, low);
    const glm::dvec2 f = line.texel + t * line.texels - low, d = line.texels;
    const double twist = cell.h00 - cell.h10 - cell.h01 + cell.h11;
    const double hx = cell.h10 - cell.h00, hy = cell.h01 - cell.h00;
    const double a = line.depth(t) - (cell.h00 + hx * f.x + hy * f.y + twist * f.x * f.y);
    const double b = line.by.z - (hx * d.x + hy * d.y + twist * (f.x * d.y + f.y * d.x)), c = -twist * d.x * d.y;
    const double length = next - t;
    double cuts[4] = {0, length, length, length};
    int count = 1;
    const double root2 = b * b - 4 * a * c;
    if (root2 >= 0) {
      const double q = -0.5 * (b + std::copysign(std::sqrt(root2), b));
      double roots[2] = {c != 0 ? q / c : std::numeric_limits<double>::infinity(),
                         q != 0 ? a / q : std::numeric_limits<double>::infinity()};
      if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
      for (const double root : roots)
        if (root > 0 && root < length) cuts[count++] = root;
    }
    cuts[count] = length;
    for (int i = 0; i < count; ++i) {
      const double s = 0.5 * (cuts[i] + cuts[i + 1]);
      const bool below = a + s * (b + s * c) > 0 && length > 0;
      if (below && above) return hit_at(line, t + cuts[i]);
      if (!below && length > 0) above = true;
    }
    if (next >= end) break;
    t = next;
  }
  // Nothing is below the floor.
  if (end == floor_t && above) return hit_at(line, floor_t);
  return {};
}

ReliefHit refined(const ReliefLayer& layer, glm::dvec3 origin, glm::dvec3 direction, const ReliefHit& near) {
  const Line line = line_in(layer, origin, direction);
  if (line.is_flat) return near;
  const auto off = [&](double t) {
    const ReliefHit at = hit_at(line, t);
    return at.depth - layer.height(at.weights);
  };
  double low = near.t * (1 - 4e-6), high = near.t * (1 + 4e-6);
  if (!(off(low) < 0 && off(high) >= 0)) {
    ReliefHit at = hit_at(line, near.t);
    at.depth = layer.height(at.weights);
    return at;
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (off(middle) < 0 ? low : high) = middle;
  }
  return hit_at(line, high);
}

}  // namespace candela::reference
