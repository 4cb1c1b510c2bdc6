#include "passes/surfaces/ibl_knobs.h"

namespace candela {

std::span<const Knob<IblKnobs>> IblKnobs::table() {
  static constexpr std::string_view filtered = "ibl.method=lobe";
  static const Knob<IblKnobs> rows[] = {
      {.name = "method",
       .member = &IblKnobs::method,
       .lowest = 0,
       .highest = 2,
       .ladder = {0, 1, 1, 2},
       .trades = "reflections of the sky: one lookup about the mirror direction; one about the lobe's own middle, as "
                 "wide as the lobe, and its bright spots as lights; or samples for every pixel",
       .choices = {"split", "lobe", "sampled"},
       .walk = {0, 1, 2}},
      {.name = "lights",
       .member = &IblKnobs::lights,
       .lowest = 0,
       .highest = 256,
       .ladder = {4, 16, 32, 256},
       .trades = "bright spots of the sky that shine as lights on rough surfaces, at most; others are blurred with it",
       .walk = {0, 4, 16, 32, 256},
       .beside = filtered},
      {.name = "size_px",
       .member = &IblKnobs::size_px,
       .unit = "px",
       .lowest = 32,
       .highest = 2048,
       .ladder = {128, 256, 512, 1024},
       .trades = "side of the filtered sky's sharpest maps, at most as the sky's own texels have it",
       .walk = {64, 128, 256, 512, 1024},
       .beside = filtered},
      {.name = "filter_samples",
       .member = &IblKnobs::filter_samples,
       .lowest = 4,
       .highest = 4096,
       .ladder = {32, 64, 64, 512},
       .trades =
           "samples of the sky for a texel of its sharpest maps; blurred ones take as many more as they are smaller",
       .walk = {8, 16, 64, 512},
       .beside = filtered},
      {.name = "irradiance_px",
       .member = &IblKnobs::irradiance_px,
       .unit = "px",
       .lowest = 0,
       .highest = 256,
       .ladder = {0, 32, 32, 64},
       .trades = "side of the map of diffuse light; 0: nine spherical harmonics, which a bright sun makes wrong",
       .walk = {0, 8, 16, 32, 64},
       .beside = filtered},
      {.name = "pixel_samples",
       .member = &IblKnobs::pixel_samples,
       .lowest = 1,
       .highest = 1 << 20,
       .ladder = {64, 64, 256, 1024},
       .trades = "method sampled: samples a pixel for each lobe",
       .walk = {16, 64, 256, 1024},
       .beside = "ibl.method=sampled"},
  };
  return rows;
}

bool IblKnobs::matter(const SceneFacts& facts) { return facts.image_light; }

}  // namespace candela
