#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"

namespace candela {

// How light in fog is resolved: the knobs `fog.*`.
struct FogKnobs {
  static constexpr std::string_view name = "fog";
  int grid = 3;             // into fog_grids, or the march
  int last = 0;             // the slice in which a surface stands is followed for itself
  int steps = 128;          // of a march
  int lamp_shadows = 1;     // points of a slice at which a lamp's maps are asked
  int sky_directions = 16;  // of the transmittance before the sky
  static std::span<const Knob<FogKnobs>> table();
  bool marches() const;
  glm::uvec3 nodes(uint32_t width_px, uint32_t height_px) const;
};

// Light that fog scatters once towards the camera, in a grid of rays and depths (Wronski, "Volumetric Fog: Unified
// Compute Shader-Based Solution to Atmospheric Scattering", 2014; Hillaire, "Physically Based and Unified Volumetric
// Rendering in Frostbite", 2015): each slice's light from every lamp of the lists, the suns and the sky, then the sum
// front to back, kept at each slice's end. Surfaces, sky and background look it up at their own depth. Depths grow
// exponentially; rays reach from edge to edge of the picture. Units: radiance as in beauty, pre-exposed.
// The slice in which a surface stands may be summed by the surface itself (fog.last) instead of interpolated: a lamp
// may stand behind it in the same slice, on a wall or a car.
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
    CellLists lists;
    bool ambient = false;
  };
  struct Out {
    ImageHandle light;
    PipelineHandle scatter, sum;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
