#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/surfaces/gbuffer_images.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

struct GBufferKnobs {
  static constexpr std::string_view name = "gbuffer";
  enum : int { specular, bits128, position, packed, floats };
  int format = floats;
  static std::span<const Knob> table();
};

// The nearest opaque and masked surfaces as shading takes them, at every sample: deferred shading (Saito and Takahashi,
// "Comprehensible Rendering of 3-D Shapes", 1990). Textures, normal maps and what derivatives give are evaluated here,
// once a fragment; so its samples hold the same bits. Positions are relative to the camera, in metres; emission in
// cd/m2.
//
// Knob `gbuffer.format`, of a sample and without lobes:
//   float: 80 bytes, 112 where shadows or occlusion take the triangle's plane, 128 where smooth surfaces mirror a sky
//     image: every value as the forward techniques shade it;
//   packed: 32 bytes: normals 2x16 octahedral, albedo sRGB8, roughness, metallic and others 8 bits, emission half
//   floats,
//     positions from the depth along the view axis and the place in the pixel;
//   position: 32 bytes: positions as floats, normals 3x10 coordinates, emission 3x9 with a common exponent, the rest as
//     in packed; the triangle's plane is the shading normal's;
//   bits128: 16 bytes: normals 2x11 octahedral, roughness 6 bits, metallic and occlusion 4, reflectance without colour,
//     emission 3x7 with a common exponent; the triangle's plane is the shading normal's;
//   specular: 16 bytes: normals 2x12 octahedral, diffuse and specular reflectance sRGB8, a Phong exponent of 16 bits,
//     depth 24 bits; metals and dielectrics are one, and surfaces that emit and take light emit nothing; the triangle's
//     plane is the shading normal's.
// Reliefs whose light is looked for within them have their triangle in 16 bytes more. Lobes are 80 bytes more in each,
// as floats, where visible materials have some, 96 where bodies scatter light. Leaves wrong: in packed formats albedo,
// f0 and occlusion above 1 are 1. Measured errors: docs/understanding/techniques.md.
struct GBuffer {
  static constexpr std::string_view name = "gbuffer";
  using Knobs = GBufferKnobs;
  using SharedKnobs = std::tuple<TextureKnobs, SurfaceKnobs, ReliefKnobs>;
  using InputKnobs = std::tuple<IblKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    Lighting lists;         // of those that shade: whether they take the triangle's plane
    ImageHandle depth;      // of the pre-pass
  };
  struct Out {
    GBufferImages gbuffer;
    BatchPipelines own, reliefs, lobes;
    uint32_t own_images = 0;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
