#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct MetaballKnobs {
  static constexpr std::string_view name = "metaballs";
  float cell = 1;
  static std::span<const Knob> table();
};

// Polygons of metaballs (src/scene/metaballs.h) by marching tetrahedra (Doi and Koide, "An Efficient Method of
// Triangulating Equi-Valued Surfaces by Using Tetrahedral Cells", 1991): triangles of each block are counted, summed
// and written to their places, without atomics. Lattice and blocks come from the host, which knows a bound of the
// triangles; how many there are stays on the device, in the items' counts of indices. Positions in metres of the
// lattice's space; they lie off the surface by the square of the cell times its curvature, and normals by the cell's
// square too.
struct MetaballPolygons {
  static constexpr std::string_view name = "metaballs";
  using Knobs = MetaballKnobs;
  struct In {
    SceneInputs scene;
  };
  struct Out {
    BufferHandle items;             // with their counts of indices
    BufferHandle vertices, before;  // of the frame's deformed vertices; before: where motion is asked for
    BufferHandle sums;
    PipelineHandle count, scan, emit;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
