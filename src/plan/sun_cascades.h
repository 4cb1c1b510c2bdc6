#pragma once
#include <glm/glm.hpp>
#include <memory_resource>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "passes/shadows/sun_knobs.h"
#include "scene/view.h"
#include "shared/cull.h"
#include "shared/shadows.h"

namespace candela {

// What the fit of a sun's cascades needs of the frame.
struct SunFit {
  DAabb drawn_relative;                  // of what casts and receives; not finite where bounds are unknown
  double nearest_m = 0, farthest_m = 0;  // depths of what is drawn along the view axis; infinite when unknown
  uint32_t most_px = ~0u;                // side that a map needs at most
  double scene_size_m = 1;               // sizes are rounded to parts of it
};

// One sun's cascades: what the surfaces read, and the views that its maps are drawn from.
struct SunCascades {
  shared::SunShadow shadow{};
  std::pmr::vector<shared::View> views;
};

// Far ends of the slices of the view, in metres along its axis (Zhang, Sun, Xu, Lun, "Parallel-Split Shadow Maps for
// Large-scale Virtual Environments", 2006, the practical scheme): lambda 1 is logarithmic, 0 uniform.
std::pmr::vector<double> cascade_splits(double near_m, double far_m, int count, double lambda,
                                        std::pmr::memory_resource* memory = std::pmr::get_default_resource());

// The smallest sphere around a slice of a perspective view, centre on the axis (Valient, "Stable Rendering of Cascaded
// Shadow Maps", 2008). k: the length of the two half angles' tangents.
struct SliceSphere {
  double depth_m, radius_m;
};
SliceSphere slice_sphere(double near_m, double far_m, double k);

// Axes across a light that shines along `direction`, a unit vector, and towards it: right, up, back. Without branches
// that meet a pole (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
glm::dmat3 light_axes(glm::dvec3 direction);

// Fits the cascades of one light. direction: unit, world axes, the way the light shines. Everything is placed in
// absolute coordinates in double, so that a texel covers the same ground from frame to frame wherever the camera is,
// and made relative to the camera after.
SunCascades fit_sun_cascades(glm::dvec3 direction, const View& view, const SunFit& fit, const SunKnobs& knobs,
                             uint32_t first_layer,
                             std::pmr::memory_resource* memory = std::pmr::get_default_resource());

// Texels around a point that its lookup may read, with the offset along the normal: by how much a cascade covers less
// than its map, and by how much rule A's square is smaller.
inline constexpr double widest_kernel_texels = 2.5, widest_pixel_texels = 6;
inline constexpr double lookup_reach_texels = widest_kernel_texels + widest_pixel_texels + 1.4142135623730951 + 1;

}  // namespace candela
