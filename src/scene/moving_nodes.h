#pragma once
#include <vector>

#include "scene/pose.h"
#include "scene/scene.h"

namespace candela {

// Of each node, whether what it shows may be elsewhere, of another form or not there at another time: by what plays it,
// a node above it, its morph weights, a joint of its skin or a ball of its metaballs. Materials and lights count not. A
// function of the scene alone, so that it is the same for all frames.
std::vector<bool> moving_nodes(const Scene& scene, const AnimationChoice& choice);

}  // namespace candela
