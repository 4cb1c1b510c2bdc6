#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/seen_through.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// Surfaces that let light through (KHR_materials_transmission, _volume, _ior, _dispersion), over the picture without
// them: its resolved light, at the size and as a pyramid of the next lower power of two, is looked up where light that
// leaves the surface came from, tinted by base colour, absorbed on its way through the body, and less what the
// interface reflects. The file's thickness stands for the body: light goes into a slab and leaves it as it came. Rough
// surfaces: knob `samples`. Everything else about them - lights, shadows, reflections of the sky, fog - is as opaque
// surfaces have it. Units: cd/m2 times the pre-exposure.
//
// Leaves wrong: of surfaces that let light through one behind another the nearest alone is seen; what a body bends by
// its far side's shape (a ball turns the picture round); what the picture does not hold, beyond its edges or behind
// other things; lamps' highlights through rough surfaces. They cast no shadows.
struct Refraction {
  static constexpr std::string_view name = "refraction";
  static constexpr std::string_view effect = "refraction";
  struct Knobs {
    static constexpr std::string_view name = "refraction";
    int samples = 0;
    static std::span<const Knob<Knobs>> table();
  };
  using SharedKnobs = std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    CellLists lists;        // empty: every light for every pixel
    ImageHandle depth;      // of these surfaces and of the opaque ones together
    ImageHandle behind;     // optional: depth of the opaque ones alone; nothing is opaque without it
    ImageHandle picture;    // of one sample, without these surfaces
    ImageHandle color;      // what they are drawn over, with the picture's light
  };
  struct Out {
    ImageHandle color;
    SeenThrough seen;
    RunPipelines pipelines;
    PipelineHandle down;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
