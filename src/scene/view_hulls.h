#pragma once
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "scene/pose.h"
#include "scene/scene.h"

namespace candela {

// The convex hull of points in a plane that come one by one.
class PlanarHull {
 public:
  void add(glm::dvec2 point);
  void add(const PlanarHull& other);
  // Whether a point lies in the hull of those that were added before the last few.
  bool contains(glm::dvec2 point) const;
  const std::vector<glm::dvec2>& points();  // counter-clockwise; all of them where they lie in a line

 private:
  void reduce();
  std::vector<glm::dvec2> hull_, more_;
};

// What a camera that looks in a given direction needs to know of the vertices that it shall show: their outlines seen
// from above and from the side, in its axes (right, up, back) about `middle`. x: (right, back); y: (up, back).
struct ViewHulls {
  glm::dvec3 middle{0};  // world
  PlanarHull x, y;
  // A point in camera axes, about the middle.
  void add(glm::dvec3 point) { x.add({point.x, point.z}), y.add({point.y, point.z}); }
  std::vector<std::string> notes;  // what does not count, and why
};

// Vertices as they are posed, of everything that is drawn. Of a film: at the keys of the animations that play and
// evenly between, so that the outlines belong to the file and not to a frame or a list of frames. Left out are vertices
// that are not finite, surfaces that a mask cuts away wholly, and surroundings: floors and domes a hundred times larger
// than all that is smaller. axes: right, up and back of the camera. turned: the outlines of what all of it sweeps when
// it turns once about the upright axis through its middle.
struct FramedTime {
  const AnimationChoice& animations;
  const Pose* pose = nullptr;  // absent: the film
};
ViewHulls view_hulls(const Scene& scene, const FramedTime& time, const glm::dmat3& axes, bool turned);

// Outlines of films, kept with their scene: a film's frames ask for the same.
class KeptViewHulls {
 public:
  ViewHulls of_film(const Scene& scene, const AnimationChoice& animations, const glm::dmat3& axes, bool turned);

 private:
  using Key = std::tuple<std::vector<int>, std::vector<double>, bool>;
  std::mutex mutex_;
  std::map<Key, ViewHulls> kept_;
};

}  // namespace candela
