#pragma once
#include "job/job.h"
#include "scene/scene.h"

namespace candela {

// Gives nodes the paths and instances that the job and its look name (docs/using/paths.md). Of one node the job's go
// before the look's; two of either are an error. The files are noted as the scene's. After an error (input or usage)
// the scene is as it was.
Expected<void> add_motion(Scene& scene, const Job& job);
// The paths alone, of a scene that has its camera and instances: read again.
Expected<void> add_paths_again(Scene& scene, const Job& job);

}  // namespace candela
