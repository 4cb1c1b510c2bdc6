#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "bvh/trace.h"

namespace candela {

inline constexpr uint32_t no_relief = 0xffffffffu;  // of items

// A ray in relative space (world axes, origin at the camera). The direction need not be of unit length; t counts in its
// length, so a point is origin + t * direction.
struct Ray {
  glm::vec3 origin{0};
  float t_min = 0;
  glm::vec3 direction{0, 0, -1};
  float t_max = std::numeric_limits<float>::infinity();
  // Of a ray that begins on a relief: the triangle below which it does.
  uint32_t relief_item = no_relief, relief_primitive = 0;
};

struct Hit {
  float t = std::numeric_limits<float>::infinity();
  // Weights of the triangle's second and third corner; the first has 1 - u - v. Of a relief those of the triangle's
  // point above, which may lie beside the triangle.
  float u = 0, v = 0;
  uint32_t item = 0;       // into FrameData::items
  uint32_t primitive = 0;  // triangle of the item's section: its corners are section.index[3 * primitive + 0, 1, 2]
  bool back = false;       // the ray meets the side that glTF calls the back (mirrored items turned over already)
  glm::vec3 point{0};      // of an item that is no triangles but an implicit surface: where, relative space
};

// What a ray cost, for heat maps: boxes and triangles tested one by one (a wide node counts the children it has).
using TraceCounts = KernelCounts;

// Decides about hits that the material leaves in doubt (masks, blending, culled backs). The same candidate may be
// offered more than once and in any order, so the answer must depend on it alone.
class HitFilter {
 public:
  virtual bool accepts(const Hit& candidate) const = 0;

 protected:
  ~HitFilter() = default;
};

}  // namespace candela
