#include "demoscenes/implicit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "base/rng.h"

namespace candela {
namespace {

// The lattice point's gradient times the way to p.
double slope_at(glm::i64vec3 node, glm::dvec3 way, uint64_t seed) {
  const uint64_t hash = mixed_bits(uint64_t(node.x) * 0x9e3779b97f4a7c15u + uint64_t(node.y) * 0xc2b2ae3d27d4eb4fu +
                                   uint64_t(node.z) * 0x165667b19e3779f9u + seed * 0xd6e8feb86659fd93u);
  const double a = hash & 1 ? 1 : -1, b = hash & 2 ? 1 : -1;
  switch (hash >> 8 & 3) {
    case 0:
      return a * way.x + b * way.y;
    case 1:
      return a * way.y + b * way.z;
    case 2:
      return a * way.z + b * way.x;
    default:
      return hash & 4 ? a * way.x + b * way.y : a * way.y + b * way.z;
  }
}

glm::ivec3 axes(int axis, int along, int second, int third) {
  glm::ivec3 v;
  v[axis] = along, v[(axis + 1) % 3] = second, v[(axis + 2) % 3] = third;
  return v;
}

class Mesher {
 public:
  Mesher(const Field& field, glm::dvec3 low, glm::dvec3 high, double cell_m)
      : field_(field), low_(low), cell_m_(cell_m), cells_(glm::ceil((high - low) / cell_m)) {
    const glm::ivec3 n = cells_ + 1;
    values_.assign(size_t(n.x) * size_t(n.y) * size_t(n.z), std::numeric_limits<float>::quiet_NaN());
  }

  ImplicitMesh mesh(double slope) {
    std::vector<glm::ivec3> blocks;
    for (int z = 0; z < cells_.z; z += block)
      for (int y = 0; y < cells_.y; y += block)
        for (int x = 0; x < cells_.x; x += block) {
          const glm::dvec3 middle = place(glm::dvec3(x, y, z) + block / 2.0);
          if (std::abs(field_(middle)) < slope * cell_m_ * block * 0.8661) blocks.emplace_back(x, y, z);
        }
    for (const glm::ivec3& first : blocks) evaluate(first);
    for (const glm::ivec3& first : blocks) each(first, [&](glm::ivec3 cell) { add_vertices(cell); });
    for (const glm::ivec3& first : blocks) each(first, [&](glm::ivec3 cell) { add_faces(cell); });
    return std::move(mesh_);
  }

 private:
  static constexpr int block = 8;
  static constexpr uint32_t none = 0xffffffff;

  glm::dvec3 place(glm::dvec3 node) const { return low_ + cell_m_ * node; }
  size_t index(glm::ivec3 n) const {
    return size_t(n.x) + size_t(cells_.x + 1) * (size_t(n.y) + size_t(cells_.y + 1) * size_t(n.z));
  }
  float value(glm::ivec3 n) const { return values_[index(n)]; }
  bool inside(glm::ivec3 n) const { return value(n) < 0; }

  template <class F>
  void each(glm::ivec3 first, F&& f) const {
    const glm::ivec3 end = glm::min(first + block, cells_);
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) f(glm::ivec3(x, y, z));
  }
  void evaluate(glm::ivec3 first) {
    const glm::ivec3 end = glm::min(first + block, cells_);
    for (int z = first.z; z <= end.z; ++z)
      for (int y = first.y; y <= end.y; ++y)
        for (int x = first.x; x <= end.x; ++x) {
          float& v = values_[index({x, y, z})];
          if (std::isnan(v)) v = float(field_(place({x, y, z})));
        }
  }

  // A cell's edge along an axis, at bits of the two axes after it.
  static int edge(int axis, int second, int third) { return axis * 4 + second + 2 * third; }

  void add_vertices(glm::ivec3 cell) {
    std::array<int, 12> root;
    bool any = false;
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 4; ++k) {
        const bool cut = inside(cell + axes(axis, 0, k & 1, k >> 1)) != inside(cell + axes(axis, 1, k & 1, k >> 1));
        root[size_t(axis * 4 + k)] = cut ? axis * 4 + k : -1;
        any |= cut;
      }
    if (!any) return;
    const auto find = [&](int e) {
      while (root[size_t(e)] != e) e = root[size_t(e)];
      return e;
    };
    const auto unite = [&](int a, int b) { root[size_t(find(a))] = find(b); };
    // What crosses a face on two edges is one piece; of four, each corner that is inside is cut off, on both sides.
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        std::array<int, 4> found;
        size_t count = 0;
        for (int bit = 0; bit < 2; ++bit)
          for (const int e : {edge(b, bit, side), edge(c, side, bit)})
            if (root[size_t(e)] >= 0) found[count++] = e;
        if (count == 2) unite(found[0], found[1]);
        if (count == 4)
          for (int corner = 0; corner < 4; ++corner)
            if (inside(cell + axes(axis, side, corner & 1, corner >> 1)))
              unite(edge(b, corner >> 1, side), edge(c, side, corner & 1));
      }
    std::array<uint32_t, 12>& vertices = vertices_[index(cell)];
    vertices.fill(none);
    for (int piece = 0; piece < 12; ++piece) {
      if (root[size_t(piece)] < 0 || find(piece) != piece) continue;
      glm::dvec3 sum(0);
      int count = 0;
      for (int e = 0; e < 12; ++e) {
        if (root[size_t(e)] < 0 || find(e) != piece) continue;
        const glm::ivec3 from = cell + axes(e / 4, 0, e & 1, e >> 1 & 1), to = cell + axes(e / 4, 1, e & 1, e >> 1 & 1);
        const double a = value(from), b = value(to);
        sum += glm::mix(glm::dvec3(from), glm::dvec3(to), a / (a - b));
        ++count;
        vertices[size_t(e)] = uint32_t(mesh_.position.size());
      }
      add_vertex(place(sum / double(count)));
    }
  }

  glm::dvec3 gradient(glm::dvec3 p) const {
    const double step = 0.2 * cell_m_;
    glm::dvec3 g;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 shift(0);
      shift[axis] = step;
      g[axis] = (field_(p + shift) - field_(p - shift)) / (2 * step);
    }
    return g;
  }

  void add_vertex(glm::dvec3 p) {
    glm::dvec3 g = gradient(p);
    // Onto the surface, but not out of the cell's neighbourhood.
    const double square = std::max(glm::dot(g, g), 1e-6), off = field_(p);
    glm::dvec3 step = -g * (off / square);
    const double most = 0.35 * cell_m_, length = glm::length(step);
    if (length > most) step *= most / length;
    p += step;
    g = gradient(p);
    const double size = glm::length(g);
    mesh_.position.push_back(p);
    mesh_.normal.push_back(size > 1e-9 ? g / size : glm::dvec3(0, 1, 0));
  }

  void add_faces(glm::ivec3 node) {
    for (int axis = 0; axis < 3; ++axis) {
      const glm::ivec3 next = node + axes(axis, 1, 0, 0);
      if (inside(node) == inside(next)) continue;
      std::array<uint32_t, 4> corners;
      constexpr std::array<glm::ivec2, 4> around{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      bool whole = true;
      for (size_t k = 0; k < 4; ++k) {
        const glm::ivec3 cell = node - axes(axis, 0, around[k].x, around[k].y);
        if (glm::any(glm::lessThan(cell, glm::ivec3(0)))) {
          whole = false;
          break;
        }
        const auto at = vertices_.find(index(cell));
        whole &= at != vertices_.end();
        if (whole) corners[k] = at->second[size_t(edge(axis, around[k].x, around[k].y))];
      }
      if (!whole) continue;
      if (!inside(node)) std::swap(corners[1], corners[3]);
      const auto apart = [&](size_t a, size_t b) {
        const glm::dvec3 way = mesh_.position[corners[a]] - mesh_.position[corners[b]];
        return glm::dot(way, way);
      };
      const bool other = apart(1, 3) < apart(0, 2);
      for (const size_t k : other ? std::array<size_t, 6>{0, 1, 3, 1, 2, 3} : std::array<size_t, 6>{0, 1, 2, 0, 2, 3})
        mesh_.index.push_back(corners[k]);
    }
  }

  const Field& field_;
  glm::dvec3 low_;
  double cell_m_;
  glm::ivec3 cells_;
  std::vector<float> values_;  // of nodes near the surface
  std::unordered_map<size_t, std::array<uint32_t, 12>> vertices_;
  ImplicitMesh mesh_;
};

}  // namespace

double noise3(glm::dvec3 p, uint64_t seed) {
  const glm::dvec3 base = glm::floor(p), f = p - base;
  const glm::dvec3 s = f * f * f * (f * (6.0 * f - 15.0) + 10.0);
  const glm::i64vec3 node(base);
  double sum[8];
  for (int c = 0; c < 8; ++c) {
    const glm::i64vec3 corner(c & 1, c >> 1 & 1, c >> 2);
    sum[c] = slope_at(node + corner, f - glm::dvec3(corner), seed);
  }
  const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
  return mix(mix(mix(sum[0], sum[1], s.x), mix(sum[2], sum[3], s.x), s.y),
             mix(mix(sum[4], sum[5], s.x), mix(sum[6], sum[7], s.x), s.y), s.z);
}

double fbm3(glm::dvec3 p, int octaves, uint64_t seed) {
  double sum = 0, weight = 0.5;
  for (int i = 0; i < octaves; ++i, weight /= 2, p = 2.03 * p + 17.3) sum += weight * noise3(p, seed + uint64_t(i));
  return sum;
}

double ridged3(glm::dvec3 p, int octaves, uint64_t seed) {
  double sum = 0, weight = 0.5, whole = 0;
  for (int i = 0; i < octaves; ++i, whole += weight, weight /= 2, p = 2.03 * p + 17.3)
    sum += weight * (1 - std::abs(noise3(p, seed + uint64_t(i))));
  return sum / whole;
}

double to_ellipsoid(glm::dvec3 p, glm::dvec3 centre, glm::dvec3 radii) {
  p -= centre;
  const double k = glm::length(p / radii), g = glm::length(p / (radii * radii));
  return g > 1e-12 ? k * (k - 1) / g : -std::min({radii.x, radii.y, radii.z});
}

// Off a right circular cone with balls at its ends, but for the tilt of its tangent: within a few hundredths for the
// slim ones that bodies have.
double to_round_cone(glm::dvec3 p, glm::dvec3 a, double radius_a, glm::dvec3 b, double radius_b, double* along) {
  const glm::dvec3 way = b - a, from = p - a;
  const double t = std::clamp(glm::dot(from, way) / std::max(glm::dot(way, way), 1e-12), 0.0, 1.0);
  if (along) *along = t;
  return glm::length(from - way * t) - (radius_a + (radius_b - radius_a) * t);
}

// After Quilez.
double to_triangle(glm::dvec3 p, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 ba = b - a, pa = p - a, cb = c - b, pb = p - b, ac = a - c, pc = p - c, normal = glm::cross(ba, ac);
  const auto side = [&](glm::dvec3 edge, glm::dvec3 from) { return glm::dot(glm::cross(edge, normal), from) > 0; };
  const auto to_edge = [](glm::dvec3 edge, glm::dvec3 from) {
    const glm::dvec3 off = edge * std::clamp(glm::dot(edge, from) / glm::dot(edge, edge), 0.0, 1.0) - from;
    return glm::dot(off, off);
  };
  if (side(ba, pa) && side(cb, pb) && side(ac, pc)) return std::abs(glm::dot(normal, pa)) / glm::length(normal);
  return std::sqrt(std::min({to_edge(ba, pa), to_edge(cb, pb), to_edge(ac, pc)}));
}

double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k * 0.25;
}
double smooth_max(double a, double b, double k) { return -smooth_min(-a, -b, k); }

ImplicitMesh mesh_implicit(const Field& field, glm::dvec3 low, glm::dvec3 high, double cell_m, double slope) {
  return Mesher(field, low, high, cell_m).mesh(slope);
}

int box_group(glm::dvec3 n) {
  const glm::dvec3 a = glm::abs(n);
  const int axis = a.x > a.y && a.x > a.z ? 0 : a.y > a.z ? 1 : 2;
  return axis * 2 + (n[axis] < 0 ? 1 : 0);
}

glm::dvec2 box_uv(glm::dvec3 p, int group) {
  const double sign = group & 1 ? -1 : 1;
  switch (group >> 1) {
    case 0:
      return {-sign * p.z, -p.y};
    case 1:
      return {p.x, sign * p.z};
    default:
      return {sign * p.x, -p.y};
  }
}

Shape textured(const ImplicitMesh& mesh, const Texturing& t) {
  Shape shape;
  std::map<std::pair<uint32_t, int>, uint32_t> made;
  for (size_t i = 0; i < mesh.index.size(); i += 3) {
    glm::dvec3 middle(0), normal(0);
    for (size_t k = 0; k < 3; ++k) middle += mesh.position[mesh.index[i + k]], normal += mesh.normal[mesh.index[i + k]];
    middle /= 3.0;
    const int group = t.group(middle, normal);
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = mesh.index[i + k];
      const auto [at, is_new] = made.try_emplace({v, group}, uint32_t(shape.position.size()));
      if (is_new) {
        shape.position.push_back(mesh.position[v]);
        shape.normal.push_back(mesh.normal[v]);
        shape.uv.push_back(t.uv(mesh.position[v], middle, group));
        shape.color.emplace_back(t.color(mesh.position[v], mesh.normal[v]), 1);
      }
      shape.index.push_back(at->second);
    }
  }
  return shape;
}

}  // namespace candela
