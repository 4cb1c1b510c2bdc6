#pragma once
#include <array>

#include "reference/bsdf.h"

namespace candela::reference {

// The bodies that a point lies in, in the order in which a path entered them. Where they overlap the one entered last
// counts, for refraction and for absorption; leaving another changes nothing. Bodies are known by their material:
// surfaces that share one bound one body, in whichever items they are.
class Interior {
 public:
  bool empty() const { return count_ == 0; }
  bool holds(const Glass& glass) const;
  void enter(const Glass& glass);
  void leave(const Glass& glass);                     // the last of this material, if there is any
  double ior() const;                                 // 1 in the open
  glm::dvec3 transmittance(double distance_m) const;  // what is left of light after this way (Beer and Lambert)
  const BodyMedium* medium() const;                   // that scatters; null: none does

  // Of the light that is followed, where a body has split its colours: red 0, green 1, blue 2; -1: all of them.
  int channel = -1;

 private:
  static constexpr int most_ = 8;  // nested deeper, bodies are as the one about them
  std::array<const Glass*, most_> bodies_{};
  int count_ = 0;
};

// What lies about a surface on the side of a direction.
inline const Interior* bodies_towards(const Surface& s, glm::dvec3 l) {
  return glm::dot(s.geometric, l) > 0 ? s.before : s.behind;
}

// A straight way that light takes through bodies, from one surface to the next.
class GlassWay {
 public:
  GlassWay() = default;
  explicit GlassWay(const Interior& start) : here_(start) {}

  // At a surface `distance_m` from where the ray began: what is left of the light since the surface before, and what
  // the surface needs to know of either side of it; it points to this object then. v: to where the light is followed
  // from; back: as the hit says.
  glm::dvec3 arrive(Surface& s, glm::dvec3 v, bool back, double distance_m);
  // On to the end, without a surface.
  glm::dvec3 end(double distance_m) const { return here_.transmittance(distance_m - travelled_); }
  void cross() { here_ = behind_; }
  bool in_body() const { return !here_.empty(); }
  const Interior& here() const { return here_; }
  double travelled_m() const { return travelled_; }  // up to the last surface, of the ray
  void start_ray() { travelled_ = 0; }

  // Where the surface splits colours and none is chosen yet: follows one of them. What the choice weighs.
  glm::dvec3 choose_channel(const Surface& s, double u);
  bool splits(const Surface& s) const;

 private:
  Interior here_, behind_;
  double travelled_ = 0;
};

}  // namespace candela::reference
