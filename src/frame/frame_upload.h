#pragma once
#include <algorithm>
#include <vector>

#include "scene/draw_list.h"
#include "scene/environment.h"
#include "scene/frame_data.h"
#include "scene/geometry_layout.h"
#include "scene/survey.h"
#include "shared/cull.h"
#include "shared/deform.h"
#include "shared/scene.h"

namespace candela {

// What the CPU makes anew for every frame, in the layout of shaders/shared. Pure; device addresses and texture indices
// are filled in by GpuScene.
struct FrameUpload {
  shared::FrameConstants constants{};
  std::vector<shared::Transform> transforms;
  std::vector<shared::Geometry> geometries;  // static sections first, then one for each deformation
  std::vector<shared::Item> items;           // in draw order
  std::vector<shared::Material> materials;   // the pose's, and the default one; GpuScene fills in their textures
  std::vector<shared::Light> lights;
  std::vector<shared::CullGroup> groups;
  std::vector<shared::DeformJob> deform_jobs;
  uint32_t deformed_words = 0;
};
FrameUpload make_frame_upload(const Scene& scene, const Pose& pose, const View& view, const FrameData& data,
                              const DrawList& draws, const GeometryLayout& layout, const FrameRequest& request,
                              const AmbientSh& ambient);

}  // namespace candela
