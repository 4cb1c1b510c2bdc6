#pragma once
#include "passes/shared/blended.h"

namespace candela {

// Blended surfaces and those that let light through in one draw, in any order, by what they look like (McGuire and
// Mara, "A Phenomenological Scattering Model for Order-Independent Transparency", 2016, and "Phenomenological
// Transparency", 2017): each tints what is behind, channel by channel, moves it as its refraction does, and widens it
// by its roughness and by how far what is seen lies behind it. All four are products and sums, so several surfaces of
// a pixel need no order; only how much each one's own light counts is guessed, by its depth. A last step takes the
// picture of what is opaque where the sums say, by taps that count as far as the width at their own depth reaches, so
// that what touches frosted glass stays sharp and does not bleed.
//
// Unlike the papers: widths and ways are those of the file's roughness, index and body in metres, not of constants,
// and sums hold them as polynomials of the depth behind, which the last step knows; light crosses bodies between their
// faces (Wyman, "An Approximate Image-Space Approach for Interactive Refraction", 2005). Drawn by runs and lit as
// others are. Blended surfaces that lie behind glass are first drawn alone, into the picture that it moves and blurs.
// 32-bit sums in the order of drawing, which one device keeps.
//
// Exact for one blended surface, and for how clear sheets and blended surfaces tint what is behind. Leaves wrong: whose
// own light lies before whose, as `weighted` does; blended surfaces between two of glass, which the farther one blurs
// too; what the picture of opaque surfaces does not hold; total reflection, and what is reflected within bodies; the
// far sides of bodies behind other bodies (slabs of the file's thickness). What they leave of lights:
// colored_shadows.h.
struct Phenomenological {
  static constexpr std::string_view name = "phenomenological", method = method_with_glass;
  struct Knobs {
    static constexpr std::string_view name = "phenomenological";
    int taps = 16, search = 4, backs = 3, falloff = 4;
    static std::span<const Knob> table();
  };
  using SharedKnobs = BlendedKnobs;
  using InputKnobs = DrawnItemKnobs;
  struct In {
    BlendedIn blended;    // glass: where there is some, the depth of what lets light through and of what is opaque
    ImageHandle picture;  // what is behind, of one sample; only where something lets light through
  };
  struct Out {
    ImageHandle color;  // an image of its own: what is behind is read
    struct {
      ImageHandle light, absorbed;  // the surfaces' own; what they take of what is behind, by colour
      ImageHandle widths, moved;    // of lib/glass_sums.glsl; empty where nothing lets light through
    } sums;
    struct {
      ImageHandle faces, z;  // of bodies: what looks away
      ImageHandle pyramid;   // of what is behind them
    } backs;
    BatchPipelines back_faces, drawn;
    struct {
      PipelineHandle down, over;
    } pipelines;
  };
  // For the picture behind glass: blended surfaces alone, without those that lie before some.
  bool behind = false;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
