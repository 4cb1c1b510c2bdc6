#pragma once
#include "scene/scene.h"

namespace candela {

// A surface that glows all over stands for a lamp and blocks no light of point and spot lights, which mostly stand
// inside it: a bulb's glass would keep all of it in. With a texture of emission it is a thing that has lamps.
inline bool glows_all_over(const Material& m) {
  return m.emissive * m.emissive_strength != glm::vec3(0) && !m.emissive_texture;
}

}  // namespace candela
