#pragma once
#include <functional>

#include "image/image.h"
#include "reference/integrator.h"
#include "stability/measure.h"

namespace candela {

// A scene in fog by the reference, as a picture that is measured like those of the techniques: direct with one sample
// at each pixel's centre, path with the noise of some; `known` holds the radiance of each pixel's centre where it is
// known.
struct FogPicture {
  Beauty beauty;
  DisplayImage display;
  std::optional<TruePicture> known;
};
Expected<FogPicture> fog_picture(const Job& job, reference::Mode mode,
                                 const std::function<glm::dvec3(glm::dvec3)>& known);

// Energy that noise may gain or lose in path.
inline constexpr double fog_noise_bound = 0.02;

}  // namespace candela
