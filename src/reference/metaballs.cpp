#include "reference/metaballs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace candela {
namespace {

// By Bernstein coefficients over an interval.
using Sextic = std::array<double, 7>;

template <size_t N, size_t M>
std::array<double, N + M - 1> product(const std::array<double, N>& a, const std::array<double, M>& b) {
  constexpr double binomial[7][7] = {
      {1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}, {1, 5, 10, 10, 5, 1}, {1, 6, 15, 20, 15, 6, 1}};
  std::array<double, N + M - 1> out{};
  for (size_t i = 0; i < N; ++i)
    for (size_t j = 0; j < M; ++j) out[i + j] += binomial[N - 1][i] * binomial[M - 1][j] * a[i] * b[j];
  for (size_t k = 0; k < out.size(); ++k) out[k] /= binomial[N + M - 2][k];
  return out;
}

// Its halves (de Casteljau).
void split(const Sextic& c, Sextic& low, Sextic& high) {
  Sextic work = c;
  for (size_t k = 0; k < 7; ++k) {
    low[k] = work[0], high[6 - k] = work[6 - k];
    for (size_t i = 0; i + 1 < 7 - k; ++i) work[i] = 0.5 * (work[i] + work[i + 1]);
  }
}

// Crossings in an interval, in order: where the sign, greater than 0 or not, differs from `inside`, which follows.
// Where coefficients have one sign, so has the polynomial; an interval of no width holds a touch at most.
template <class Found>
bool crossings(const Sextic& c, double begin, double end, int depth, bool& inside, const Found& found) {
  if ((c[0] > 0) != inside) {
    inside = !inside;
    if (found(begin, inside)) return true;
  }
  const bool has_in = std::ranges::any_of(c, [](double v) { return v > 0; }),
             has_out = std::ranges::any_of(c, [](double v) { return !(v > 0); });
  if (!has_in || !has_out) return false;
  if (depth == 0) {
    if ((c[6] > 0) == inside) return false;
    inside = !inside;
    return found(0.5 * (begin + end), inside);
  }
  Sextic low, high;
  split(c, low, high);
  const double middle = 0.5 * (begin + end);
  return crossings(low, begin, middle, depth - 1, inside, found) ||
         crossings(high, middle, end, depth - 1, inside, found);
}
constexpr int most_halvings = 52;

// The noise of shaders/lib/metaball_normal.glsl: directions at corners, and the slope of what lies between.
glm::dvec3 noise_direction(glm::ivec3 corner) {
  const glm::uvec3 c = glm::uvec3(corner) & 255u;
  uint32_t h = c.x * 0x8da6b343u ^ c.y * 0xd8163841u ^ c.z * 0xcb1ab31fu;
  h ^= h >> 13;
  h *= 0x9e3779b1u;
  h ^= h >> 16;
  const double a = h & 1u ? -1 : 1, b = h & 2u ? -1 : 1;
  const uint32_t axis = (h >> 2) % 3;
  return axis == 0 ? glm::dvec3(0, a, b) : axis == 1 ? glm::dvec3(a, 0, b) : glm::dvec3(a, b, 0);
}

glm::dvec3 noise_slope(glm::dvec3 at) {
  const glm::dvec3 cell = glm::floor(at), w = at - cell;
  glm::dvec3 slope(0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 high(corner & 1, corner >> 1 & 1, corner >> 2);
    glm::dvec3 share, change;
    for (int a = 0; a < 3; ++a) {
      const double x = w[a], fade = x * x * x * (x * (6 * x - 15) + 10), rise = 30 * x * x * (x - 1) * (x - 1);
      share[a] = high[a] ? fade : 1 - fade, change[a] = high[a] ? rise : -rise;
    }
    const glm::dvec3 direction = noise_direction(glm::ivec3(cell) + high);
    const double value = glm::dot(direction, w - glm::dvec3(high));
    slope +=
        share.x * share.y * share.z * direction +
        value * glm::dvec3(change.x * share.y * share.z, share.x * change.y * share.z, share.x * share.y * change.z);
  }
  return slope;
}

glm::dvec3 unit_or_zero(glm::dvec3 v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0);
}

}  // namespace

MetaballSurface::MetaballSurface(const PosedMetaballs& body)
    : body_(body), node_from_relative_(glm::inverse(body.relative_from_node)) {}

double MetaballSurface::field(glm::dvec3 p) const {
  double sum = -body_.threshold;
  for (const PosedBall& ball : body_.balls) {
    const glm::dvec3 d = (p - ball.centre) / ball.radius_m;
    const double u = 1 - glm::dot(d, d);
    if (u > 0) sum += ball.strength * u * u * u;
  }
  return sum;
}

glm::dvec3 MetaballSurface::slope(glm::dvec3 p) const {
  glm::dvec3 sum(0);
  for (const PosedBall& ball : body_.balls) {
    const glm::dvec3 d = (p - ball.centre) / ball.radius_m;
    const double u = 1 - glm::dot(d, d);
    if (u > 0) sum -= (6 * ball.strength * u * u / ball.radius_m) * d;
  }
  return sum;
}

bool MetaballSurface::each_crossing(glm::dvec3 origin, glm::dvec3 direction, const Crossing& found) const {
  const glm::dvec3 o = in_node(origin), way = glm::dmat3(node_from_relative_) * direction;
  const double a = glm::dot(way, way);
  if (!(a > 0) || !std::isfinite(a)) return false;
  struct Span {
    double begin, end;
    const PosedBall* ball;
  };
  thread_local std::vector<Span> spans;
  thread_local std::vector<double> ends;
  spans.clear(), ends.clear();
  for (const PosedBall& ball : body_.balls) {
    if (ball.strength == 0) continue;
    // About the nearest point of the ray's line, so that no digits cancel.
    const double nearest = glm::dot(ball.centre - o, way) / a;
    const glm::dvec3 off = o + nearest * way - ball.centre;
    const double half2 = (ball.radius_m * ball.radius_m - glm::dot(off, off)) / a;
    if (!(half2 > 0)) continue;
    const double half = std::sqrt(half2), end = nearest + half;
    if (!(end > 0)) continue;
    spans.push_back({std::max(nearest - half, 0.0), end, &ball});
    ends.push_back(spans.back().begin), ends.push_back(end);
  }
  if (spans.empty()) return false;
  std::ranges::sort(ends);
  bool inside = field(o) > 0;
  // Outside all supports F is -threshold, so what ends there ends at their ends.
  for (size_t k = 0; k + 1 < ends.size(); ++k) {
    const double begin = ends[k], end = ends[k + 1], width = end - begin;
    if (!(width > 0)) continue;
    Sextic sum;
    sum.fill(-body_.threshold);
    for (const Span& span : spans) {
      if (!(span.begin <= begin && span.end >= end)) continue;
      const double r2 = span.ball->radius_m * span.ball->radius_m;
      const glm::dvec3 first = o + begin * way - span.ball->centre, last = o + end * way - span.ball->centre;
      std::array<double, 3> u;
      u[0] = std::max(1 - glm::dot(first, first) / r2, 0.0), u[2] = std::max(1 - glm::dot(last, last) / r2, 0.0);
      u[1] = u[0] - glm::dot(first, way) * width / r2;
      const Sextic cube = product(product(u, u), u);
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += span.ball->strength * cube[i];
    }
    if (crossings(sum, begin, end, most_halvings, inside, found)) return true;
  }
  return inside && found(ends.back(), false);
}

// Where F is 0, one of the n balls that reach there gives an nth of the threshold or more, and no more balls reach
// there than have supports that meet its own.
std::vector<glm::dvec4> MetaballSurface::spheres() const {
  // Rows of M^T M: no vector grows by more than the square root of their largest sum.
  const glm::dmat3 m(body_.relative_from_node), square = glm::transpose(m) * m;
  double grows2 = 0;
  for (int c = 0; c < 3; ++c)
    grows2 = std::max(grows2, std::abs(square[c][0]) + std::abs(square[c][1]) + std::abs(square[c][2]));
  std::vector<glm::dvec4> spheres;
  for (const PosedBall& ball : body_.balls) {
    if (!(ball.strength > 0)) continue;
    const double together = double(std::ranges::count_if(body_.balls, [&](const PosedBall& other) {
      return other.strength > 0 && glm::distance(other.centre, ball.centre) < other.radius_m + ball.radius_m;
    }));
    const double least = std::max(body_.threshold, 0.0) / (std::max(together, 1.0) * ball.strength);
    if (!(least < 1)) continue;
    const double radius_m = ball.radius_m * std::sqrt(1 - std::cbrt(least)) * std::sqrt(grows2) * (1 + 1e-9);
    const glm::dvec3 centre(body_.relative_from_node * glm::dvec4(ball.centre, 1.0));
    if (radius_m > 0 && std::isfinite(radius_m)) spheres.emplace_back(centre, radius_m);
  }
  return spheres;
}

glm::dvec3 MetaballSurface::polished(glm::dvec3 near, glm::dvec3 direction) const {
  const glm::dvec3 p = in_node(near), way = glm::dmat3(node_from_relative_) * glm::normalize(direction);
  const double off = field(p);
  double t = 0;
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 q = p + t * way;
    const double down = glm::dot(slope(q), way);
    if (down == 0) return near;
    t -= field(q) / down;
    if (!std::isfinite(t)) return near;
  }
  const double largest = std::max({std::abs(near.x), std::abs(near.y), std::abs(near.z)});
  const bool is_better = std::abs(field(p + t * way)) <= std::abs(off) && std::abs(t) <= 1e-4 * largest;
  return is_better ? near + t * glm::normalize(direction) : near;
}

glm::dvec3 MetaballSurface::outwards(glm::dvec3 p) const {
  const glm::dvec3 steepest = slope(p);
  if (glm::length(steepest) > 1e-20) return unit_or_zero(-steepest);
  // At the ends of kernels: away from the ball whose kernel ends last.
  const PosedBall* last = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const PosedBall& ball : body_.balls) {
    const double q = glm::length(p - ball.centre) / ball.radius_m;
    if (ball.strength > 0 && q > 0 && q < nearest) nearest = q, last = &ball;
  }
  return last ? unit_or_zero(p - last->centre) : glm::dvec3(0);
}

glm::dvec3 MetaballSurface::geometric_normal(glm::dvec3 relative) const {
  return unit_or_zero(glm::transpose(glm::dmat3(node_from_relative_)) * outwards(in_node(relative)));
}

glm::dvec3 MetaballSurface::shading_normal(glm::dvec3 relative) const {
  const glm::dvec3 p = in_node(relative);
  glm::dvec3 n = outwards(p);
  if (body_.noise_amplitude > 0 && n != glm::dvec3(0)) {
    const glm::dvec3 slope = noise_slope(p * body_.noise_frequency_per_m),
                     bounded = slope / std::sqrt(1 + glm::dot(slope, slope));
    n = unit_or_zero(n - body_.noise_amplitude * (bounded - glm::dot(bounded, n) * n));
  }
  return unit_or_zero(glm::transpose(glm::dmat3(node_from_relative_)) * n);
}

glm::dvec3 MetaballSurface::place_at(const MetaballSurface& then, glm::dvec3 relative) const {
  const glm::dvec3 p = in_node(relative);
  glm::dvec3 moved(0);
  double weights = 0;
  for (size_t i = 0; i < body_.balls.size(); ++i) {
    const PosedBall &now = body_.balls[i], &before = then.body_.balls[i];
    const glm::dvec3 d = p - now.centre;
    const double u = std::max(1 - glm::dot(d, d) / (now.radius_m * now.radius_m), 0.0),
                 weight = std::abs(now.strength) * u * u * u;
    moved += weight * (now.centre - before.centre + d * (1 - before.radius_m / now.radius_m));
    weights += weight;
  }
  glm::dvec3 q = weights > 0 ? p - moved / weights : p;
  const double value = field(p);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 slope = then.slope(q);
    const double square = glm::dot(slope, slope);
    if (!(square > 1e-30)) break;
    const glm::dvec3 step = slope * ((then.field(q) - value) / square);
    const double length = glm::length(step), most = body_.lattice.cell_m;
    q -= step * (length > most ? most / length : 1.0);
  }
  return glm::dvec3(then.body_.relative_from_node * glm::dvec4(q, 1.0));
}

}  // namespace candela
