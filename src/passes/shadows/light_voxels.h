#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct LightVoxelKnobs {
  static constexpr std::string_view name = "voxels";
  static constexpr int halve = 0, by_rays = 1;
  int size_px = 8;
  int points = 4;
  int edges = by_rays;
  int budget_mb = 64;
  static std::span<const Knob> table();
};

// Whether lights are seen, for cells of the view instead of for each point: the visibility cache that the thesis of
// T. Le ("TLVulkanRenderer", 2016) wishes for. A cell is what lies in a square of pixels, in a slice of depth about
// four times as thick as the square is wide, and faces one of six ways. Rays go to its lights from those of its seen
// points that lie outermost in several directions. Where all of them see a light, or none does, so do the points that
// are shaded; where they differ, or none of them is reached by the light, each point sends its own ray. As all points
// are on surfaces, none is inside of a solid or hovers before a contact shadow, as corners of a grid in space do.
// Leaves wrong: shadows and gaps that lie between a cell's points without meeting one.
struct FillLightVoxels {
  static constexpr std::string_view name = "light_voxels";
  using Knobs = LightVoxelKnobs;
  struct In {
    SceneInputs scene;
    Lighting lists;
    SampledDepth depth;
  };
  struct Out {
    LightVoxels voxels;
    BufferHandle points, groups;
    BufferHandle report;  // empty where all cells have room
    PipelineHandle find, number, fill;
  };
  struct Report {
    uint32_t cells, without;  // all, and those that have no room
  };
  std::vector<std::string> warnings(const Report&) const { return {}; }
  std::vector<std::string> notes(const Report& report) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool wanted = false;  // some light's shadows are by cells
  Knobs knobs;
};

}  // namespace candela
