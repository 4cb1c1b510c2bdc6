#pragma once
#include <vector>

#include "passes/shared/pass.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct OcclusionKnobs {
  static constexpr std::string_view name = "occlusion";
  // What the depth buffer shows; rays where surfaces are shaded; rays from texels, which are filtered; and the last or
  // the first of these, by the scene (job/choose_occlusion.h): a frame's knobs never hold it.
  enum : int { screen, at_surfaces, by_rays, automatic };
  int method = automatic;
  bool sends_rays() const { return method != screen; }
  int rays = 1, most_rays = 8;
  int texel_px = 2;
  int slices = 3;
  int samples = 6;
  int denoise = 1;
  int filter = 2;
  float reach = 0.25f;
  int bent = 0;
  static std::span<const Knob> table();
};

// How open each visible surface is to the sky, as far as what the depth buffer holds tells: V = 1/pi of the integral of
// the cosine over the hemisphere about the triangle's normal, where a direction that meets a surface at distance t
// counts 1 - saturate((radius - t) / (falloff radius)) (look/look.h, Occlusion). Jimenez, Wu, Pesce, Jarabo,
// "Practical Real-Time Strategies for Accurate Indirect Occlusion", 2016: the hemisphere is cut into slices about the
// view vector, and in each, horizons are searched to both sides over the depth and the cosine is integrated between
// them in closed form. Other than there each rise of a horizon is weighed by the distance of what made it (Bavoil,
// Sainz, Dimitrov, "Image-space horizon-based ambient occlusion", 2008), so that the falloff is the traced term's own;
// and the sum is divided by that of the free slices, so that where nothing rises V is 1 for any number of slices and
// any slope.
//
// Three steps. Points: of each pixel one depth sample, never an average. Integral, at one pixel of each texel, over the
// points of all pixels: the normal from the depths beside it, on the side whose surface goes on; horizons with a
// pattern of 4 by 4 offsets. Denoise: the mean over the pattern, of texels near the tangent plane. The texels are
// brought to the fragments where these are shaded (shaders/lib/occlusion.glsl).
//
// By rays (method rays) each texel's point sends a few through all there is, and rounds of a filter take the mean over
// texels of the same surface; where there are few of these, each sends more. Where surfaces are shaded (method traced)
// each fragment sends its own.
//
// Leaves wrong on screen: what the depth buffer does not hold. Surfaces behind others and beyond the picture's edge
// hide nothing (a border as wide as the radius is too bright, never dark), and what is seen is taken to be as thick as
// the radius.
struct AmbientOcclusion {
  static constexpr std::string_view name = "occlusion";
  static constexpr std::string_view effect = "occlusion";
  static constexpr Queue queue = Queue::compute;
  using Knobs = OcclusionKnobs;
  using InputKnobs = std::tuple<BvhKnobs, IblKnobs>;  // of rays: the trees, and how bright the sky is
  struct In {
    SceneInputs scene;
    SampledDepth depth;
    Live<Occlusion> look;
    uint32_t seed = 0;
    // Of a supersampled frame: the samples share the slices out, and turn theirs so that all are even.
    uint32_t subsamples() const { return scene.subsamples; }
  };
  struct Out {
    ImageHandle open;             // V, and the point that it is of (shaders/lib/occlusion_points.glsl)
    ImageHandle points, normals;  // on the way; normals for the denoising alone
    PipelineHandle find, integrate;
    std::vector<PipelineHandle> smooth;  // of each round
    std::vector<ImageHandle> rounds;     // what each round of the filter reads; empty without
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  // Whether what it gives is for shading, and not for a layer alone.
  static Need shades(const SceneFacts& facts, const FrameRequest& request);
  // Whether shading sends rays instead.
  bool traced(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  // Of the texels of a frame, as shaders want it.
  uint32_t shape(const SceneInputs& scene) const;
  glm::uvec2 texels(const SceneInputs& scene) const;
  Knobs knobs;
};

}  // namespace candela
