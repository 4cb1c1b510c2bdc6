#pragma once
#include "passes/shared/draw_batches.h"

namespace candela {

// What surfaces that let light through look up (shaders/lib/refraction.glsl). Not a pass: Refraction makes it, and what
// shades them again takes it too.
struct SeenThrough {
  using MadeBy = std::tuple<RefractionKnobs>;
  ImageHandle picture;  // of one sample, without them
  ImageHandle pyramid;  // the same in the next lower powers of two, and its mips
  ImageHandle behind;   // depth of what is opaque, at the frame's samples; empty: nothing is
  uint32_t lobe_samples = 0;
  ImageHandle rays;    // what rays have found through smooth ones, at pixels' middles; empty: none were sent
  float roughest = 0;  // roughness from which the picture is looked up all the same
  // Of all faces of bodies before what is opaque (shaders/refraction_bodies.frag); empty: a body is a slab.
  ImageHandle sums, backs;
  uint32_t body_search = 0;
  explicit operator bool() const { return bool(pyramid); }
};

// The pyramid of a picture of one sample, level by level: as many steps, each recorded by record_level. The first is
// made of the picture.
uint32_t pyramid_levels(const SceneInputs& scene);
ImageHandle declare_pyramid(GraphBuilder& builder, const SceneInputs& scene, ImageHandle picture, std::string name);
void record_level(CommandList& commands, PipelineHandle down, ImageHandle picture, ImageHandle pyramid,
                  glm::uvec2 picture_px, uint32_t level);

// Declares what is read, and completes the shaders and constants of a choice that has lights and fog.
void declare_seen_through(GraphBuilder& builder, const SceneInputs& scene, const SeenThrough& seen,
                          BatchPipelineChoice& choice);
OwnInputs own_inputs(CommandList& commands, const SeenThrough& seen);

}  // namespace candela
