#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scene/frame_data.h"

namespace candela::reference {

// A light of KHR_lights_punctual in relative space. Without a range it reaches everywhere: the floor at which the GPU
// ends such lights (lights.floor_lux) is an approximation of its own.
struct PunctualLight {
  LightType type = LightType::point;
  glm::dvec3 position{0}, direction{0, 0, -1};  // the way it shines, unit
  glm::dvec3 intensity{0};                      // cd, or lux for a directional one, times colour
  double range_m = 0;                           // infinity: none
  double cos_inner = 1, cos_outer = -1;
  double radius_rad = 0;  // of a directional light's disc in the sky; 0: a point
  double radius_m = 0;    // of a point's or spot's sphere; 0: a point
  uint32_t group = 0;     // of lights (WorldInput::light_group_of)
  double least_m = 0.01;  // nearer than this the inverse square is held (scene/scene_size.h)
  bool has_size() const { return radius_rad > 0 || radius_m > 0; }
};
PunctualLight punctual_light(const LightItem& item, double least_m = 0.01);

// What arrives at a point: illuminance (lux, times colour) on a surface that faces the light, and where it comes from.
// Of a light of a size the number u in [0, 1)^2 chooses the direction, evenly in solid angle; the mean over u is the
// whole light's.
//
// A disc in the sky and a sphere are seen with one radiance, which gives a surface that faces them what the point in
// their middle gives: the window of the range, the cone of a spot and the inverse square are those of the sphere's
// centre. In each direction it is thus as intense as the punctual light. Inside the sphere light of the radiance at its
// surface comes from all sides.
struct Arrival {
  glm::dvec3 illuminance{0};
  glm::dvec3 l{0, 1, 0};  // unit, towards the light
  double distance_m = 0;  // to the light's surface; infinity for directional lights
  double pdf = 0;         // of l, 1/sr; 0: the light has no size, and no other way to choose l finds it
};
Arrival arriving(const PunctualLight& light, glm::dvec3 position, glm::dvec2 u = glm::dvec2(0));
// The light that lies in unit direction l; nothing where it has no size or l passes by it. The illuminance is what
// arriving() says of that direction.
std::optional<Arrival> light_in(const PunctualLight& light, glm::dvec3 position, glm::dvec3 l);

}  // namespace candela::reference
