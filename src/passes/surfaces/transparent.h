#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// Blended surfaces, back to front by the depth of their bounds' centres (TECHNIQUES 12.1), premultiplied "over", tested
// against the opaque depth and not written to it. Leaves wrong: surfaces that intersect or contain each other, and the
// triangles of one section among themselves, blend in the wrong order.
struct Transparent {
  static constexpr std::string_view name = "transparent";
  using SharedKnobs = std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    CellLists lists;        // empty: every light for every pixel
    ImageHandle depth;      // optional: nothing opaque lies in front without it
    ImageHandle color;      // optional: without one the pass makes and clears it
  };
  struct Out {
    ImageHandle color;
    RunPipelines lit, unlit;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
