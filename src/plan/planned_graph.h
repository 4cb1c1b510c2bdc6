#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plan/frame_dumps.h"
#include "plan/frame_shape.h"

namespace candela {

// A frame's graph, and what was found when it was made. Frames of the same shape share it: they fill in what recording
// reads, and nothing else changes.
struct PlannedGraph {
  FrameShape shape;
  // What recording reads; the graph's functions and SceneInputs point here.
  FrameValues values;
  std::vector<uint32_t> sun_first_command, lamp_first_command;
  ViewImage sun_image, lamp_image;

  CompiledGraph graph;
  // Of the plan without dumps, and as if nothing were kept from other frames: what is the same picture has the same.
  Hash128 hash;
  std::vector<int> imports;  // resource in the plan of each row of the upload table; -1: not in it
  std::vector<FrameReport> reports;
  std::vector<FrameOutput> outputs;
  int counts = -1;  // the buffer of shared::PackCounts in the plan
  std::vector<FrameDump> dumps;
};

// Graphs of the last frames, those used last. A picture of several frames has those of these and of their mean, and
// lamps that come on and go take shapes in turn.
class KeptGraphs {
 public:
  std::shared_ptr<PlannedGraph> find(const FrameShape& shape);  // null: none has it
  void add(std::shared_ptr<PlannedGraph> graph);
  FrameShape& shape() { return shape_; }  // to fill in and ask with
  uint64_t made() const { return made_; }

 private:
  static constexpr size_t most = 8;
  std::vector<std::shared_ptr<PlannedGraph>> graphs_;  // the one used last first
  FrameShape shape_;
  uint64_t made_ = 0;
};

}  // namespace candela
