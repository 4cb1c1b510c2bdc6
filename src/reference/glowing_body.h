#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace candela {
class MetaballSurface;
}

namespace candela::reference {

// A body of metaballs that emits, as lights are chosen: directions from a point, evenly over the cones of spheres that
// hold the surface, and where each meets it first. Directions that miss it carry nothing. Relative space.
class GlowingBody {
 public:
  GlowingBody(uint32_t item, const MetaballSurface& surface, bool two_sided);

  uint32_t item() const { return item_; }
  bool two_sided() const { return two_sided_; }
  const std::vector<glm::dvec4>& spheres() const { return spheres_; }  // centre and radius; none: it has no surface

  struct Met {
    glm::dvec3 direction{0};  // unit
    double distance_m = 0;
    bool back = false;
  };
  // Where the surface is met first, but for a point of it that the ray leaves; directions are of length 1.
  std::optional<Met> first(glm::dvec3 from, glm::dvec3 direction) const;
  std::optional<Met> sample(glm::dvec3 from, glm::dvec2 u) const;
  // Of sample(), per steradian, over directions that the cones hold; elsewhere 0.
  double density(glm::dvec3 from, glm::dvec3 direction) const;

 private:
  uint32_t item_;
  const MetaballSurface* surface_;
  bool two_sided_;
  std::vector<glm::dvec4> spheres_;
};

}  // namespace candela::reference
