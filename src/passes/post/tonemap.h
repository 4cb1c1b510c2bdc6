#pragma once
#include <optional>

#include "look/look.h"
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// The curves of shaders/lib/tone_curves.glsl, by --tonemap's names. reinhard_luminance is Reinhard on Rec.709
// luminance; rec709 is the camera's transfer function of ITU-R BT.709 in the place of sRGB's.
enum class ToneCurve : uint32_t { none, agx, reinhard, aces, neutral, reinhard_luminance, rec709, agx_2020 };
std::span<const std::string_view> tone_curve_names();  // in the order of the enum

// Linear radiance to display values: tone curve, sRGB encoding, unbiased dither before 8 bits (triangular, uniform next
// to black and white), straight alpha. Exact up to 32-bit float arithmetic; the dither moves a value by one code at
// most.
struct Tonemap {
  static constexpr std::string_view name = "tonemap";
  struct In {
    ImageHandle color;
    uint32_t width_px = 0, height_px = 0;
    ToneCurve curve = ToneCurve::agx;
    uint32_t bits = 8;
    bool dither = true;
    Live<uint32_t> seed = 0u;
    bool covers = false;                      // there is no alpha: 1 is taken for it
    std::optional<uint32_t> behind_rgb = {};  // sRGB codes that it is laid over
    uint32_t samples = 1;                     // of the colour; the mean of more is shown
    Live<float> exposure = 1;                 // what is left to apply after pre-exposure
    BufferHandle automatic;                   // optional: a factor on top (passes/post/exposure.h)
    Live<float> agx_min_ev = float(agx_lowest_ev), agx_max_ev = float(agx_highest_ev);
  };
  struct Out {
    ImageHandle display;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
