#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "passes/geometry/depth_views.h"
#include "plan/trace_frame.h"
#include "plan/upload_table.h"
#include "techniques/technique.h"

namespace candela {

struct PlannedFrame;

// Everything that the declarations of a frame's graph depend on, without what is read by recording alone (FrameValues,
// and what SceneInputs points to): frames of equal shape have the same graph. The graph is made from the shape, so what
// is not in it cannot matter.
struct FrameShape {
  // A view table as far as passes declare by it.
  struct Maps {
    std::string name;
    uint32_t size_px = 0, layers = 0, texel_layers = 0, most_px = 0, room = 0;
    bool apart = false, outlives = false, in_parts = false;
    uint64_t commands = 0;                     // of the views, and room for them
    std::vector<ViewRounds> rounds;            // of views that the hardware draws apart
    std::vector<glm::uvec2> sizes_and_layers;  // of each view that is not drawn apart
    std::vector<bool> regions;                 // of each view and run whether it draws anything; where that counts
    bool operator==(const Maps&) const = default;
  };
  enum class Kept : uint8_t { no, unknown, seen, filled };  // of an image that outlives frames (graph/kept.h)
  struct Row {
    std::string_view name;
    BufferHandle SceneInputs::*input = nullptr;
    uint64_t size_bytes = 0;
    bool to_fill = false;
    bool operator==(const Row&) const = default;
  };
  const Technique* technique = nullptr;
  KnobValues knobs;
  FrameRequest request;  // its numbers that recording reads are those of any frame
  SceneFacts facts;      // of lights, whether there are any
  SceneInputs scene;     // without handles, features and pointers
  std::vector<DrawBatch> batches;
  Maps suns, lamps;
  Kept suns_kept = Kept::no, lamps_kept = Kept::no;
  std::optional<PoolShape> pool;
  std::optional<PictureParts> parts;
  std::vector<Row> rows;
  bool operator==(const FrameShape&) const = default;
};

// Fills `shape` in, whatever it held; memory that it has is used again.
void take_shape(const AskedFrame& asked, const PlannedFrame& frame, const PlanContext& context,
                std::span<const UploadRow> rows, const std::optional<PictureParts>& parts, FrameShape& shape);

}  // namespace candela
