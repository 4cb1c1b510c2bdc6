#pragma once
#include "reference/world.h"

namespace candela::reference {

// The nearest opaque or masked surface that a ray of the camera meets; nothing: none.
std::optional<Hit> nearest_surface(const World& world, const CameraRay& camera);

// What the layers of raster techniques hold of a pixel (docs/using/outputs.md): the nearest opaque or masked surface at
// its centre. One ray and no mean over samples: an averaged id or depth would name a surface that does not exist.
struct CentreSurface {
  uint32_t item = 0;  // into FrameData::items
  uint32_t primitive = 0;
  glm::dvec2 weights{0};  // of the triangle's second and third corner
  double depth_m = 0;     // along the view axis
  Surface surface;
};
std::optional<CentreSurface> centre_surface(const World& world, int x, int y, int width_px, int height_px);

}  // namespace candela::reference
