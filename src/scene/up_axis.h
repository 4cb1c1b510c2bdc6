#pragma once
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace candela {

// Which axis of a file points up: glTF says y; files of other programs are written with z, seldom x (--up).
std::vector<std::string> up_axes();  // x, y, z

// The rotation by which `up` becomes y: the front of a file with z up, -y, becomes glTF's, z.
glm::dmat3 world_from_file(const std::string& up);

// Turns all that a scene holds: a node above its roots. Nothing for y.
void turn_up(Scene& scene, const std::string& up);

}  // namespace candela
