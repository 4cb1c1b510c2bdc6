#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "graph/builder.h"
#include "passes/shared/frame_values.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/views.h"
#include "scene/draw_list.h"

namespace candela {

// Nodes of one tree for rays among those of all, for what looks at them.
struct TreeRange {
  uint32_t first_node, nodes;
  uint32_t instance;  // that shows it, among those of the trees; shared::no_trace: none, it is of relative space
  bool holds_instances;
};

// What every pass that touches the scene takes: the uploaded buffers, the frame's shape, and the draw batches.
struct SceneInputs {
  BufferHandle constants, vertices, indices, items, transforms, geometries, materials, lights, cull_groups;
  BufferHandle lobes;             // of materials; empty without
  BufferHandle triangle_numbers;  // empty unless rays find what the camera sees
  BufferHandle drawn_items;       // empty unless what rays meet is shaded
  BufferHandle batches;           // empty unless triangles are rasterized in compute
  // What a pass poses items from (passes/geometry/pose_items.h), which then fills `transforms`, `items` and `batches`.
  // Empty: the host has posed all.
  BufferHandle item_groups, item_spans, item_sections, mesh_instances, batch_spans;
  BufferHandle posed_transforms, posed_items, posed_batches;
  BufferHandle places, posed_places;  // where transforms lie in the world; empty unless lamps' maps are drawn apart
  uint32_t item_group_count = 0, item_span_count = 0, batch_span_count = 0, transform_count = 0;
  // What a pass poses lights from (passes/lights/pose_lights.h); `lights` is then empty until it has. Empty: the host
  // has posed all.
  BufferHandle light_groups, light_instances, posed_lights;
  uint32_t light_group_count = 0;
  BufferHandle light_globals;                               // empty without light lists
  BufferHandle light_bounds, light_chunks, light_dispatch;  // the same, and where a pass finds them
  LightGridShape light_grid;
  BufferHandle views, view_regions, suns;             // of shadow maps; empty without
  BufferHandle lamp_views, lamp_view_regions, lamps;  // the same of point and spot lights
  BufferHandle moving;                                // nodes that move; empty unless lamps' maps tell these apart
  std::shared_ptr<const ViewImage> sun_image, lamp_image;
  std::shared_ptr<const std::vector<uint32_t>> view_first_command, lamp_first_command;
  std::string sun_absence, lamp_absence;                      // why there are none
  std::optional<Hash128> sun_key, lamp_key;                   // of the images of maps, where they may be kept
  BufferHandle trees, ray_settings;                           // empty: nothing is traced
  TracedRays rays;                                            // but for its handles, which are these
  std::shared_ptr<const std::vector<TreeRange>> tree_ranges;  // null: nothing is traced
  BufferHandle deform_jobs, joints, weights;                  // empty when nothing is deformed
  // What polygons of metaballs are made from (passes/geometry/metaballs.h); empty without. The last: where motion is
  // asked for. `polygons` are what it has made of deformed vertices, which `deform` adds to.
  BufferHandle metaball_bodies, metaballs, metaball_blocks, metaball_lists, metaballs_before;
  BufferHandle polygons, polygons_before;
  uint32_t metaball_body_count = 0, metaball_block_room = 0;
  BufferHandle object_mattes, material_mattes;  // ids of names; empty unless their layers are wanted
  // Where things were at the time before (shared/motion.h); empty: nothing moves, or it is not asked for. The last two
  // are empty where deformed vertices are the same.
  BufferHandle motion, joints_before, weights_before;
  std::shared_ptr<const std::vector<DrawBatch>> draw_batches;
  std::vector<SpecConstant> features;  // of shaders/lib/features.glsl, from the visible materials
  uint32_t item_count = 0, cull_group_count = 0, batch_count = 0;
  uint32_t light_room = 0;                // at least as many as there are lights (FrameValues::light_count)
  std::vector<uint32_t> deform_vertices;  // vertex count of each deform job
  uint32_t deformed_words = 0;            // size of the deformed buffer
  bool open_sides = false;                // light passes single-sided faces from behind (--sides)
  uint32_t width_px = 0, height_px = 0, samples = 1;
  bool stores_samples = true;  // compute stores into multisampled images, of as many samples
  // Of one picture of a supersampled frame, or of one of the frames of a picture: how far its samples lie off the
  // middles of pixels, right and down, their side in pixels, and which of how many samples of a pixel it is.
  bool is_subsample = false;
  glm::dvec2 supersample_px{0};
  glm::dvec2 supersample_grid{1};
  float subsample_footprint = 1;
  uint32_t supersample = 0, supersamples = 1;   // which of how many pictures of this frame
  uint32_t subsamples = 1;                      // of all frames
  std::array<float, 4> background{0, 0, 0, 0};  // premultiplied, pre-exposed
  const FrameValues* values = &FrameValues::none;
  // Both for recording alone. In normalised device coordinates.
  glm::vec2 subsample_ndc() const {
    const glm::dvec2 offset_px = supersample_px + values->offset_px / supersample_grid;
    if (offset_px == glm::dvec2(0)) return glm::vec2(0);  // also without a picture
    return glm::vec2(2.0 * offset_px / glm::dvec2(width_px, height_px));
  }
  uint32_t subsample() const { return values->subframe * supersamples + supersample; }
  bool operator==(const SceneInputs&) const = default;
};

inline constexpr VkFormat color_format = VK_FORMAT_R32G32B32A32_SFLOAT;
inline constexpr VkFormat depth_format = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat float_format = VK_FORMAT_R32_SFLOAT;

}  // namespace candela
