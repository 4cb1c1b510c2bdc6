#pragma once
#include <string>

#include "job/job.h"
#include "scene/scene.h"

namespace candela {

// --sides auto: whether single-sided faces, which the camera does not see from behind, let light from behind through
// (`open`) or stop it (`block`). `open` where more than a tenth of what the camera meets first, over the film, are
// backs of such faces: a room without its front wall would be dark inside. Five times of the film are looked at, on a
// grid of rays; a function of scene and job alone. Scenes of very many triangles are not looked at, and block. `why` is
// a sentence for the user; empty where it is `block`.
struct ChosenSides {
  std::string name, why;
};
ChosenSides choose_sides(const Scene& scene, const Job& job);

}  // namespace candela
