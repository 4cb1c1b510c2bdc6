#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "math/bounds.h"

namespace candela::reference {

// What the tree knows of a light: where it is, how strong, and which way it shines. All light leaves within theta_o +
// theta_e of the axis; normals of the emitter lie within theta_o.
struct LightExtent {
  DAabb box;
  double power = 0;  // any unit, the same for all
  glm::dvec3 axis{0, 0, 1};
  double theta_o = 0, theta_e = 0;  // radians
  double range_m = std::numeric_limits<double>::infinity();
  bool is_sphere = false;  // a ray may meet it (LightTree::met())
};

// Picks a few of many lights for a point, with probabilities near to their fractions of what arrives there (Conty
// Estévez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018). A light that may reach
// the point has a probability above 0. One that cannot - out of range, behind the surface, turned away - mostly has
// none.
class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::vector<LightExtent> lights);

  struct Choice {
    uint32_t light;
    double probability;
  };
  // A normal of zero: light counts from all sides. One light, or with `split` one of each cluster that lies away from
  // the point: those about the point hold lights of which a common estimate says little, and are taken apart. The
  // probability is that of being among the chosen; u in [0, 1). A normal of 0: no surface, light from every side
  // counts.
  void choose(glm::dvec3 point, glm::dvec3 normal, double u, bool split, std::vector<Choice>& chosen) const;
  double probability(uint32_t light, glm::dvec3 point, glm::dvec3 normal, bool split) const;
  bool empty() const { return nodes_.empty(); }
  // The spheres among the lights whose boxes' spheres a ray meets, in the order of the tree.
  void met(glm::dvec3 origin, glm::dvec3 direction, std::vector<uint32_t>& lights) const;
  bool has_spheres() const { return !nodes_.empty() && nodes_[0].extent.is_sphere; }

  struct Node {
    LightExtent extent;
    // Of the extent: box centre and half diagonal, and functions of its angles, that every visit needs.
    glm::dvec3 centre{0};
    double radius = 0, cos_o = 1, sin_o = 0, cos_e = 1;
    int left = -1, right = -1, parent = -1;
    uint32_t light = 0;  // of a leaf
  };
  // Each before its children, the left one's before the right one's; the first is the root.
  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  static bool is_about(const Node& node, glm::dvec3 point);
  static double importance(const Node& node, glm::dvec3 point, glm::dvec3 normal);
  int build(std::vector<uint32_t>& order, size_t first, size_t last, const std::vector<LightExtent>& lights,
            int parent);

  std::vector<Node> nodes_;
  std::vector<int> leaf_of_light_;
};

// The least cone about both: an axis and the half angle of normals.
void merge_cones(glm::dvec3 axis_a, double theta_a, glm::dvec3 axis_b, double theta_b, glm::dvec3& axis, double& theta);

}  // namespace candela::reference
