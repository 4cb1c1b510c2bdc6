#pragma once
#include <filament/Engine.h>
#include <filament/Material.h>
#include <filament/MaterialInstance.h>
#include <filament/Scene.h>
#include <filament/Texture.h>
#include <math/mat4.h>
#include <utils/Entity.h>

#include <vector>

#include "base/error.h"
#include "scene/frame_data.h"

namespace candela::peers {

filament::math::mat4f filament_matrix(const glm::mat4& matrix);

// A scene as candela flattens it (frame_data.h), as Filament's objects: a renderable for each drawn item and a light
// for each light, in relative space, whose origin is the camera. So both programs draw the same from the same numbers.
// Takes what the street uses: opaque triangles, vertex colours, factors, an emissive texture; anything else is an
// error.
class FilamentScene {
 public:
  // shadowed: how many spot lights cast shadows, the nearest to the camera first; points cast none in Filament 1.9.
  static Expected<FilamentScene> make(filament::Engine& engine, const Scene& scene, const Pose& pose,
                                      const FrameData& frame, int shadowed = 0);
  // Moves what moved and sets every light's position, direction and intensity.
  Expected<void> move(filament::Engine& engine, const FrameData& frame);
  filament::Scene* scene() const { return scene_; }

 private:
  filament::Scene* scene_ = nullptr;
  std::vector<utils::Entity> items_, lights_;
  std::vector<glm::mat4> placed_;  // as last given to Filament, by item
};

}  // namespace candela::peers
