#include "scene/metaballs.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "scene/deformation_bounds.h"
#include "scene/pose.h"

namespace candela {
namespace {

constexpr int cells = metaball_block_cells, nodes = cells + 1;
constexpr float least_inside = 1e-30f;       // F that is inside; 0 is not, nor what devices may flush to it
constexpr int halvings = 4;                  // of an edge, before its vertex is interpolated
constexpr float least_along = 1.0f / 4096;   // of an edge, before and behind a vertex
constexpr double most_reach_cells = 0x1p20;  // of vertices from the lattice's origin, for floats
constexpr uint64_t triangles_of_cell = 6 * 2;

// How much a kernel's slope changes at most over a change of q where what is left of 1 - q^2 is in a range: its second
// derivatives are 6 u^2 across and 24 u - 30 u^2 along the radius.
double most_bent(double u_low, double u_high) {
  const auto along = [](double u) { return std::abs(24 * u - 30 * u * u); };
  const double largest = u_low < 0.4 && u_high > 0.4 ? 4.8 : 0;  // between the ends
  return std::max({6 * u_high * u_high, along(u_low), along(u_high), largest});
}

double cube(double u) { return u * u * u; }

// A ball as the search for blocks takes it, in cells.
struct BoxedBall {
  glm::dvec3 centre;
  double inverse_radius, strength;
};

// The least and greatest value that a sum of kernels may have in a box: where each takes its own, and by the slope in
// the middle and how much that may change.
class Range {
 public:
  Range(glm::dvec3 low, glm::dvec3 high) : middle_(0.5 * (low + high)), half_(0.5 * (high.x - low.x)) {}
  // u: what is left of 1 - q^2, at least 0, in the box's points nearest to the centre and farthest from it.
  void add(const BoxedBall& ball, double nearest_u, double farthest_u) {
    const double s = ball.strength, most = cube(nearest_u), least = cube(farthest_u);
    low_ += s * (s > 0 ? least : most), high_ += s * (s > 0 ? most : least);
    const glm::dvec3 d = ball.inverse_radius * (middle_ - ball.centre);
    const double u = std::max(1 - glm::dot(d, d), 0.0);
    value_ += s * u * u * u, slope_ -= 6 * s * u * u * ball.inverse_radius * d;
    bent_ += std::abs(s) * ball.inverse_radius * ball.inverse_radius * most_bent(farthest_u, nearest_u);
    magnitude_ += std::abs(s), ++count_;
    any_positive_ |= s > 0;
  }
  bool may_cross(double threshold) const {
    const glm::dvec3 steep = glm::abs(slope_);
    const double change = half_ * (steep.x + steep.y + steep.z) + 1.5 * half_ * half_ * bent_;
    const double rounding = magnitude_ * double(count_ + 16) * 0x1p-22;  // of the device's sums
    return any_positive_ && std::min(high_, value_ + change) + rounding > threshold &&
           std::max(low_, value_ - change) - rounding <= threshold;
  }

 private:
  glm::dvec3 middle_;
  double half_;
  double low_ = 0, high_ = 0, value_ = 0, bent_ = 0, magnitude_ = 0;
  glm::dvec3 slope_{0};
  int count_ = 0;
  bool any_positive_ = false;
};

LatticeBall in_cells(const PosedBall& ball, double cell_m, glm::dvec3 origin_m) {
  const double radius = ball.radius_m / cell_m;
  return {glm::vec3((ball.centre - origin_m) / cell_m), float(1 / (radius * radius)), float(ball.strength)};
}

// The blocks of a lattice that the surface may touch. What it works on is kept by each thread, so that a frame like the
// one before allocates nothing.
class Blocks {
 public:
  // False: there are too many.
  bool fill(std::span<const PosedBall> balls, double threshold, int blocks_across, MetaballLattice& out) {
    threshold_ = double(float(threshold)), out_ = &out, fits_ = true;
    balls_.clear(), near_.clear();
    const glm::dvec3 origin_m = out.origin_m();
    for (const PosedBall& ball : balls) {
      const LatticeBall b = in_cells(ball, out.cell_m, origin_m);
      near_.push_back(uint32_t(balls_.size()));
      balls_.push_back({glm::dvec3(b.centre), std::sqrt(double(b.inverse_square_radius)), double(b.strength)});
    }
    visit(glm::ivec3(0), cells * int(std::bit_ceil(unsigned(std::max(blocks_across, 1)))), 0, near_.size());
    return fits_;
  }

 private:
  // In Morton order, which depends on the balls and the cell alone. begin, end: of near_, the balls that may touch what
  // is around; its own go behind them, and away again.
  void visit(glm::ivec3 first_cell, int size, size_t begin, size_t end) {
    if (fits_ && may_cross(first_cell, size, begin, end)) enter(first_cell, size, end);
    near_.resize(end);
  }
  void enter(glm::ivec3 first_cell, int size, size_t begin) {
    if (size == 2) {
      out_->most_triangles += 8 * triangles_of_cell;
      return;
    }
    const size_t end = near_.size();
    if (size == cells) {
      if (out_->blocks.size() == most_metaball_blocks) {
        fits_ = false;
        return;
      }
      out_->blocks.push_back({first_cell, uint32_t(out_->ball_lists.size()), uint32_t(end - begin)});
      for (size_t i = begin; i < end; ++i) out_->ball_lists.push_back(near_[i]);
    }
    for (int child = 0; child < 8; ++child)
      visit(first_cell + glm::ivec3(child & 1, child >> 1 & 1, child >> 2) * (size / 2), size / 2, begin, end);
  }

  bool may_cross(glm::ivec3 first_cell, int size, size_t begin, size_t end) {
    const glm::dvec3 low(first_cell), high(first_cell + size);
    Range sum(low, high);
    for (size_t k = begin; k < end; ++k) {
      const BoxedBall& ball = balls_[near_[k]];
      const glm::dvec3 to = glm::max(glm::max(low - ball.centre, ball.centre - high), glm::dvec3(0));
      const double square = ball.inverse_radius * ball.inverse_radius, nearest = square * glm::dot(to, to);
      // What rounds beyond the support contributes nothing that is told from 0.
      if (!(nearest < (1 + 1e-6) * (1 + 1e-6)) || ball.strength == 0) continue;
      const glm::dvec3 far = glm::max(glm::abs(low - ball.centre), glm::abs(high - ball.centre));
      sum.add(ball, std::max(1 - nearest, 0.0), std::max(1 - square * glm::dot(far, far), 0.0));
      near_.push_back(near_[k]);
    }
    return sum.may_cross(threshold_);
  }

  std::vector<BoxedBall> balls_;
  std::vector<uint32_t> near_;
  double threshold_ = 0;
  MetaballLattice* out_ = nullptr;
  bool fits_ = true;
};

// What follows is the arithmetic of shaders/lib/metaballs.glsl: sums, differences and products, which every device
// rounds alike, in the same order.

float field_at(const std::vector<LatticeBall>& balls, std::span<const uint32_t> list, float threshold, glm::vec3 p) {
  float sum = 0;
  for (const uint32_t i : list) {
    const LatticeBall& b = balls[i];
    const float x = p.x - b.centre.x, y = p.y - b.centre.y, z = p.z - b.centre.z;
    const float u = 1.0f - (x * x + y * y + z * z) * b.inverse_square_radius;
    if (u > 0.0f) sum = sum + b.strength * (u * u * u);
  }
  return sum - threshold;
}

// By Newton's steps from a guess of the exponent: quotients are not rounded alike everywhere.
float reciprocal(float d) {
  float x = std::bit_cast<float>(0x7ef311c7u - std::bit_cast<uint32_t>(d));
  for (int i = 0; i < 4; ++i) x = x * (2.0f - d * x);
  return x;
}

// Where F is 0 between two values, were it straight.
float crossing(float low, float high) {
  const float down = low - high;
  float s = low * reciprocal(std::abs(down));
  if (down < 0) s = -s;
  return std::min(std::max(s, 0.0f), 1.0f);
}

// Of a cell's tetrahedra, their corners in bits 0 to 2 for x, y and z; all turn the same way.
constexpr uint8_t tetrahedra[6][4] = {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7},
                                      {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}};
// By which corners are inside: how many triangles, and each corner's edge, corners of the tetrahedron a + 4 b; seen
// from outside they are counter-clockwise.
constexpr uint8_t e(int a, int b) { return uint8_t(a + 4 * b); }
struct Cut {
  uint8_t triangles = 0;
  uint8_t edge[6] = {};
};
constexpr Cut alone(int a, int b, int c, int d) { return {1, {e(a, b), e(a, c), e(a, d)}}; }
constexpr Cut pair(int a, int b, int c, int d) { return {2, {e(a, c), e(a, d), e(b, d), e(a, c), e(b, d), e(b, c)}}; }
constexpr std::array<Cut, 16> cuts = {Cut{},
                                      alone(0, 1, 2, 3),
                                      alone(1, 0, 3, 2),
                                      pair(0, 1, 2, 3),
                                      alone(2, 3, 0, 1),
                                      pair(0, 2, 3, 1),
                                      pair(1, 2, 0, 3),
                                      alone(3, 2, 0, 1),
                                      alone(3, 2, 1, 0),
                                      pair(0, 3, 1, 2),
                                      pair(1, 3, 2, 0),
                                      alone(2, 3, 1, 0),
                                      pair(2, 3, 0, 1),
                                      alone(1, 0, 2, 3),
                                      alone(0, 1, 3, 2),
                                      Cut{}};

class Block {
 public:
  Block(const PosedMetaballs& body, const std::vector<LatticeBall>& balls, const MetaballBlock& block)
      : balls_(balls),
        list_(body.lattice.ball_lists.data() + block.first, block.count),
        threshold_(float(body.threshold)),
        first_(block.first_cell),
        cell_m_(float(body.lattice.cell_m)) {
    for (int i = 0; i < nodes * nodes * nodes; ++i)
      field_[size_t(i)] = field(glm::vec3(first_ + glm::ivec3(i % nodes, i / nodes % nodes, i / (nodes * nodes))));
  }
  // Calls with the three corners of each triangle, cells along x first.
  template <class Found>
  void each(Found&& found) const {
    for (int z = 0; z < cells; ++z)
      for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x) cell({x, y, z}, found);
  }

 private:
  float field(glm::vec3 p) const { return field_at(balls_, list_, threshold_, p); }
  static int place(glm::ivec3 node) { return node.x + nodes * (node.y + nodes * node.z); }
  static glm::ivec3 corner(int c) { return {c & 1, c >> 1 & 1, c >> 2}; }

  template <class Found>
  void cell(glm::ivec3 at, Found& found) const {
    float f[8];
    for (int c = 0; c < 8; ++c) f[c] = field_[size_t(place(at + corner(c)))];
    for (const uint8_t* t : tetrahedra) {
      uint32_t inside = 0;
      for (uint32_t i = 0; i < 4; ++i) inside |= uint32_t(f[t[i]] > least_inside) << i;
      const Cut& cut = cuts[inside];
      for (int k = 0; k < cut.triangles; ++k) {
        glm::vec3 p[3];
        for (int i = 0; i < 3; ++i) {
          const int edge = cut.edge[3 * k + i], a = t[edge & 3], b = t[edge >> 2];
          p[i] = vertex(at, std::min(a, b), std::max(a, b), f);
        }
        found(p[0], p[1], p[2]);
      }
    }
  }
  // A few halvings find kernels that end within the edge, and leave little that is not straight. From the lower corner
  // on: all of whom the edge is do so.
  glm::vec3 vertex(glm::ivec3 at, int a, int b, const float* f) const {
    const glm::vec3 from(first_ + at + corner(a)), way(corner(b) - corner(a));
    float low = f[a], high = f[b], begin = 0, width = 1;
    const bool is_low_inside = low > least_inside;
    for (int i = 0; i < halvings; ++i) {
      width *= 0.5f;
      const float there = field(along(from, begin + width, way));
      if ((there > least_inside) == is_low_inside)
        begin += width, low = there;
      else
        high = there;
    }
    const float t = begin + width * crossing(low, high);
    const glm::vec3 p = along(from, std::min(std::max(t, least_along), 1.0f - least_along), way);
    return {p.x * cell_m_, p.y * cell_m_, p.z * cell_m_};
  }
  static glm::vec3 along(glm::vec3 from, float t, glm::vec3 way) {
    return {from.x + t * way.x, from.y + t * way.y, from.z + t * way.z};
  }

  const std::vector<LatticeBall>& balls_;
  std::span<const uint32_t> list_;
  float threshold_;
  glm::ivec3 first_;
  float cell_m_;
  std::array<float, nodes * nodes * nodes> field_;
};

}  // namespace

std::vector<PosedBall> pose_metaballs(const Metaballs& body, const Pose& pose) {
  const glm::dmat4& world_from_node = pose.world_from_node[size_t(body.node)];
  const glm::dmat4 node_from_world = glm::inverse(world_from_node);
  std::vector<PosedBall> out;
  out.reserve(body.balls.size());
  for (const Metaball& ball : body.balls) {
    PosedBall posed{glm::dvec3(node_from_world * pose.world_from_node[size_t(ball.node)][3]), double(ball.radius_m),
                    double(ball.strength)};
    const bool there = pose.node_visible[size_t(ball.node)] && is_finite_affine(node_from_world) &&
                       glm::length(posed.centre) < 1e15 && posed.radius_m > 0;
    if (!there) posed = {};
    out.push_back(posed);
  }
  return out;
}

double default_metaball_cell_m(const Metaballs& body) {
  std::vector<float> radii;
  for (const Metaball& ball : body.balls) radii.push_back(ball.radius_m);
  if (radii.empty()) return 1;
  std::nth_element(radii.begin(), radii.begin() + ptrdiff_t(radii.size() / 2), radii.end());
  return double(radii[radii.size() / 2]) / 8;
}

// Where F > 0 some ball's kernel is above the threshold's share of all strengths: else their sum would be below it.
DAabb metaball_bounds(std::span<const PosedBall> balls, double threshold) {
  double strength = 0;
  for (const PosedBall& ball : balls) strength += std::max(ball.strength, 0.0);
  DAabb box;
  if (!(strength > threshold)) return box;
  const double q = std::sqrt(1 - std::cbrt(std::max(threshold, 0.0) / strength));
  for (const PosedBall& ball : balls)
    if (ball.strength > 0) box.add({ball.centre - q * ball.radius_m, ball.centre + q * ball.radius_m});
  return box;
}

DAabb drawn_metaball_bounds(std::span<const PosedBall> balls, double threshold, double cell_m) {
  DAabb box = metaball_bounds(balls, threshold);
  if (box.empty()) return {glm::dvec3(0), glm::dvec3(0)};
  box.min -= cell_m, box.max += cell_m;
  return box;
}

void lay_out_metaballs(std::span<const PosedBall> balls, double threshold, double cell_m, MetaballLattice& kept) {
  static thread_local Blocks work;
  const DAabb box = metaball_bounds(balls, threshold);
  const auto clear = [&] {
    kept.blocks.clear(), kept.ball_lists.clear();
    kept.most_triangles = 0;
  };
  clear();
  kept.cell_m = cell_m, kept.origin_cell = glm::i64vec3(0), kept.enlarged = false;
  if (box.empty() || !(cell_m > 0) || !is_finite(box)) return;
  for (;; cell_m *= 2, kept.enlarged = true) {
    const glm::dvec3 size = (box.max - box.min) / cell_m, far = glm::max(glm::abs(box.min), glm::abs(box.max)) / cell_m;
    if (std::max({size.x, size.y, size.z}) > most_reach_cells || std::max({far.x, far.y, far.z}) > 0x1p52) continue;
    clear();
    kept.cell_m = cell_m;
    // A cell more: vertices of float fields lie that near what is bounded.
    const glm::dvec3 first = glm::floor((box.min / cell_m - 1.0) / double(cells)),
                     last = glm::floor((box.max / cell_m + 1.0) / double(cells));
    kept.origin_cell = glm::i64vec3(first) * glm::i64vec3(cells);
    const glm::dvec3 across = last - first + 1.0;
    if (work.fill(balls, threshold, int(std::max({across.x, across.y, across.z})), kept)) return;
  }
}
MetaballLattice make_metaball_lattice(std::span<const PosedBall> balls, double threshold, double cell_m) {
  // Found in what the thread keeps, so that nothing grows step by step.
  static thread_local MetaballLattice work;
  lay_out_metaballs(balls, threshold, cell_m, work);
  return work;
}

LatticeBall lattice_ball(const PosedBall& ball, const MetaballLattice& lattice) {
  return in_cells(ball, lattice.cell_m, lattice.origin_m());
}
std::vector<LatticeBall> lattice_balls(const PosedMetaballs& body) {
  std::vector<LatticeBall> out;
  out.reserve(body.balls.size());
  for (const PosedBall& ball : body.balls) out.push_back(lattice_ball(ball, body.lattice));
  return out;
}

std::vector<glm::vec3> polygonise(const PosedMetaballs& body) {
  const std::vector<LatticeBall> balls = lattice_balls(body);
  const std::vector<MetaballBlock>& blocks = body.lattice.blocks;
  std::vector<std::vector<glm::vec3>> parts(blocks.size());
  tbb::parallel_for(size_t(0), blocks.size(), [&](size_t b) {
    Block(body, balls, blocks[b]).each([&](glm::vec3 p, glm::vec3 q, glm::vec3 r) {
      parts[b].insert(parts[b].end(), {p, q, r});
    });
  });
  std::vector<glm::vec3> out;
  for (const std::vector<glm::vec3>& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

uint32_t metaball_chunks(uint64_t triangles) {
  const uint64_t chunks = (triangles + metaball_chunk_triangles - 1) / metaball_chunk_triangles;
  const uint64_t step = std::max<uint64_t>(std::bit_floor(chunks) / 4, 1);
  return uint32_t((chunks + step - 1) / step * step);
}

}  // namespace candela
