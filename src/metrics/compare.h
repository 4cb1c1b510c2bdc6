#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/image.h"
#include "metrics/hdr_flip.h"
#include "metrics/layers.h"
#include "metrics/noise_floor.h"
#include "metrics/regions.h"

namespace candela {

// What the values mean. Scene-linear images (EXR, HDR) are clamped to [0,1] and sRGB-encoded before the metrics that
// model display pixels (psnr, ssim, flip); max, mae, rmse and relmse always take the values as they are.
enum class Encoding { linear, display };

// Metric names as on the command line and in JSON. A is the reference, B the image under test. All sums are in double
// and in a fixed order, so a result does not depend on the number of threads.
//   max, mae, rmse   |b-a| over the channels without a layer name (R G B A or Y; alpha as stored), or over all float
//   channels
//                    where every channel is in a layer; integer channels (ids) count in `differing` only
//   relmse           mean of (b-a)^2 / (a^2 + 0.01) over the same channels
//   relmse-trimmed   the same without the 0.1 % of the pixels where it is largest: a few fireflies can be all of relmse
//   p50, p90, p99, p99.9   percentiles over the pixels of the largest |b-a| of a pixel's channels
//   psnr             10 log10(1/MSE) of the display-encoded colour, dB; psnr_of_equal where the MSE is 0
//   ssim             mean structural similarity of the display-encoded luma (ssim.h)
//   flip             mean LDR-FLIP at 67 pixels per degree (flip.h)
//   hdr-flip         mean HDR-FLIP of scene-linear colour (hdr_flip.h)
//   differing        pixels that are not bit-equal in every channel, layers and integers too
// Colour is R, G, B, or Y for all three. psnr, ssim, flip and hdr-flip see it times alpha, as EXR stores it and as it
// stands before black: what is transparent has no colour. An image without alpha is comparable with one whose alpha is
// 1 everywhere. Images without colour have no psnr, ssim and flip.
inline constexpr double psnr_of_equal = 999.0;  // JSON has no infinity

struct RegionResult {
  Region region;
  std::map<std::string, double> metrics;  // flip and hdr-flip are means of the whole image's maps
  Place max_at;                           // in the whole image
  std::optional<NoiseFloor> noise;
};

struct Comparison {
  std::string refusal;  // sizes, windows, channels or finiteness differ: said before any metric; empty when comparable
  std::vector<std::string> notes;         // what was taken for equal
  std::map<std::string, double> metrics;  // empty when refused
  std::vector<float> flip_map;            // width*height in [0,1]; empty when flip was not computed
  size_t nonfinite_in_both = 0;           // equal NaNs or infinities at the same place: they count as no difference
  size_t nonfinite_reference = 0, nonfinite_test = 0;  // pixels with a value that is not finite in any channel
  int width = 0, height = 0;
  Place max_at;
  std::optional<ExposureRange> exposures;  // of hdr-flip
  std::optional<NoiseFloor> noise;         // where the reference says how noisy it is
  std::vector<LayerResult> layers;
  std::vector<RegionResult> regions;
  std::vector<std::string> only_in_reference, only_in_test;  // layers that the other has not: a refusal
  std::vector<SharedLevels> shared_levels;                   // only these ranks of Cryptomatte are compared
};

struct HdrFlipChoice {
  std::optional<ExposureRange> range;  // nullopt: automatic, from the reference
};
struct CompareOptions {
  Encoding encoding = Encoding::display;
  bool perceptual = true;                 // ssim and flip, which cost the most
  std::optional<HdrFlipChoice> hdr_flip;  // of scene-linear images; costs a flip for each exposure
  bool layers = false;
  std::vector<Region> regions;  // within the image, or it is a refusal
};
Comparison compare(const FloatImage& reference, const FloatImage& test, const CompareOptions& options);

// Reads both; EXR and Radiance HDR are linear, everything else display-encoded (options.encoding is not asked); one of
// each is a refusal. Layers that one file alone has are a refusal, and named; of Cryptomatte's the levels that both
// have are compared. Errors: a file that cannot be read (input). Of a file, by its ending: .exr and .hdr are
// scene-linear.
Encoding encoding_of(const std::filesystem::path& path);
Expected<Comparison> compare_files(const std::filesystem::path& reference, const std::filesystem::path& test,
                                   CompareOptions options = {});

// Display-encoded red, green and blue in [0,1] before black, a plane each: of display-encoded images, whose alpha is
// straight, times alpha; nothing when the image has neither R, G, B nor Y.
std::vector<std::vector<float>> display_planes(const FloatImage& image, Encoding encoding);

// True when every pixel has the same colour: a render that shows nothing.
bool is_blank(const FloatImage& image);

}  // namespace candela
