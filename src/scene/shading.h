#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace candela {

// How surfaces answer light (--shading).
struct ShadingName {
  std::string name;
  std::string says;  // one line
};
const std::vector<ShadingName>& shadings();

// Makes a scene's materials those of a shading, the one of surfaces without a material too, and takes away the channels
// of animations that would undo it; both renderers then draw it as any other scene. Unlit materials stay as they are.
//
// pbr: nothing changes. blinn-phong: the base with the lobe of Blinn (1977) instead of facets; nothing lies on it or
// shines through. lambert: the base colour alone, reflected alike in all directions (Lambert 1760): no metal, no gloss,
// nothing shines through; normal maps, occlusion, emission and alpha stay.
void apply_shading(Scene& scene, const std::string& name);

// Takes away what lies on a material's base or lets light through it.
void leave_base(Material& material);

}  // namespace candela
