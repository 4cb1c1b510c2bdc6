#pragma once
#include "scene/scene.h"

namespace candela {

// The diagonal of the scene's world bounds without animations, in metres: lengths that no file gives are parts of it,
// so that a scene at another scale is drawn alike. 0: nothing is drawn, or bounds are not finite.
double scene_size_m(const Scene& scene);

// Nearer than this the inverse square of a point or spot light is held, in both renderers: a millionth of the scene's
// size; a centimetre where nothing is drawn.
double least_light_distance_m(const Scene& scene);

}  // namespace candela
