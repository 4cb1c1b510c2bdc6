// Splines, their lengths and their times, against the definition and against quadrature by many steps.
#include "scene/spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace candela::test::scene_spline {
namespace {

using Ends = Spline::Ends;
using Points = std::vector<glm::dvec3>;

Points some_points(size_t count, double scale = 1, glm::dvec3 about = glm::dvec3(0)) {
  Points points;
  for (size_t i = 0; i < count; ++i) {
    const double a = 2.4 * double(i);
    points.push_back(about + scale * glm::dvec3(std::cos(a) * (1 + 0.3 * double(i)), std::sin(1.7 * a), std::sin(a)));
  }
  return points;
}

// The Cox and de Boor recursion over whole knots: the same curve from another formula.
double basis(int i, int degree, double u) {
  if (degree == 0) return u >= i && u < i + 1 ? 1 : 0;
  return (u - i) / degree * basis(i, degree - 1, u) + (i + degree + 1 - u) / degree * basis(i + 1, degree - 1, u);
}
glm::dvec3 de_boor(const Points& points, double u) {
  glm::dvec3 sum(0);
  for (size_t i = 0; i < points.size(); ++i) sum += basis(int(i), 3, u + 3) * points[i];
  return sum;
}

double longest(const Spline& spline, double from, double to, int steps) {
  double sum = 0;
  glm::dvec3 before = spline.at(from);
  for (int i = 1; i <= steps; ++i) {
    const glm::dvec3 now = spline.at(from + (to - from) * i / steps);
    sum += glm::length(now - before);
    before = now;
  }
  return sum;
}

}  // namespace

TEST(Spline, IsTheUniformCubicBSpline) {
  const Points points = some_points(9);
  const Spline spline(points, Ends::plain);
  ASSERT_EQ(spline.spans(), 6u);
  for (double u = 0; u < 6; u += 0.0625) EXPECT_LT(glm::length(spline.at(u) - de_boor(points, u)), 1e-14) << u;
}

TEST(Spline, IsTwiceDifferentiableAtItsKnots) {
  for (const Ends ends : {Ends::closed, Ends::touch, Ends::plain})
    for (const glm::dvec3 about : {glm::dvec3(0), glm::dvec3(1e6, -2e6, 3e6)}) {
      const Spline spline(some_points(8, 1, about), ends);
      const double rounding = glm::length(about) * 4e-16;
      for (size_t k = ends == Ends::closed ? 0 : 1; k < spline.spans(); ++k) {
        const double before = std::nextafter(double(k == 0 ? spline.spans() : k), 0.0);
        EXPECT_LT(glm::length(spline.at(before) - spline.at(double(k))), 1e-12 + rounding) << k;
        EXPECT_LT(glm::length(spline.derivative(before, 1) - spline.derivative(double(k), 1)), 1e-12 + rounding) << k;
        EXPECT_LT(glm::length(spline.derivative(before, 2) - spline.derivative(double(k), 2)), 1e-12 + rounding) << k;
      }
    }
}

TEST(Spline, DerivativesAreThoseOfItsPlaces) {
  const Spline spline(some_points(7), Ends::touch);
  const double h = 1e-4;
  for (double u = 0.3; u < 7.5; u += 0.41) {
    if (std::abs(u - std::round(u)) < 2 * h) continue;
    const glm::dvec3 first = (spline.at(u + h) - spline.at(u - h)) / (2 * h);
    const glm::dvec3 second = (spline.at(u + h) - 2.0 * spline.at(u) + spline.at(u - h)) / (h * h);
    EXPECT_LT(glm::length(first - spline.derivative(u, 1)), 1e-6);
    EXPECT_LT(glm::length(second - spline.derivative(u, 2)), 1e-6);
    EXPECT_LT(
        glm::length((spline.derivative(u + h, 2) - spline.derivative(u - h, 2)) / (2 * h) - spline.derivative(u, 3)),
        1e-6);
  }
}

TEST(Spline, TouchesItsEndsAndIsHeldThere) {
  const Points points = some_points(5);
  const Spline spline(points, Ends::touch);
  ASSERT_EQ(spline.spans(), 6u);
  for (const double before : {-1e9, -1.0, 0.0}) EXPECT_EQ(spline.at(before), points.front());
  for (const double after : {6.0, 7.0, 1e300}) EXPECT_LT(glm::length(spline.at(after) - points.back()), 1e-15);
  // It stands still at both, and still looks the way it is going to go or has come.
  EXPECT_LT(glm::length(spline.derivative(0, 1)), 1e-15);
  EXPECT_LT(glm::length(spline.direction(0) - glm::normalize(points[1] - points[0])), 1e-12);
  EXPECT_LT(glm::length(spline.direction(6) - glm::normalize(points[4] - points[3])), 1e-12);
}

TEST(Spline, ClosedComesBack) {
  const Points points = some_points(6);
  const Spline spline(points, Ends::closed);
  ASSERT_EQ(spline.spans(), 6u);
  for (const double u : {0.0, 0.25, 3.7, 5.999})
    for (const double turn : {-12.0, -6.0, 6.0, 600.0})
      EXPECT_LT(glm::length(spline.at(u) - spline.at(u + turn)), 1e-11) << u << " " << turn;
  for (size_t k = 0; k < 6; ++k)
    EXPECT_LT(glm::length(spline.at(double(k)) - (points[(k + 5) % 6] + 4.0 * points[k] + points[(k + 1) % 6]) / 6.0),
              1e-14);
}

TEST(Spline, OnePointTwoPointsAndPointsThatCoincide) {
  for (const Ends ends : {Ends::closed, Ends::touch}) {
    const Spline one({{1, 2, 3}}, ends);
    for (const double u : {-1.0, 0.0, 0.5, 1.0, 9.0}) EXPECT_EQ(one.at(u), glm::dvec3(1, 2, 3));
    EXPECT_EQ(one.direction(0.5), glm::dvec3(0));
    const ArcLength still(one);
    EXPECT_EQ(still.total_m(), 0);
    EXPECT_TRUE(std::isfinite(still.evenly(0.7)));
    const Spline two({{0, 0, 0}, {2, 0, 0}}, ends);
    for (double u = 0; u <= double(two.spans()); u += 0.125) {
      EXPECT_EQ(two.at(u).y, 0);
      EXPECT_GE(two.at(u).x, 0);
      EXPECT_LE(two.at(u).x, 2);
      EXPECT_NEAR(glm::length(two.direction(u)), 1, 1e-12) << u;
    }
    // Four at one place, between others: it rests there.
    const Spline rests({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}}, ends);
    const ArcLength length(rests);
    EXPECT_NEAR(length.total_m(), longest(rests, 0, double(rests.spans()), 40000), 1e-6);
    for (double u = 0; u <= double(rests.spans()); u += 0.0625) {
      EXPECT_NEAR(glm::length(rests.direction(u)), 1, 1e-9) << u;
      EXPECT_TRUE(std::isfinite(length.evenly(u)));
    }
  }
}

TEST(ArcLengths, AreThoseOfACircleAndOfQuadratureByManySteps) {
  // The B-spline of a regular polygon is a circle up to its tenth digit when there are many corners: its radius is
  // (4 + 2 cos a)/6 of theirs, and what it is off grows with a^4.
  Points corners;
  constexpr int count = 360;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    corners.emplace_back(std::cos(a), 0, std::sin(a));
  }
  const Spline circle(corners, Ends::closed);
  const double radius = (4 + 2 * std::cos(2 * std::numbers::pi / count)) / 6;
  EXPECT_NEAR(ArcLength(circle).total_m(), 2 * std::numbers::pi * radius, 1e-9);
  const Spline spline(some_points(8), Ends::touch);
  const ArcLength length(spline);
  EXPECT_NEAR(length.total_m(), longest(spline, 0, double(spline.spans()), 400000), 1e-8);
  EXPECT_NEAR(length.length_m(2.3), longest(spline, 0, 2.3, 400000), 1e-8);
}

TEST(ArcLengths, EvenParametersGiveEvenSpeed) {
  for (const Ends ends : {Ends::closed, Ends::touch}) {
    const Spline spline(some_points(8), ends);
    const ArcLength length(spline);
    const double end = double(spline.spans());
    for (int i = 0; i <= 200; ++i) {
      const double u = end * i / 200;
      const double share = ends == Ends::closed && i == 200 ? 0 : u / end;
      EXPECT_NEAR(length.length_m(length.evenly(u)), share * length.total_m(), 1e-9 * length.total_m()) << u;
    }
    EXPECT_EQ(length.evenly(0), 0);
    EXPECT_EQ(length.parameter(length.total_m()), end);
    EXPECT_EQ(length.parameter(2 * length.total_m()), end);
    EXPECT_EQ(length.parameter(-1), 0);
  }
}

TEST(TimeMaps, AreHeldOutsideAndMonotoneBetween) {
  TimeMap map{{1, 2, 2.5, 7}, {0, 4, 4, 10}};
  for (const bool smooth : {false, true}) {
    map.smooth = smooth;
    EXPECT_EQ(map.at(-100), 0);
    EXPECT_EQ(map.at(1), 0);
    EXPECT_EQ(map.at(2), 4);
    EXPECT_EQ(map.at(2.25), 4);
    EXPECT_EQ(map.at(7), 10);
    EXPECT_EQ(map.at(1e300), 10);
    double before = 0;
    for (double t = 1; t <= 7; t += 0.01) {
      EXPECT_GE(map.at(t), before) << t;
      before = map.at(t);
    }
  }
  map.smooth = false;
  EXPECT_DOUBLE_EQ(map.at(1.25), 1);
  const TimeMap one{{3}, {2}};
  EXPECT_TRUE(one.jumps_s().empty());
  for (const double t : {-1.0, 3.0, 9.0}) EXPECT_EQ(one.at(t), 2);
}

// Each side of a jump is as if the other were not.
TEST(TimeMaps, JumpWhereATimeStandsTwice) {
  TimeMap map{{0, 1, 3, 3, 4, 6, 6, 6.5}, {0, 2, 3, 10, 8, 7, 7, 9}};
  for (const bool smooth : {false, true}) {
    map.smooth = smooth;
    EXPECT_NEAR(map.at(std::nextafter(3, 0)), 3, 1e-12);
    EXPECT_EQ(map.at(3), 10);
    EXPECT_NEAR(map.at(std::nextafter(3, 9)), 10, 1e-12);
    const TimeMap before{{0, 1, 3}, {0, 2, 3}, smooth}, after{{3, 4, 6}, {10, 8, 7}, smooth};
    for (double t = 0; t < 3; t += 0.125) EXPECT_EQ(map.at(t), before.at(t)) << t;
    for (double t = 3; t < 6; t += 0.125) EXPECT_EQ(map.at(t), after.at(t)) << t;
  }
  EXPECT_EQ(map.jumps_s(), std::vector<double>{3}) << "a time that stands twice with one parameter is no jump";
}

}  // namespace candela::test::scene_spline
