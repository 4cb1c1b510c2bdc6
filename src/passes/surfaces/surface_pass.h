#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/relief_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// Radiance of the opaque and masked surfaces that won the depth pre-pass (EQUAL test), each fragment once. Units: cd/m2
// times the pre-exposure.
//   shade_forward (lit): glTF 2.0 metallic-roughness under every punctual light that reaches the point (each pixel
//   walks its cell's list, or all lights, in light order), plus ambient light and emission. Ambient light of a
//   sky image is its filtered reflection and irradiance (effect ibl), else spherical harmonics, whose reflections are
//   as blurred as diffuse light. Light that bounces on between a rough surface's own facets is kept by a factor on its
//   specular lobe. Leaves wrong: shadows of other lights than those with maps. shade_unlit: KHR_materials_unlit, and
//   lines and points without normals: base colour goes out as radiance.
template <bool lit>
struct SurfacePass {
  static constexpr std::string_view name = lit ? "shade_forward" : "shade_unlit";
  using SharedKnobs =
      std::conditional_t<lit,
                         std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs, ReliefKnobs>,
                         std::tuple<TextureKnobs, ReliefKnobs>>;
  static constexpr std::array<std::string_view, 2> shading_effects = {"ibl", "probes"};  // image-based light
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;     // optional
    Lighting lists;            // empty: every light for every pixel. Unlit: its fog alone
    ImageHandle depth;         // of the pre-pass
    ImageHandle color;         // optional: without one the pass makes it
    bool lines_alone = false;  // and points: triangles are in the colour
  };
  struct Out {
    ImageHandle color;
    BatchPipelines pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};
using ShadeForward = SurfacePass<true>;
using ShadeUnlit = SurfacePass<false>;

}  // namespace candela
