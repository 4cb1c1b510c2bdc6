#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/hash.h"
#include "image/io.h"
#include "passes/surfaces/ibl_knobs.h"
#include "shared/image_light.h"
#include "sky/sky_pyramid.h"

namespace candela {

// What surfaces reflect of a sky, made on the CPU so that every device samples the same texels. All maps are
// octahedral (Engelhardt and Dachsbacher, "Octahedron Environment Maps", 2008) with a texel of margin, four floats a
// texel; linear radiance.
//   slices      means of the sky weighed by the GGX lobe that is seen along its own middle, n = v = r (Karis, "Real
//               Shading in Unreal Engine 4", 2013), for the roughness of each slice, by filtered importance sampling
//               (Krivanek and Colbert, "Real-time Shading with Filtered Importance Sampling", 2008); texels that
//               are brighter by far are summed instead, for samples on the lobe's flanks would smear them
//   lights      bright spots, which the slices of rough lobes do not hold
//   irradiance  means weighed by the cosine, of the whole sky; summed, not sampled
//   lobes       over n.v and roughness (axes as shared/split_sum.h) where the middle of the true lobe lies, as its
//   place
//               on the way from the normal (0) to the mirror direction (1), and the slice as wide as it
struct FilteredSky {
  uint32_t width = 0, height = 0;  // of the texture of slices
  std::vector<float> texels;
  std::vector<shared::SkySlice> slices;
  std::vector<shared::SkyLight> lights;
  uint32_t irradiance_px = 0;  // with the margin; 0: none
  std::vector<float> irradiance;
  std::vector<float> lobes;  // four numbers each, shared::sky_lobe_size squared
};
FilteredSky prefilter_sky(const DecodedImage& sky, const IblKnobs& knobs);

// For the method that samples the sky itself: its bright spots, and the rest with its mip levels.
struct DividedSky {
  std::vector<SkyLevel> rest;
  std::vector<shared::SkyLight> lights;
};
DividedSky divide_sky(const DecodedImage& sky, const IblKnobs& knobs);

// The same, kept in a folder (skies/*.sky) by the sky's content and the knobs. An empty folder keeps nothing.
FilteredSky filtered_sky(const DecodedImage& sky, const IblKnobs& knobs, const std::filesystem::path& cache_folder);

// The slice that a lobe of a perceptual roughness is of, between the slices.
double slice_of_roughness(double roughness);

}  // namespace candela
