#pragma once
#include "passes/shared/blended.h"
#include "shared/transparency.h"

namespace candela {

// Blended surfaces exactly: every one of them in a pixel is stored, sorted by depth, and composited back to front
// (the A-buffer of Carpenter, "The A-buffer, an Antialiased Hidden Surface Method", 1984, in the memory of prefix sums
// as Vasilakis and Fudos, "S-buffer: Sparsity-aware Multi-fragment Rendering", 2012). Equal depths are in the order of
// drawing: item, then triangle. A sample takes the surfaces that cover it, in the order of their depths there; each is
// shaded once a pixel, as `sorted` does it. Equal to `sorted` bit for bit where its order is right, on a device whose
// blending multiplies and adds as the shader does.
//
// Steps: fragments are counted, the counts summed to places (exclusive prefix sums), and then, in rounds that each have
// room for as many as half the memory, stored, sorted and blended; a 2x2 quad of pixels, which fractions derivatives,
// is of one round. Where the rounds do not hold all, or half the memory not a quad, the frame is refused: the report
// says how many there are, and with --transparency auto the frame is drawn again with as many rounds as it needs. Needs
// geometryShader (for gl_PrimitiveID), and VK_EXT_post_depth_coverage where multisampled.
struct Fragments {
  static constexpr std::string_view name = "fragments", method = "layers";
  struct Knobs {
    static constexpr std::string_view name = "fragments";
    int memory_mib = 256;
    int rounds = 16;
    static std::span<const Knob> table();
  };
  using SharedKnobs = BlendedKnobs;
  using In = BlendedIn;
  struct Out {
    ImageHandle color;
    ImageHandle depth;  // of the opaque surfaces, or empty space
    struct {
      BufferHandle cells, stored, order;  // shared/transparency.h
      BufferHandle blended;               // colours of samples
      BufferHandle rounds;                // groups of threads a round; counts of draws a round
    } buffers;
    BufferHandle report;
    BatchPipelines counted, drawn;
    struct {
      PipelineHandle sum, scan, rounds, blend, over;
    } pipelines;
  };
  using Report = shared::FragmentsReport;
  std::vector<std::string> warnings(const Report&) const { return {}; }
  std::vector<std::string> notes(const Report& report) const;
  std::string refusal(const Report& report) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  // Knobs with which a frame that was refused is drawn; empty: none do.
  std::vector<KnobSetting> enlarged(const Report& report) const;
  uint64_t room() const;  // fragments of a round
  static Knobs most();    // the largest memory and the most rounds
  // Memory of a picture whose 2x2 pixels hold up to so many fragments.
  static uint64_t memory_bytes(uint64_t fragments_of_a_quad, uint64_t pixels, int samples);
  // Shader and definitions of a part of beauty (terms.frag, fog_layers.frag), which is composited over its own image in
  // the place of beauty; empty: beauty.
  std::string part;
  Knobs knobs;
};

}  // namespace candela
