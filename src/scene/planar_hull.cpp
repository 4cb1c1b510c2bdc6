#include <algorithm>

#include "scene/view_hulls.h"

// PlanarHull of view_hulls.h.
namespace candela {
namespace {

double cross(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// Andrew's monotone chain ("Another Efficient Algorithm for Convex Hulls in Two Dimensions", 1979).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points) {
  const auto before = [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<glm::dvec2> hull(2 * points.size());
  size_t count = 0;
  const auto chain = [&](auto first, auto last) {
    const size_t start = count;
    for (auto p = first; p != last; ++p) {
      while (count >= start + 2 && cross(hull[count - 2], hull[count - 1], *p) <= 0) --count;
      hull[count++] = *p;
    }
    --count;  // the first of the other chain
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
  hull.resize(count);
  return hull;
}

}  // namespace

void PlanarHull::add(glm::dvec2 point) {
  constexpr size_t room = 1024;
  if (contains(point)) return;
  more_.push_back(point);
  if (more_.size() >= room) reduce();
}

void PlanarHull::add(const PlanarHull& other) {
  for (const glm::dvec2& p : other.hull_) add(p);
  for (const glm::dvec2& p : other.more_) add(p);
}

bool PlanarHull::contains(glm::dvec2 point) const {
  if (hull_.size() < 3) return false;
  for (size_t i = 0; i < hull_.size(); ++i)
    if (cross(hull_[i], hull_[(i + 1) % hull_.size()], point) < 0) return false;
  return true;
}

void PlanarHull::reduce() {
  more_.insert(more_.end(), hull_.begin(), hull_.end());
  hull_ = hull_of(std::move(more_));
  more_.clear();
}

const std::vector<glm::dvec2>& PlanarHull::points() {
  if (!more_.empty()) reduce();
  return hull_;
}

}  // namespace candela
