#include "scene/spline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "base/monotone_cubic.h"

namespace candela {

Spline::Spline(const std::vector<glm::dvec3>& points, Ends ends) : control_(points), closed_(ends == Ends::closed) {
  CHECK(!points.empty());
  if (ends == Ends::closed) {
    control_.insert(control_.begin(), points.back());
    control_.push_back(points.front());
    control_.push_back(points[1 % points.size()]);
  } else if (ends == Ends::touch) {
    control_.insert(control_.begin(), 2, points.front());
    control_.insert(control_.end(), 2, points.back());
  }
  CHECK(control_.size() >= 4);
  glm::dvec3 low = points.front(), high = low;
  for (const glm::dvec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
  for (int c = 0; c < 3; ++c) extent_ = std::max(extent_, high[c] - low[c]);
}

double Spline::within(double u) const {
  const double end = double(spans());
  if (!closed_) return std::clamp(u, 0.0, end);
  const double turned = u - std::floor(u / end) * end;
  return turned < end && turned >= 0 ? turned : 0;
}

Spline::Place Spline::place(double u) const {
  const double inside = within(u);
  const size_t span = std::min(size_t(inside), spans() - 1);
  return {span, inside - double(span)};
}

// About the second point, for weights sum to 1: far from the origin nothing but differences is rounded.
glm::dvec3 Spline::at(double u) const {
  const auto [span, s] = place(u);
  const glm::dvec3* p = &control_[span];
  const double r = 1 - s, s2 = s * s, s3 = s2 * s;
  return p[1] + (r * r * r * (p[0] - p[1]) + (-3 * s3 + 3 * s2 + 3 * s + 1) * (p[2] - p[1]) + s3 * (p[3] - p[1])) / 6.0;
}

glm::dvec3 Spline::derivative(double u, int order) const {
  const auto [span, s] = place(u);
  const glm::dvec3* p = &control_[span];
  const glm::dvec3 a = p[1] - p[0], b = p[2] - p[1], c = p[3] - p[2];
  if (order == 1) return ((1 - s) * (1 - s) * a + (1 + 2 * s - 2 * s * s) * b + s * s * c) / 2.0;
  if (order == 2) return (1 - s) * (b - a) + s * (c - b);
  return (c - b) - (b - a);
}

// Where the first derivative is 0 the next that is not says where it goes: away from there as the parameter grows, or,
// at an end, towards it from before.
glm::dvec3 Spline::direction(double u) const {
  const double least = 1e-9 * extent_;
  const bool ends = !closed_ && within(u) >= double(spans());
  for (int order = 1; order <= 3; ++order) {
    const glm::dvec3 d = derivative(u, order);
    const double length = glm::length(d);
    if (length > least) return (ends && order == 2 ? -1.0 : 1.0) * d / length;
  }
  // A stretch of one point: where it goes on, or where it came from.
  for (double step = 1; step <= double(spans()); ++step)
    for (const double side : {1.0, -1.0}) {
      const glm::dvec3 d = derivative(u + side * step, 1);
      if (glm::length(d) > least) return glm::normalize(d);
    }
  return glm::dvec3(0);
}

namespace {

// Gauss and Legendre, five places: exact for polynomials up to the ninth power.
constexpr std::array<double, 5> gauss_x = {-0.90617984593866399280, -0.53846931010568309104, 0, 0.53846931010568309104,
                                           0.90617984593866399280};
constexpr std::array<double, 5> gauss_w = {0.23692688505618908751, 0.47862867049936646804, 0.56888888888888888889,
                                           0.47862867049936646804, 0.23692688505618908751};
constexpr double part_of_total = 1e-10;
constexpr int deepest = 40;

}  // namespace

ArcLength::ArcLength(Spline spline) : spline_(std::move(spline)), begin_m_(1, 0.0) {
  for (size_t span = 0; span < spline_.spans(); ++span)
    begin_m_.push_back(begin_m_.back() + between(double(span), double(span + 1)));
}

double ArcLength::speed(double u) const { return glm::length(spline_.derivative(u, 1)); }

double ArcLength::between(double from, double to) const {
  const double half = (to - from) / 2, middle = from + half;
  double sum = 0;
  for (size_t i = 0; i < gauss_x.size(); ++i) sum += gauss_w[i] * speed(middle + half * gauss_x[i]);
  return halved(from, to, sum * half, part_of_total * spline_.largest_extent(), 0);
}

double ArcLength::halved(double from, double to, double whole, double allowed, int depth) const {
  const double middle = (from + to) / 2, half = (to - from) / 4;
  double first = 0, second = 0;
  for (size_t i = 0; i < gauss_x.size(); ++i) {
    first += gauss_w[i] * speed((from + middle) / 2 + half * gauss_x[i]);
    second += gauss_w[i] * speed((middle + to) / 2 + half * gauss_x[i]);
  }
  first *= half, second *= half;
  if (std::abs(first + second - whole) <= allowed || depth >= deepest) return first + second;
  return halved(from, middle, first, allowed / 2, depth + 1) + halved(middle, to, second, allowed / 2, depth + 1);
}

double ArcLength::length_m(double u) const {
  const double end = double(spline_.spans());
  const double inside = std::clamp(u, 0.0, end);
  const size_t span = std::min(size_t(inside), spline_.spans() - 1);
  return inside >= end ? total_m() : begin_m_[span] + (inside > double(span) ? between(double(span), inside) : 0);
}

// Newton's method within a bracket that it halves where a step would leave it.
double ArcLength::parameter(double length) const {
  const double end = double(spline_.spans());
  if (!(length > 0)) return 0;
  if (!(length < total_m())) return end;
  const auto after = std::upper_bound(begin_m_.begin(), begin_m_.end(), length);
  const size_t span = size_t(after - begin_m_.begin()) - 1;
  double low = double(span), high = low + 1;
  const double wanted = length - begin_m_[span], in_span = begin_m_[span + 1] - begin_m_[span];
  double u = low + wanted / in_span;
  for (int i = 0; i < 100; ++i) {
    const double off = between(double(span), u) - wanted;
    if (std::abs(off) <= 1e-13 * total_m()) break;
    (off > 0 ? high : low) = u;
    const double v = speed(u), next = u - off / v;
    u = v > 0 && next > low && next < high ? next : (low + high) / 2;
    if (!(high - low > 1e-15 * end)) break;
  }
  return u;
}

double ArcLength::evenly(double u) const {
  const double end = double(spline_.spans());
  return parameter(spline_.within(u) / end * total_m());
}

double TimeMap::at(double t) const {
  const auto next = size_t(std::upper_bound(time_s.begin(), time_s.end(), t) - time_s.begin());
  if (next == 0) return parameter.front();
  if (next == time_s.size()) return parameter.back();
  const size_t i = next - 1;
  if (smooth) {  // from jump to jump
    size_t first = i, last = next;
    while (first > 0 && time_s[first - 1] < time_s[first]) --first;
    while (last + 1 < time_s.size() && time_s[last] < time_s[last + 1]) ++last;
    const size_t count = last + 1 - first;
    return monotone_cubic(std::span(time_s).subspan(first, count), std::span(parameter).subspan(first, count),
                          i - first, t);
  }
  const double s = (t - time_s[i]) / (time_s[i + 1] - time_s[i]);
  return (1 - s) * parameter[i] + s * parameter[i + 1];
}

std::vector<double> TimeMap::jumps_s() const {
  std::vector<double> jumps;
  for (size_t i = 1; i < time_s.size(); ++i)
    if (time_s[i] == time_s[i - 1] && parameter[i] != parameter[i - 1]) jumps.push_back(time_s[i]);
  return jumps;
}

}  // namespace candela
