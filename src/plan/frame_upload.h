#pragma once
#include <algorithm>
#include <vector>

#include "passes/shared/frame_request.h"
#include "scene/draw_list.h"
#include "scene/environment.h"
#include "scene/frame_data.h"
#include "scene/geometry_layout.h"
#include "scene/survey.h"
#include "shared/cull.h"
#include "shared/deform.h"
#include "shared/lobes.h"
#include "shared/metaballs.h"
#include "shared/pose_items.h"
#include "shared/pose_lights.h"
#include "shared/scene.h"
#include "shared/visibility.h"

namespace candela {

// What the CPU makes anew for every frame, in the layout of shaders/shared. Pure; device addresses and texture indices
// are filled in by GpuScene.
struct FrameUpload {
  shared::FrameConstants constants{};
  std::vector<shared::Transform> transforms;
  std::vector<shared::Place> places;         // of the transforms
  std::vector<shared::Geometry> geometries;  // static sections first, then one for each deformation
  std::vector<shared::Item> items;           // posed here, in draw order
  uint32_t item_count = 0;                   // of all, those of groups among them
  uint32_t transform_count = 0;              // likewise; those posed here come first
  // Where a pass poses some: a row for what is posed here, and one for each group; spans of all items.
  std::vector<shared::ItemGroup> item_groups;
  std::vector<shared::ItemSpan> item_spans;
  std::vector<shared::ItemSection> item_sections;
  std::vector<shared::Material> materials;  // the pose's, and the default one; GpuScene fills in their textures
  std::vector<uint32_t> lobes;              // words of shared/lobes.h; empty: no material has any. Textures likewise
  std::vector<shared::Light> lights;        // posed here; among those of groups, in the order of nodes
  std::vector<shared::LightGroup> light_groups;  // of all lights, where a pass poses some; else none
  std::vector<shared::CullGroup> groups;
  std::vector<shared::TriangleBatch> batches;  // of items posed here; empty unless add_batches made them
  uint32_t batch_count = 0;                    // of all
  std::vector<shared::BatchSpan> batch_spans;  // of all, where a pass poses items
  std::vector<uint32_t> triangle_numbers;      // empty unless add_triangle_numbers did
  std::vector<uint32_t> drawn_items;           // empty unless add_drawn_items did
  std::vector<shared::DeformJob> deform_jobs;
  uint32_t deformed_words = 0;
  // matte_id of each node's and material's name, the default material's last; empty unless their layers are wanted.
  std::vector<uint32_t> object_mattes, material_mattes;
  // The time before, where the layer motion is wanted and something moves: a shared::Motion and its transforms, and
  // what vertices are deformed by where that differs.
  std::vector<glm::vec4> motion;
  std::vector<Relief> reliefs_before;  // of materials; empty: as they are
  std::vector<glm::mat4> joints_before;
  std::vector<float> weights_before;
  // Of metaballs (shared/metaballs.h); the last likewise of the time before.
  std::vector<shared::MetaballBody> metaball_bodies;
  std::vector<shared::LatticeBall> metaballs;
  std::vector<shared::MetaballBlock> metaball_blocks;
  std::vector<uint32_t> metaball_lists;
  std::vector<shared::LatticeBallBefore> metaballs_before;
  void clear();  // as new, but for the tables' memory
};
// upload: whatever it held, its memory is used again.
void make_frame_upload(const Scene& scene, const Pose& pose, const View& view, const FrameData& data,
                       const DrawList& draws, const GeometryLayout& layout, const FrameRequest& request,
                       const AmbientSh& ambient, FrameUpload& upload);
inline FrameUpload make_frame_upload(const Scene& scene, const Pose& pose, const View& view, const FrameData& data,
                                     const DrawList& draws, const GeometryLayout& layout, const FrameRequest& request,
                                     const AmbientSh& ambient) {
  FrameUpload upload;
  make_frame_upload(scene, pose, view, data, draws, layout, request, ambient, upload);
  return upload;
}
// The instances as a pass poses them, in the order of the layout.
std::vector<shared::LightInstance> pack_light_instances(const Scene& scene, const LightLayout& layout);
// The instances as a pass poses them, in the order of the layout.
std::vector<shared::WideTransform> pack_mesh_instances(const InstanceLayout& layout);
// Adds the batches in which compute rasterizes opaque and masked triangles.
void add_batches(const DrawList& draws, FrameUpload& upload);
// Of each item of the frame's data, which has no groups, the number of its first triangle among those batches;
// shared::absent: it has none.
void add_triangle_numbers(const DrawList& draws, FrameUpload& upload);
// Of each item of the frame's data, which has no groups, its place among those that are drawn.
void add_drawn_items(const DrawList& draws, FrameUpload& upload);
// Adds the time before, where anything moves in the picture: items of both are one for one.
void add_motion(const FrameData& now, const View& view, const FrameData& before, const View& view_before,
                FrameUpload& upload);
// Before add_motion(): the reliefs of the time before, where they move.
void add_reliefs_before(const Pose& now, const Pose& before, FrameUpload& upload);

}  // namespace candela
