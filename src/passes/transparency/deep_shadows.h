#pragma once
#include "passes/shared/blended.h"
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

struct DeepShadowKnobs {
  static constexpr std::string_view name = "deep_shadows";
  static constexpr int off = 0, quarter = 1, half = 2, full = 3;
  int scale = quarter, slices = 16;
  static std::span<const Knob> table();
};

// What see-through surfaces leave of a light's rays at each distance along them, for the views of its shadow maps: what
// lies among such surfaces, blended ones themselves and the air, is lit through those before it alone (Yuksel and
// Keyser, "Deep Opacity Maps", 2008; deep shadow maps: Lokovic and Veach 2000). One image of floats beside the maps,
// whose layers are, each as often as the maps have layers:
//
// - in r the reversed depth of the nearest surface that hides a part, in g the distance of the farthest, in b the
//   reversed depth of the nearest one that hides all (a cut-out's, a body of glass), in a two texels' width as a
//   distance, the least that the range between near and far is taken for;
// - in rgb the absorbance of all in the range;
// - then four slices a layer: of places of the range, denser near the light, the absorbance that lies there, shared
//   between two by a tent (shaders/lib/deep_shadows.glsl).
//
// Sums need no order. Distances are 1 less the reversed depth, or, of lights with a place, metres along the view's
// axis. A surface takes what it absorbs itself out of the slices that it lies between, so it does not darken itself.
// Exact at a texel for two surfaces, and for any number that lie on slices of their own. Read by blended and glass
// surfaces, fog and volumetric light; opaque ones lie behind all of it and take ColoredShadows. Leaves wrong: surfaces
// nearer to each other than a slice dim each other by halves, those nearer than two texels too; light that bodies bend.
struct DeepShadows {
  static constexpr std::string_view name = "deep_shadows";
  using Knobs = DeepShadowKnobs;
  using SharedKnobs = std::tuple<SunKnobs, LampKnobs, TextureKnobs>;
  using InputKnobs = std::tuple<IblKnobs, SurfaceKnobs, LightRangeKnobs, ColoredShadowKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;            // of the maps' views
    BufferHandle deformed;  // optional
    std::shared_ptr<const ViewImage> image;
    ImageHandle depth;  // the maps
  };
  struct Out {
    ImageHandle deep;
    BatchPipelines ranges, sums;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
