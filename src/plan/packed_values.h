#pragma once
#include "plan/frame_upload.h"

namespace candela {

inline float inverse_range(float range_m) {
  return std::isfinite(range_m) ? std::min(1.0f / range_m, std::numeric_limits<float>::max()) : 0.0f;
}

inline shared::WideTransform wide(const glm::dmat4& m) {
  return {glm::dvec3(m[0]), glm::dvec3(m[1]), glm::dvec3(m[2]), glm::dvec3(m[3])};
}

}  // namespace candela
