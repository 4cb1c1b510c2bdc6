#include "passes/surfaces/ibl_knobs.h"

namespace candela {

std::span<const Knob> IblKnobs::table() {
  static constexpr std::string_view filtered = "ibl.method=lobe";
  static const Knob rows[] = {
      {.name = "method",
       .member = &IblKnobs::method,
       .lowest = 0,
       .highest = 2,
       .levels = {0, 1, 1, 2},
       .description =
           "reflections of the sky: one lookup about the mirror direction; one about the lobe's own middle, as "
           "wide as the lobe, and its bright spots as lights; or samples for every pixel",
       .choices = {"split", "lobe", "sampled"},
       .sweep = {0, 1, 2}},
      {.name = "lights",
       .member = &IblKnobs::lights,
       .lowest = 0,
       .highest = 256,
       .levels = {4, 16, 32, 256},
       .description =
           "bright spots of the sky that shine as lights on rough surfaces, at most; others are blurred with it",
       .sweep = {0, 4, 16, 32, 256},
       .required = filtered},
      {.name = "size_px",
       .member = &IblKnobs::size_px,
       .unit = "px",
       .lowest = 32,
       .highest = 2048,
       .levels = {128, 256, 512, 1024},
       .description = "side of the filtered sky's sharpest maps, at most as the sky's own texels have it",
       .sweep = {64, 128, 256, 512, 1024},
       .required = filtered},
      {.name = "filter_samples",
       .member = &IblKnobs::filter_samples,
       .lowest = 4,
       .highest = 4096,
       .levels = {32, 64, 64, 512},
       .description =
           "samples of the sky for a texel of its sharpest maps; blurred ones take as many more as they are smaller",
       .sweep = {8, 16, 64, 512},
       .required = filtered},
      {.name = "irradiance_px",
       .member = &IblKnobs::irradiance_px,
       .unit = "px",
       .lowest = 0,
       .highest = 256,
       .levels = {0, 32, 32, 64},
       .description = "side of the map of diffuse light; 0: nine spherical harmonics, which a bright sun makes wrong",
       .sweep = {0, 8, 16, 32, 64},
       .required = filtered},
      {.name = "pixel_samples",
       .member = &IblKnobs::pixel_samples,
       .lowest = 1,
       .highest = 1 << 20,
       .levels = {64, 64, 256, 1024},
       .description = "method sampled: samples a pixel for each lobe",
       .sweep = {16, 64, 256, 1024},
       .required = "ibl.method=sampled"},
      {.name = "stretched",
       .member = &IblKnobs::stretched,
       .lowest = 1,
       .highest = 1 << 16,
       .levels = {12, 24, 48, 1024},
       .description =
           "directions from which a pixel of stretched metal (anisotropy) takes the sky, each as wide as its "
           "fraction; fewer show as steps",
       .sweep = {8, 24, 48, 1024},
       .required = filtered},
      {.name = "mirror_taps",
       .member = &IblKnobs::mirror_taps,
       .lowest = 0,
       .highest = 1 << 16,
       .levels = {1, 4, 8, 64},
       .description = "lookups of the sky image over the part of it that a pixel of a smooth surface mirrors; fewer "
                      "blur more; 0: one direction of the filtered sky, which misses small lights",
       .sweep = {0, 1, 4, 8, 64},
       .required = "ibl.method=lobe"},
  };
  return rows;
}

bool IblKnobs::matter(const SceneFacts& facts) { return facts.image_light; }

}  // namespace candela
