#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/shared/screen_or_rays.h"
#include "passes/shared/seen_through.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

struct RefractionKnobs : ScreenOrRays {
  static constexpr std::string_view name = "refraction";
  int method = screen;
  int samples = 0;
  int walls = 8;
  int backs = 3;
  float roughest = 0.1f;
  int full_size = 1;
  static std::span<const Knob> table();
};

// Surfaces that let light through (KHR_materials_transmission, _volume, _ior, _dispersion), over the picture without
// them: its resolved light, at the size and as a pyramid of the next lower power of two, is looked up where light that
// leaves the surface came from, tinted by base colour, absorbed on its way through the body, and less what the
// interface reflects. Light goes into a body, to the nearest back face behind it (knob `backs`) or through a slab of
// the file's thickness, and leaves it as it came; what further walls and bodies absorb counts too. Rough surfaces: knob
// `samples`. Everything else about them - lights, shadows, reflections of the sky, fog - is as opaque
// surfaces have it. Units: cd/m2 times the pre-exposure.
//
// With method traced a ray goes through each pixel whose surface is smooth: bent at all walls of bodies in its way,
// totally reflected, absorbed, to what it meets, which is shaded as reflected rays' hits are (refraction_rays.comp).
// One way is followed at each wall, that of most light behind it: what walls reflect inside by parts is missing.
//
// Leaves wrong, by screen: of surfaces that let light through one behind another the nearest alone is seen; what a body
// bends by its far side's shape (a ball turns the picture round); what the picture does not hold, beyond its edges or
// behind other things; lamps' highlights through rough surfaces. They cast no shadows.
struct Refraction {
  static constexpr std::string_view name = "refraction";
  static constexpr std::string_view effect = "refraction";
  using Knobs = RefractionKnobs;
  using SharedKnobs = std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs, ReliefKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    Lighting lists;         // empty: every light for every pixel
    Lighting met;           // what surfaces that rays meet are lit by; only where they are sent
    bool shows_sky = false;
    bool bodies = false;  // some surface bounds a body
    ImageHandle depth;    // of these surfaces and of the opaque ones together
    ImageHandle behind;   // optional: depth of the opaque ones alone; nothing is opaque without it
    ImageHandle picture;  // of one sample, without these surfaces
    ImageHandle color;    // what they are drawn over, with the picture's light
  };
  struct Out {
    ImageHandle color;
    SeenThrough seen;
    BatchPipelines pipelines;
    PipelineHandle down, rays;
    BatchPipelines sums, nearest;  // of bodies
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  // Whether rays go through the scene itself.
  bool traced(const SceneFacts& facts, const FrameRequest& request) const {
    return knobs.method == Knobs::by_rays && needed(facts, request);
  }
  bool ignores(std::string_view knob) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;

 private:
  void declare_rays(GraphBuilder& builder, const In& in, Out& out) const;
  void declare_bodies(GraphBuilder& builder, const In& in, Out& out) const;
  void record_bodies(CommandList& commands, const In& in, const Out& out) const;
  void record_rays(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
