#pragma once
#include "passes/shared/frame_values.h"
#include "passes/shared/pass.h"

namespace candela {

// Anti-aliasing after the fact, of a picture with one sample a pixel: morphological, as SMAA 1x without its diagonals
// (Jimenez, Echevarria, Sousa and Gutierrez, "SMAA: Enhanced Subpixel Morphological Antialiasing", 2012), with the
// areas by their formula in the place of a table (Reshetov, "Morphological Antialiasing", 2009). Three steps: edges
// between pixels whose exposed luminance differs; for each edge its two ends and what crosses it there, which say where
// the line it stands for runs and which part of the pixels beside it that covers; the pixels mixed by these parts.
// Or, in one step that reads less and leaves more, by contrast (Lottes, "FXAA", 2009): at a pixel that differs from its
// neighbours the direction of the edge is told by them, its ends are looked for by the mean of both sides, the pixel
// takes in what lies across the edge by where it is between the ends, and what stands alone is mixed with what is round
// it. Linear radiance in and out, alpha with it. Leaves wrong: what one sample a pixel missed (thin things, shading,
// edges within a pixel) it cannot know.
struct SmoothEdges {
  static constexpr std::string_view name = "smooth_edges";
  struct Knobs {
    static constexpr std::string_view name = "smooth_edges";
    enum Method { shape, contrast };
    int method = shape, reach_px = 0;
    float threshold = 0.1f;
    static std::span<const Knob> table();
  };
  struct In {
    ImageHandle color;
    uint32_t width_px = 0, height_px = 0;
    Live<float> exposure = 1;  // of the color, as it is shown
  };
  struct Out {
    ImageHandle edges, parts, color;
    std::array<PipelineHandle, 3> pipelines;
  };
  bool ignores(std::string_view knob) const { return knob != "reach_px" && knobs.reach_px == 0; }
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
