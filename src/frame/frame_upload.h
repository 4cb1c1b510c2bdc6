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

// The part of an exposure that is in the linear pictures: enough to keep bright light within a half's range, little
// enough that nothing leaves a float's. Tone mapping applies the rest.
inline float pre_exposure_ev(float exposure_ev) { return std::clamp(exposure_ev, -20.0f, 20.0f); }

// What the CPU makes anew for every frame, in the layout of shaders/shared. Pure; device addresses and texture indices
// are filled in by GpuScene.
struct FrameUpload {
  shared::FrameConstants constants{};
  std::vector<shared::Transform> transforms;
  std::vector<shared::Geometry> geometries;  // static sections first, then one for each deformation
  std::vector<shared::Item> items;           // in draw order
  std::vector<shared::Light> lights;
  std::vector<shared::CullGroup> groups;
  std::vector<shared::DeformJob> deform_jobs;
  uint32_t deformed_words = 0;
};
FrameUpload make_frame_upload(const Scene& scene, const Pose& pose, const View& view, const FrameData& data,
                              const DrawList& draws, const GeometryLayout& layout, const FrameRequest& request,
                              const AmbientSh& ambient);

// A material without its textures' indices, which only a device knows.
shared::Material shared_material(const Material& material, uint32_t id);

}  // namespace candela
