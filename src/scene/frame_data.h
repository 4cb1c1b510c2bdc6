#pragma once
#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scene/instance_layout.h"
#include "scene/light_layout.h"
#include "scene/metaballs.h"
#include "scene/pose.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace candela {

// One drawable: a mesh section at one instance of one node.
struct DrawItem {
  uint32_t mesh = 0, section = 0, node = 0, instance = 0;  // instance within EXT_mesh_gpu_instancing
  uint32_t transform = 0;                                  // into FrameData::relative_from_local
  int material = -1;                                       // into Pose::materials, -1 default
  bool mirrored = false;                                   // determinant < 0: front faces are clockwise
  int deformed = -1;                                       // into FrameData::deformations; -1: the static vertices
  Aabb bounds_relative;     // holds every vertex at this time (skins, morphs and rounding included), relative space
  double view_depth_m = 0;  // of the bounds' centre, for sorting blended items back to front
};

// A skinned or morphed section whose vertices are made anew for the frame. Skinned vertices come out in relative space.
struct Deformation {
  uint32_t mesh = 0, section = 0;
  uint32_t first_joint = 0, joint_count = 0;    // into FrameData::joint_matrices; 0 joints: morph only
  uint32_t first_weight = 0, weight_count = 0;  // into FrameData::morph_weights
  // Of metaballs instead: into FrameData::metaballs, and which chunk of the body's triangles; they come out in the
  // lattice's space (metaballs.h).
  int body = -1;
  uint32_t chunk = 0;
};

struct LightItem {  // a light in relative space
  LightType type;
  glm::vec3 position{0};   // relative, metres
  glm::vec3 direction{0};  // unit, the way the light shines
  glm::vec3 intensity{0};  // color * intensity
  float range_m;           // infinity: none
  float inner_cone_rad, outer_cone_rad;
  uint32_t node = 0;
  float radius_m = 0;  // of a point or spot light's sphere; 0: a point
  // Not 0: it stands for lights that end, and gives what they no longer do: by the range's window, less that of a range
  // of inner_m (plan/stand_ins.h).
  float inner_m = 0;
  double radius_rad = 0;  // of a directional light's disc in the sky; 0: a point
  bool is_hard = false;   // so narrow a disc that its shadows are those of a point
  glm::dvec3 world_position{0};
};

// The light instances of a node, which a compute pass poses; in the frame's list they stand together.
struct LightGroup {
  const LightSet* set;
  uint32_t before = 0;  // of FrameData::lights, those that come first
  LightItem light;      // the template: without place, its direction that of an instance without one
  glm::vec3 color{0};
  double candela = 0;  // of the template
  // Relative space from the node's: position = origin + linear * translation.
  glm::dvec3 origin{0};
  glm::dmat3 linear{1.0};
};

// The instances of a node, which a compute pass poses (passes/geometry/pose_items.h); each shows the set's sections.
struct ItemGroup {
  const InstanceSet* set;
  uint32_t before = 0;  // of FrameData::items, those that come first
  uint32_t node = 0, mesh = 0;
  bool mirrored = false;
  glm::dmat4 relative_from_node{1.0};
  glm::dvec3 world_origin{0};  // of the node
  size_t item_count() const { return size_t(set->count) * set->sections.size(); }
};

struct FrameData {
  std::vector<glm::mat4> relative_from_local;  // composed in double, cast once
  std::vector<glm::dvec3> world_origins;       // of the same spaces, wherever the camera is
  std::vector<DrawItem> items;                 // node order; blended ones not yet sorted
  std::vector<ItemGroup> item_groups;          // in node order; items that are not among `items`
  std::vector<Deformation> deformations;
  std::vector<glm::mat4> joint_matrices;  // relative_from_bind
  std::vector<float> morph_weights;
  std::vector<PosedMetaballs> metaballs;  // in node order
  std::vector<LightItem> lights;          // in node order; zero intensity ones left out
  std::vector<LightGroup> light_groups;   // in node order; instances that are not among `lights`
  // The first directional light in node order, of zero intensity too: skies follow it when its light has faded.
  std::optional<LightItem> first_sun;
  bool perspective = true;  // of the view
  size_t light_count() const;
  size_t item_count() const;
};

// World bounds of everything visible at this pose.
DAabb world_bounds(const Scene& scene, const Pose& pose);

// The instances that may become groups; null: none.
struct DevicePose {
  const LightLayout* lights = nullptr;
  const InstanceLayout* instances = nullptr;
};

// Flattens a posed scene for one view. Pure; the same input gives the same bytes. lamp_radius_m: of point and spot
// lights that say nothing of it. cells: of metaballs' lattices, in units of what the scene says.
FrameData make_frame_data(const Scene& scene, const Pose& pose, const View& view, double lamp_radius_m = 0,
                          const DevicePose& on_device = {}, double cells = 1);

// A box about all that a cluster of the group shows, in relative space: about its items' boxes, however they are
// rounded.
DAabb relative_box(const ItemGroup& group, const InstanceCluster& cluster);
// The box that an item of the group has (DrawItem::bounds_relative).
Aabb bounds_of(const Scene& scene, const ItemGroup& group, uint32_t instance, uint32_t section);

}  // namespace candela
