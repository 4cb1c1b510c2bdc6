#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "base/error.h"

namespace candela {

// A uniform cubic B-spline: p(s) of a span is 1/6 of (1-s)^3 P0 + (3s^3-6s^2+4) P1 + (-3s^3+3s^2+3s+1) P2 + s^3 P3. Its
// second derivative is continuous; it passes near its control points, not through them. The parameter runs from 0 to
// the count of spans.
class Spline {
 public:
  enum class Ends : uint8_t {
    closed,  // it comes back: as many spans as points; at a whole number k it is nearest to point k
    touch,   // the first and the last point are there three times, so that it begins and ends there: a span more
    plain,   // as the points are: three spans fewer, of at least four points
  };
  // points: at least one; of a plain spline four.
  Spline(const std::vector<glm::dvec3>& points, Ends ends);
  size_t spans() const { return control_.size() - 3; }
  bool closed() const { return closed_; }
  // The parameter within the spline: of a closed one turned round, else held at its ends.
  double within(double u) const;
  glm::dvec3 at(double u) const;
  glm::dvec3 derivative(double u, int order) const;  // 1 to 3, by the parameter; the third of the span that follows
  // The way that it goes, of unit length, also where it stands still for a moment (its limit); 0: it is one point.
  glm::dvec3 direction(double u) const;
  double largest_extent() const { return extent_; }  // of the control points' box

 private:
  struct Place {
    size_t span = 0;
    double s = 0;  // 0 to 1 in it
  };
  Place place(double u) const;
  std::vector<glm::dvec3> control_;  // with those that the ends repeat
  bool closed_ = false;
  double extent_ = 0;
};

// The length of a spline from its beginning, and where a length is reached: by Gauss's formula over halves of spans
// until they agree to 1e-10 of the whole.
class ArcLength {
 public:
  explicit ArcLength(Spline spline);
  double total_m() const { return begin_m_.back(); }
  double length_m(double u) const;        // from 0 to the parameter within the spline
  double parameter(double length) const;  // the parameter where that length is reached, 0 to total
  // The same speed along the whole: u of `spans` to the parameter at that share of the length.
  double evenly(double u) const;

 private:
  double speed(double u) const;
  double between(double from, double to) const;
  double halved(double from, double to, double whole, double allowed, int depth) const;
  Spline spline_;
  std::vector<double> begin_m_;  // of each span, and of the end
};

// Pairs of time and parameter: held before the first and after the last, between them linear or monotone cubic.
struct TimeMap {
  std::vector<double> time_s, parameter;  // at least one; times ascend, two pairs of one time are a jump to the second
  bool smooth = false;
  double at(double time_s) const;
  std::vector<double> jumps_s() const;  // ascending
};

}  // namespace candela
