#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "shared/image_light.h"
#include "sky/sky_pyramid.h"

namespace candela {

// A sky cut in two: `rest` and small bright spots, which together are the sky.
struct SkyParts {
  SkyLevel rest;
  std::vector<shared::SkyLight> lights;  // the brightest first
};

// Takes out of the sky what is brighter than eight times the mean of what is left, as at most `most` lights. Spots that
// touch are one; wide ones are cut in two across their longer axis until each is a few degrees wide, and what the
// number of lights does not suffice for stays in the rest. No light is lost: each light has the illuminance of the
// texels that it stands for, from their middle. In the manner of Debevec, "A Median Cut Algorithm for Light Probe
// Sampling", 2005. Leaves wrong: a light has no width.
SkyParts take_lights(const SkyLevel& sky, int most);

// The luminance above which it takes light; infinite where nothing is so bright.
double light_threshold(const SkyLevel& sky);
double luminance(const SkyTexel& texel);

}  // namespace candela
