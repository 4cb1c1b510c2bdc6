#pragma once
#include "passes/shared/blended.h"
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

struct ColoredShadowKnobs {
  static constexpr std::string_view name = "colored_shadows";
  static constexpr int off = 0, half = 1, full = 2;
  int scale = half, steps = 3;
  static std::span<const Knob> table();
};

// What see-through surfaces leave of a light's rays, channel by channel, for the views of its shadow maps (McGuire and
// Mara 2016, 2017): one layered image of 16-bit floats (of 32 bits at full scale) beside the maps.
//
// - Layer l: in rgb what all blended surfaces and sheets that lie before the nearest opaque surface take together, 1
//   minus the product of what each lets through, so they need no order; in alpha whether a body of glass is in the way,
//   whose light goes elsewhere.
// - Layers from the maps' number on, where there are bodies: the light that they send there instead, over what the
//   place would have without them. A body's own triangles are drawn where their corners' light lands: bent by its
//   front, through it to the nearest back face (Wyman, "An Approximate Image-Space Approach for Interactive
//   Refraction", 2005), bent again, and on to the depth of the maps. A triangle that shrinks is brighter by as much as
//   its area is smaller (Shah, Konttinen, Pattanaik, "Caustics Mapping: An Image-Space Technique for Real-Time
//   Caustics", 2007).
//
// What is opaque and lies before a surface darkens it as it does everything. Read by opaque and masked surfaces.
// Leaves wrong: roughness, which would widen a sheet's shadow and a body's light; light that several bodies bend one
// after the other, or by total reflection; light bent out of its view; dispersion; between corners light lands on a
// plane; see-through surfaces and fog take light without colour; halves, below
// full scale, stop counting where a surface takes less than 2^-11 of the light.
struct ColoredShadows {
  static constexpr std::string_view name = "colored_shadows";
  using Knobs = ColoredShadowKnobs;
  using SharedKnobs = std::tuple<SunKnobs, LampKnobs, TextureKnobs>;
  using InputKnobs = std::tuple<IblKnobs, SurfaceKnobs, LightRangeKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;            // of the maps' views
    BufferHandle deformed;  // optional
    std::shared_ptr<const ViewImage> image;
    ImageHandle depth;    // the maps
    bool bodies = false;  // some surface bends light
  };
  struct Bent {  // a layer in which there are bodies
    uint32_t layer;
    ImageHandle positions, normals, z;  // of back faces
  };
  struct Out {
    ImageHandle colors;
    std::vector<Bent> bent;
    BatchPipelines straight, back_faces, bodies;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool bends(const In& in) const { return in.bodies && knobs.steps > 0; }
  Knobs knobs;
};

}  // namespace candela
