#pragma once
#include <string>

#include "passes/occlusion/occlusion.h"
#include "scene/scene.h"

namespace candela {

// occlusion.method=auto: rays, where their trees cost little beside what they give; else what the depth buffer shows.
// Trees are built once for a scene in which nothing moves, and for each frame where something does. A function of the
// scene and the animation that plays alone, so that all frames of a film have the same. `why` is a sentence for the
// user.
struct ChosenOcclusion {
  int method;  // OcclusionKnobs::by_rays or screen
  std::string why;
};
ChosenOcclusion choose_occlusion(const Scene& scene, const std::string& animation);

}  // namespace candela
