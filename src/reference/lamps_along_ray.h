#pragma once
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "reference/medium.h"
#include "reference/punctual.h"
#include "reference/world.h"

namespace candela::reference {

// The part of a stretch of a ray that a point light or spot can light: within its range, and a spot's within its cone.
// Empty: none of it.
Span lit_part(const PunctualLight& light, glm::dvec3 origin, glm::dvec3 direction, Span span);

// Point lights and spots as they light the air along a ray: which ones reach it, and points among them all, each light
// as likely as its unhindered light along the ray is strong.
//
// The tree of lights is taken apart where clusters are strong for their distance (Conty Estévez and Kulla, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting", 2018), into about as many clusters as points are wanted, so
// that a ray's time grows with its points and not with the lights. What a cluster gives is estimated by the
// equi-angular integral of a ray, (theta_b - theta_a) / D, in the place of the paper's inverse square; what a single
// lamp gives by three points of that integral, with its range, cone, phase function and the fog before and behind it.
// Neither knows what stands in the light's way. No light that can reach the ray has a fraction of 0.
class LampsAlongRay {
 public:
  // What of a lamp's light a metre of the ray sends on to its origin, the phase function aside: at `at_m` on the ray,
  // where it comes from unit direction l and a distance.
  using Left = std::function<glm::dvec3(double at_m, glm::dvec3 position, glm::dvec3 l, double distance_m)>;
  LampsAlongRay(const World& world, glm::dvec3 origin, glm::dvec3 direction, Span span, double anisotropy, Left left);

  // Those that reach the ray, ascending indices into World::punctual_lights(); false and no more than `most` of them
  // where there are more.
  bool reaching(size_t most, std::vector<uint32_t>& lights) const;

  struct Point {
    uint32_t light = 0;   // into World::punctual_lights()
    double expected = 0;  // how many points this light has on average
    double u = 0;         // in [0, 1): which place of its light, even over it
  };
  // So many points, in the order of the tree; a light's points follow each other, and their places are strata of it:
  // one in each of `points` equal parts of the sum of all shares. offset in [0, 1) is where in its part each lies,
  // mirrored in every other one.
  void choose(int points, double offset, std::vector<Point>& chosen) const;

  // An estimate of the light of a node of the tree; a leaf's is a lamp's own.
  double importance(const LightTree::Node& node) const;

 private:
  struct Cluster {
    int node = 0;
    double importance = 0, worth = 0;  // worth: of taking it apart
  };
  bool reaches(const LightTree::Node& node) const;
  const PunctualLight& lamp_of(const LightTree::Node& leaf) const;
  double of_lamp(const PunctualLight& light) const;
  Cluster cluster(int node) const;
  void take_apart(size_t most, std::vector<Cluster>& clusters) const;
  // Of the points that fall to a node, whose fraction begins at `begin` and is `width` wide in the count of points.
  struct Part {
    const double* place;
    size_t count;
  };
  void share_out(int node, Part part, double begin, double width, std::vector<Point>& chosen) const;

  const World& world_;
  glm::dvec3 origin_, direction_;
  Span span_;
  double anisotropy_;
  Left left_;
};

}  // namespace candela::reference
