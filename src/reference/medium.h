#pragma once
#include <glm/glm.hpp>
#include <limits>

#include "look/look.h"

namespace candela::reference {

inline constexpr double endless = std::numeric_limits<double>::infinity();

// (1 - e^-x)/x, exact for all x from 0 to infinity: the naive form has lost all light at 1e-17, and is 0/0 at 0.
double one_minus_exp_over(double x);

// A stretch of a ray, in metres from its origin; empty where end is not beyond begin.
struct Span {
  double begin_m = 0, end_m = 0;
  bool empty() const { return !(end_m > begin_m); }
};

// Fog in relative space (world axes, origin at the eye). Density falls exponentially with height, so its integral along
// a ray and the inverse of that are closed forms; nothing here is stepped. Rays: any origin, directions of unit length,
// ends may be infinite.
//
// What lies between two points is measured by its length at density 1, D metres: the optical depth is extinction * D in
// every channel, and the light that a constant source over extinction J adds is J (1 - e^(-extinction D)), whatever the
// density does between.
class Medium {
 public:
  Medium(const Fog& fog, glm::dvec3 eye_world);

  const glm::dvec3& extinction() const { return extinction_; }  // per metre at density 1
  const glm::dvec3& scattering() const { return scattering_; }
  const glm::dvec3& glow() const { return glow_; }  // emission over extinction: what endless fog shows
  double anisotropy() const { return anisotropy_; }
  bool scatters() const { return scattering_ != glm::dvec3(0); }
  bool glows() const { return glow_ != glm::dvec3(0); }

  Span inside(glm::dvec3 origin, glm::dvec3 direction, Span of) const;  // the part within the bounds
  double density(glm::dvec3 position) const;                            // bounds aside
  // Of a span that lies inside the bounds.
  double length(glm::dvec3 origin, glm::dvec3 direction, Span of) const;
  // Where the length from begin_m on reaches `length`; infinity: nowhere.
  double distance_at(glm::dvec3 origin, glm::dvec3 direction, double begin_m, double length) const;

  // e^(-extinction D), channel by channel; 1 - that, without cancellation.
  glm::dvec3 through(double length) const;
  glm::dvec3 held(double length) const;
  glm::dvec3 transmittance(glm::dvec3 origin, glm::dvec3 direction, double distance_m) const;

 private:
  double log_density(double y) const { return falloff_ * (height_ - y); }

  glm::dvec3 extinction_, scattering_, glow_{0};
  double anisotropy_, falloff_, height_;
  glm::dvec3 lowest_, highest_;
  glm::dvec2 turn_{1, 0}, middle_{0};  // of the bounds: cosine and sine, and the x and z about which
};

// The phase function of Henyey and Greenstein ("Diffuse Radiation in the Galaxy", 1941), per steradian: of the cosine
// between the directions in which light travels before and after. Integrates to 1.
double henyey_greenstein(double cosine, double g);
// A direction about unit `onward` with that density; no special case at g = 0.
glm::dvec3 sample_henyey_greenstein(glm::dvec3 onward, double g, glm::dvec2 u);

}  // namespace candela::reference
