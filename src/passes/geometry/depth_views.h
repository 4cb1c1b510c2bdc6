#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// How many rounds the views of an image take that are drawn apart, size by size: as the graph has them. In powers of
// two: views that come and go do not change the plan.
struct ViewRounds {
  uint32_t size_px = 0, rounds = 0;
  bool over = false;  // of views that are drawn over others
  bool operator==(const ViewRounds&) const = default;
};
void view_rounds(const ViewImage& image, std::vector<ViewRounds>& rounds);

// Depth of what casts shadows, as a range of views sees it: each view draws into its layer and viewport of one layered
// image, in 32-bit float, reversed as the view's matrix says. Views of one layer follow each other. Surfaces count from
// both sides, as they do for a ray of light; what lies before the near plane of a parallel view is flattened onto it.
// Masked surfaces drop what their mask cuts away at the texel's centre. Leaves wrong: blended surfaces, lines and
// points cast no shadow.
struct DepthViews {
  static constexpr std::string_view name = "depth_views", effect = "shadows";
  using SharedKnobs = std::tuple<SunKnobs, LampKnobs, ReliefKnobs>;
  using InputKnobs = std::tuple<LightRangeKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    std::shared_ptr<const ViewImage> image;
  };
  // Of views that are drawn apart: those of a size, as many at once as there are layers to draw them into, from where
  // they are copied to their tiles. Those that are drawn over others begin as copies of these (`under`).
  struct Round {
    uint32_t size_px = 0, number = 0, most = 0;  // which round of these views, and how many it may draw
    ImageHandle layers, depth;
    ImageHandle under, loaded;  // empty: they begin with nothing
  };
  enum class RoundStep { load, draw, store };
  struct Out {
    ImageHandle depth;
    BatchPipelines pipelines;
    std::vector<Round> rounds;
    std::vector<std::pair<uint32_t, RoundStep>> steps;  // after the first one: of which round, and what
    ImageHandle cleared;                                // of views that are drawn apart: what is between their tiles
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
