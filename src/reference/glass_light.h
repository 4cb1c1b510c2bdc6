#pragma once
#include "reference/interior.h"
#include "reference/visibility.h"

namespace candela::reference {

// transmittance() where there is glass: light that goes straight on - through smooth sheets, and through bodies of the
// index of what is about them - comes through tinted, and bodies absorb it on the way. Glass that bends or scatters
// light blocks it here; a path meets that light by way of the surface's own directions. `start`: the bodies that the
// ray begins in; null: none.
glm::dvec3 light_through(const World& world, const SurfacePoint& from, glm::dvec3 l, double distance_m,
                         const Interior* start, const SurfacePoint* target = nullptr, bool to_lamp = false,
                         LightAlong light = LightAlong::to_origin);

}  // namespace candela::reference
