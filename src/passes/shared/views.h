#pragma once
#include <algorithm>
#include <bit>
#include <memory>
#include <string>
#include <vector>

#include "graph/handle.h"
#include "graph/plan.h"
#include "passes/shared/knob_tables.h"
#include "shared/cull.h"

namespace candela {

// The views of a range as the host knows them, and the layered image of square maps that their depth is drawn into:
// those of one layer are neighbours, and every layer has one.
struct ViewImage {
  std::string name;
  uint32_t size_px = 0, layers = 0;
  std::vector<shared::View> views;
  // Each view is drawn apart, about its light and in a place that only its size decides, so that its texels are the
  // same whatever the camera and the other views are; `views` says where its tile is in the image that is read. Only
  // those in `drawn` are drawn, by their places among `views`, the others being there already: the image outlives the
  // frame, and is then another than that of this size (plan/lamp_pool.h).
  bool apart = false, outlives = false;
  std::vector<uint32_t> drawn;
  // Of the views the last ones: they draw what moves over a copy of what stands, which is another view's, in the image
  // by then. So a frame in which little moves draws little.
  uint32_t over = 0;
  uint32_t first_over() const { return uint32_t(views.size()) - over; }
  bool in_parts = false;  // there may be such
  // Of the places that views are drawn in, where all of them are in one buffer.
  uint32_t texel_layers = 0;
  uint32_t most_px = 0;   // a view's side, at most
  uint64_t commands = 0;  // of all views, for which there is room
  uint32_t drawn_views() const { return uint32_t(apart ? drawn.size() : views.size()); }
  // Of how many views buffers are. In powers of two: views that come and go do not change the plan.
  uint32_t room() const {
    const uint32_t all = uint32_t(views.size());
    return apart ? std::bit_ceil(std::max(all, 1u)) : all;
  }
  void clear() {
    name.clear(), views.clear(), drawn.clear();
    size_px = layers = over = texel_layers = most_px = 0;
    apart = outlives = in_parts = false;
    commands = 0;
  }
};

// What culling, compaction and depth drawing work on: consecutive views of the frame's table (shaders/shared/cull.h),
// or the camera alone, whose planes and matrix are in the frame's constants. Not a pass.
struct ViewRange {
  using MadeBy = std::tuple<SunKnobs, LampKnobs, LightRangeKnobs>;
  BufferHandle table, regions;  // empty: the camera
  uint32_t first = 0, count = 1;
  std::shared_ptr<const ViewImage> image;  // then as many as are drawn of its views, and `count` means nothing
  // As uploaded in `regions`: the first command of each view and run, run by run within a view, and the end of all.
  // Where a region is empty the view does not draw the run. Null: the camera, with room for every item.
  std::shared_ptr<const std::vector<uint32_t>> first_command;
  uint64_t commands = 0;  // of how many draw commands the buffers are, where that is more
  BufferHandle moving;    // CullPush::moving; empty: all views draw alike
  uint32_t drawn() const { return image ? image->drawn_views() : count; }  // for recording alone
  uint32_t room() const { return image ? image->room() : count; }
  bool is_camera() const { return first_command == nullptr; }
};

inline ImageDesc image_desc(const ViewImage& image, VkFormat format) {
  ImageDesc desc{image.name, format, image.size_px, image.size_px};
  desc.kind = ImageKind::d2_array;
  desc.layers = image.layers;
  return desc;
}

// The commands that culling leaves for a range of views, and their counts.
struct Draws {
  using MadeBy = DrawnItemKnobs;
  BufferHandle commands, counts;
  std::shared_ptr<const std::vector<uint32_t>> first_command;  // of the range
};

}  // namespace candela
