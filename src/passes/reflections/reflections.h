#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"
#include "passes/reflections/reflected.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// What opaque and masked surfaces reflect of each other, as far as the picture shows it: of directions that the GGX
// lobe takes, those that meet a surface on the picture, with the light that it sends to the camera. Rays through the
// depth of the pixels' middles (McGuire and Mara, "Efficient GPU Screen-Space Ray Tracing", 2014) in directions that
// are sampled by the normals that the viewer sees (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018);
// each takes the picture's mean over its share of the lobe from a pyramid (Krivanek and Colbert, "Real-time Shading
// with Filtered Importance Sampling", 2008). The sum over the samples' own weights times the lobe's tabulated
// reflectance is the light, so that even light gives what an even sky gives (Stachowiak, "Stochastic Screen-Space
// Reflections", 2015).
//
// Steps: the surfaces at the pixels' middles, drawn again; the picture's pyramid, of surfaces alone; rays.
// Picture: linear, pre-exposed, resolved, with all that lies behind blended surfaces. Its fog's own light is taken from
// it and what fog takes on the way to the camera is given back; then the ray's way through fog takes its own. So the
// model is: the light of surfaces through fog, and no light of fog itself, as for the sky's reflections.
//
// Leaves wrong: what the picture does not hold - other sides, what is hidden, what is outside - stays the sky; gloss of
// what is reflected is that towards the camera; depths are of single samples, so that edges of reflections are not
// multisampled; blended surfaces neither reflect nor are reflected. One reflection alone.
struct Reflections {
  static constexpr std::string_view name = "reflections";
  static constexpr std::string_view effect = "ssr";
  struct Knobs {
    static constexpr std::string_view name = "reflections";
    int samples = 4;
    int steps = 64;
    int smooth = 1;
    int texel_px = 1;
    float thickness = 0.02f;
    float fade = 0.05f;
    float roughest = 0.7f;
    static std::span<const Knob<Knobs>> table();
  };
  using SharedKnobs = std::tuple<TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    CellLists lists;        // fog and ambient occlusion, where there are any
    ImageHandle picture;    // of one sample
    bool has_sky = false;   // the frame's harmonics are those of a sky
    uint32_t seed = 0;
    uint32_t subsample = 0, subsamples = 1;  // of a supersampled frame: which of its samples
  };
  struct Out {
    Reflected reflected;
    ImageHandle fog, colors;
    ImageHandle noisy;  // the light before it is smoothed; empty without
    RunPipelines drawn;
    struct {
      PipelineHandle color, down, trace, smooth;
    } pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  static uint32_t levels(const SceneInputs& scene);  // of the pyramid
  Knobs knobs;
};

// Adds them to the picture, in the place of what the surfaces had from the sky. Edges: a pixel's samples that are of
// the surface at its middle get the reflection of that middle, the others keep the sky.
struct ReflectionsOver {
  static constexpr std::string_view name = "reflections_over";
  static constexpr std::string_view effect = "ssr";
  struct In {
    SceneInputs scene;
    Reflected reflected;
    ImageHandle depth;  // of the frame
    ImageHandle color;
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
