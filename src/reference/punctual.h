#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "scene/frame_data.h"

namespace candela::reference {

// Closer than this the inverse square of a point light is held, in every path (TECHNIQUES 9.3).
inline constexpr double least_light_distance_m = 0.01;

// A light of KHR_lights_punctual in relative space. Without a range it reaches everywhere: the floor at which the GPU
// ends such lights (lights.floor_lux) is an approximation of its own.
struct PunctualLight {
  LightType type = LightType::point;
  glm::dvec3 position{0}, direction{0, 0, -1};  // the way it shines, unit
  glm::dvec3 intensity{0};                      // cd, or lux for a directional one, times colour
  double range_m = 0;                           // infinity: none
  double cos_inner = 1, cos_outer = -1;
  double radius_rad = 0;  // of a directional light's disc in the sky; 0: a point
};
PunctualLight punctual_light(const LightItem& item);

// What arrives at a point: illuminance (lux, times colour) on a surface that faces the light, and where it comes from.
// Of a disc the number u in [0, 1)^2 chooses the direction, evenly in solid angle; the mean over u is the whole disc's
// light, of one radiance, and gives a surface that faces it the light's illuminance.
struct Arrival {
  glm::dvec3 illuminance{0};
  glm::dvec3 l{0, 1, 0};  // unit, towards the light
  double distance_m = 0;  // infinity for directional lights
};
Arrival arriving(const PunctualLight& light, glm::dvec3 position, glm::dvec2 u = glm::dvec2(0));

}  // namespace candela::reference
