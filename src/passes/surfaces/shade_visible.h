#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/sample_store.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// Radiance of the surfaces that a visibility buffer names (passes/geometry/rasterize.h), in compute, by the same
// functions as ShadeForward and ShadeUnlit: each triangle of a pixel once, at the middle of its samples there, with
// attributes and their slopes by the camera's ray and its differential, and sky or background where there is none.
// Units: cd/m2 times the pre-exposure. whole: nothing is drawn over it: the pixel's mean of samples.
// Otherwise a colour for each sample.
struct ShadeVisible {
  static constexpr std::string_view name = "shade_visible";
  using SharedKnobs =
      std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs, SampleStoreKnobs, ReliefKnobs>;
  static constexpr std::array<std::string_view, 2> shading_effects = {"ibl", "probes"};
  struct In {
    SceneInputs scene;
    BufferHandle keys;
    BufferHandle deformed;  // optional
    Lighting lists;         // empty: every light for every pixel
    bool whole = false, draws_sky = false;
  };
  struct Out {
    ImageHandle color;    // whole: one sample
    SampleStore samples;  // else
    PipelineHandle pipeline;
    PipelineHandle rest;  // of pixels whose rays' records found no room
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
