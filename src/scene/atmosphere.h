#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "image/io.h"
#include "look/look.h"

namespace candela {

inline constexpr int atmosphere_width = 512;  // texels along the horizon of the images of air: 0.7 degrees each

// The Earth's air by day: molecules, aerosols and ozone on a sphere, single scattering integrated along each ray, all
// higher orders as light from all sides that is kept in a table (Hillaire, "A Scalable and Production Ready Sky and
// Atmosphere Rendering Technique", 2020, whose coefficients and profiles these are; Bruneton and Neyret, "Precomputed
// Atmospheric Scattering", 2008, and Bruneton's code of 2017 for the transmittance's parameters). Directions: +Y is up.
// Leaves wrong: higher orders have no direction; three wavelengths stand for the spectrum; the sun's disc is not in the
// image, for it is a light of its own; no moon, stars or clouds, so that the night is black.
class Air {
 public:
  explicit Air(const Atmosphere& atmosphere);
  // cd/m2 per lux of the sun above the air, in a direction as the observer sees it.
  glm::dvec3 radiance(glm::dvec3 direction, glm::dvec3 to_sun) const;
  // The fraction of the sun's light that is left at a height, sine of the sun's elevation there.
  glm::dvec3 transmittance(double height_m, double sine) const;
  DecodedImage image(glm::dvec3 to_sun, int width, int height) const;  // equirectangular, rgba32f

 private:
  struct Medium;
  struct Scattered {
    glm::dvec3 light{0}, through{1}, isotropic{0};  // isotropic: the fraction that meets air at all, for higher orders
  };
  Medium medium(double height_m) const;
  glm::dvec3 sun_at(double radius_m, double sine) const;
  glm::dvec3 higher_orders(double radius_m, double sine) const;
  enum class Orders { single_isotropic, all };
  Scattered follow(glm::dvec3 from, glm::dvec3 direction, glm::dvec3 to_sun, int steps, Orders orders) const;
  void make_transmittance();
  void make_higher_orders();
  void make_ground_light();

  Atmosphere atmosphere_;
  std::vector<glm::vec3> transmittance_, higher_, ground_;
};

}  // namespace candela
