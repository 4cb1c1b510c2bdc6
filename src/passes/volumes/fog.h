#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/volumes/fog_knobs.h"

namespace candela {

// Light that fog scatters once towards the camera, in a grid of rays and depths (Wronski, "Volumetric Fog: Unified
// Compute Shader-Based Solution to Atmospheric Scattering", 2014; Hillaire, "Physically Based and Unified Volumetric
// Rendering in Frostbite", 2015): each slice's light from every lamp of the lists, the suns and the sky, then the sum
// front to back, kept at each slice's end. Surfaces, sky and background look it up at their own depth. Depths grow
// exponentially; rays reach from edge to edge of the picture. Units: radiance as in beauty, pre-exposed.
// The slice in which a surface stands is summed by the surface itself (fog.last) and not interpolated where lamps give
// much of its light: one may stand behind it in the same slice, on a wall or a car.
//
// Transmittance is no part of the grid: it has a closed form (shaders/lib/fog_medium.glsl). Leaves wrong: what lies
// between rays is interpolated, so that a lamp's glow is as wide as they lie apart; in a slice the cone of a spot, the
// phase and a lamp's own fog are taken at one point; shadows are those of maps, asked at few points
// of a slice, and lamps without maps cast none; light scattered more than once is lost.
struct FogGrid {
  static constexpr std::string_view name = "fog";
  static constexpr std::string_view effect = "fog";
  using Knobs = FogKnobs;
  using SharedKnobs = std::tuple<LightRangeKnobs>;
  struct In {
    SceneInputs scene;
    Lighting lists;
    bool ambient = false;
    int media = 0;  // FogView::media
  };
  struct Out {
    ImageHandle light;
    PipelineHandle scatter, sum;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool ignores(std::string_view knob) const { return knob == "sun_points" && !has_suns; }
  Knobs knobs;
  bool has_suns = true;  // with shadow maps
};

}  // namespace candela
