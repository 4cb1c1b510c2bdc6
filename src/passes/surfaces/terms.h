#pragma once
#include <array>

#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/shared/reflected.h"
#include "passes/shared/seen_through.h"
#include "passes/surfaces/ibl_knobs.h"
#include "passes/surfaces/probe_knobs.h"
#include "passes/surfaces/surface_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// The terms that beauty is the sum of, in the order of shaders/terms.frag's outputs and of --layers.
enum class Term : uint32_t {
  direct_sun,
  direct_point,
  direct_spot,
  ambient_diffuse,
  ambient_specular,
  emission,
  background,
  reflections
};
inline constexpr uint32_t term_count = 8;
static_assert(term_count <= 8, "lavapipe 25.0.7 ends the program at more than eight colour attachments");

// Beauty by its terms: the light of directional, point and spot lights, ambient light by the lobe that reflects it,
// emission (of unlit surfaces their colour), what lies behind everything, and what surfaces reflect of each other,
// which is taken from the sky's specular light. Surfaces are shaded again, at the samples of beauty and against its
// depth (EQUAL), into images of their own, and blended surfaces composite over each term as they do over beauty:
// premultiplied, in the same order. So no bit of beauty changes, and the terms sum to it up to the rounding of 32-bit
// sums. Units: as beauty. Costs about another frame; leaves wrong what beauty does.
struct Terms {
  static constexpr std::string_view name = "terms";
  static constexpr LayerName layers[term_count] = {
      {"direct_sun", "term of beauty: light of the directional lights"},
      {"direct_point", "term of beauty: light of the point lights"},
      {"direct_spot", "term of beauty: light of the spot lights"},
      {"ambient_diffuse", "term of beauty: ambient light, reflected diffusely"},
      {"ambient_specular", "term of beauty: ambient light, reflected in highlights"},
      {"emission", "term of beauty: light that surfaces emit"},
      {"background", "term of beauty: what is behind everything, and what is seen through surfaces"},
      {"reflections", "term of beauty: what surfaces mirror of each other"}};
  using SharedKnobs = std::tuple<LightRangeKnobs, TextureKnobs, IblKnobs, ProbeKnobs, SurfaceKnobs, ReliefKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;   // optional
    Lighting lists;          // empty: every light for every pixel
    ImageHandle depth;       // optional: there are blended surfaces alone without it
    ImageHandle background;  // optional: sky or background where no opaque surface is
    Reflected reflected;     // optional: without it surfaces reflect the sky alone
    SeenThrough seen;        // optional: without it no surface lets light through
    ImageHandle nearest;     // with it: depth of those surfaces too
    std::array<bool, term_count> wanted{};
    // With of_lights instead: how many groups of lights, from which on; each group's light is one image.
    uint32_t groups = 0, first_group = 0;
    bool without_blended = false;  // passes behind this one draw blended surfaces over each term
  };
  struct Out {
    std::array<ImageHandle, term_count> images;  // as multisampled as the frame; empty where not wanted
    BatchPipelines opaque, refracting, blended;
    PipelineHandle reflected;  // drawn between the two
  };
  // The shader of one term alone, for Fragments::part, and of one group of lights.
  static std::string stored_part(size_t term);
  static std::string stored_group(uint32_t group);
  bool of_lights = false;  // the light of the lights alone, by named groups (--light-groups), whose sum it is
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
