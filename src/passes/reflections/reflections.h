#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/shared/reflected.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/screen_or_rays.h"

namespace candela {

struct ReflectionKnobs : ScreenOrRays {
  static constexpr std::string_view name = "reflections";
  int method = screen;
  int samples = 4;
  int steps = 64;
  int smooth = 1;
  int texel_px = 1;
  float thickness = 0.02f;
  float fade = 0.05f;
  float roughest = 0.7f;
  static std::span<const Knob> table();
};

// What opaque and masked surfaces reflect of each other, as far as the picture shows it: of directions that the GGX
// lobe takes, those that meet a surface on the picture, with the light that it sends to the camera. Rays through the
// depth of the pixels' middles (McGuire and Mara, "Efficient GPU Screen-Space Ray Tracing", 2014) in directions that
// are sampled by the normals that the viewer sees (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018);
// each takes the picture's mean over its fraction of the lobe from a pyramid (Krivanek and Colbert, "Real-time Shading
// with Filtered Importance Sampling", 2008). The sum over the samples' own weights times the lobe's tabulated
// reflectance is the light, so that even light gives what an even sky gives (Stachowiak, "Stochastic Screen-Space
// Reflections", 2015).
//
// With method traced the rays go through the scene's triangles (shaders/lib/trace.glsl), and what they meet is shaded
// by the functions of all techniques: every lamp with its shadow by a ray, the sky with occlusion by rays, textures as
// coarse as the sample's fraction of the lobe is there (Igehy, "Tracing Ray Differentials", 1999).
//
// Steps: the surfaces at the pixels' middles, from keys in compute, or drawn again; the picture's pyramid, of surfaces
// alone; rays.
// Picture: linear, pre-exposed, resolved, with all that lies behind blended surfaces. Its fog's own light is taken from
// it and what fog takes on the way to the camera is given back; then the ray's way through fog takes its own. So the
// model is: the light of surfaces through fog, and no light of fog itself, as for the sky's reflections.
//
// Leaves wrong: what the picture does not hold - other sides, what is hidden, what is outside - stays the sky, and
// gloss of what is reflected is that towards the camera; traced, neither is. Depths are of single samples, so that
// edges of reflections are not multisampled; blended surfaces neither reflect nor are reflected. One reflection alone.
struct Reflections {
  static constexpr std::string_view name = "reflections";
  static constexpr std::string_view effect = "reflections";
  using Knobs = ReflectionKnobs;
  using SharedKnobs = std::tuple<TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs, LightRangeKnobs, ReliefKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    Lighting lists;         // fog and ambient occlusion, where there are any
    Lighting met;           // what surfaces that rays meet are lit by; only where the scene is traced
    ImageHandle picture;    // of one sample; only where it is not
    BufferHandle keys;      // of a visibility buffer, at the pixels' middles: surfaces are found in compute; optional
    bool has_sky = false;   // the frame's harmonics are those of a sky
    uint32_t seed = 0;
  };
  struct Out {
    Reflected reflected;
    ImageHandle fog, colors;
    ImageHandle noisy;  // the light before it is smoothed; empty without
    BatchPipelines drawn;
    struct {
      PipelineHandle surface, color, down, trace, smooth;
    } pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  // Whether rays go through the scene itself.
  bool traced(const SceneFacts& facts, const FrameRequest& request) const {
    return knobs.method == Knobs::by_rays && needed(facts, request);
  }
  bool ignores(std::string_view knob) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  static uint32_t levels(const SceneInputs& scene);  // of the pyramid
  Knobs knobs;

 private:
  void declare_drawn(GraphBuilder& builder, const In& in, Out& out) const;
  void declare_keyed(GraphBuilder& builder, const In& in, Out& out) const;
  void record_surfaces(CommandList& commands, const In& in, const Out& out) const;
  void declare_march(GraphBuilder& builder, const In& in, Out& out) const;
  void declare_rays(GraphBuilder& builder, const In& in, Out& out) const;
  void record_march(CommandList& commands, const In& in, const Out& out) const;
  void record_rays(CommandList& commands, const In& in, const Out& out) const;
};

// Adds them to the picture, in the place of what the surfaces had from the sky. Edges: a pixel's samples that are of
// the surface at its middle get the reflection of that middle, the others keep the sky. Where nothing is drawn over the
// picture it has one sample a pixel already, the mean of them, and gets as much, in compute.
struct ReflectionsOver {
  static constexpr std::string_view name = "reflections_over";
  static constexpr std::string_view effect = "reflections";
  using InputKnobs = SampleCountKnobs;
  struct In {
    SceneInputs scene;
    Reflected reflected;
    SampledDepth depth;  // of the frame, at its samples; an image unless the picture is whole
    ImageHandle color;
    bool whole = false;
  };
  struct Out {
    ImageHandle color;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const {
    return Reflections{}.needed(facts, request);
  }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
