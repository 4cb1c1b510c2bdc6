#pragma once
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "bench/picture.h"
#include "image/image.h"
#include "job/job.h"

namespace candela {

// What a picture should be: of every pixel the value at its centre, and the least and largest that it takes within
// `reach_px` of it. Any value between is right: devices round the corners of triangles to a part of a pixel (Vulkan's
// subPixelPrecisionBits), and with them shift what lies between; and they hold places as 32-bit numbers relative to the
// camera.
struct TruePicture {
  int width_px = 0, height_px = 0;
  std::vector<glm::dvec4> centre, low, high;  // linear, premultiplied, without exposure
};
// By the reference ray tracer: direct light without shadows and the ambient term as the techniques have it; or, of more
// than 0 samples, their mean with all that stands in the light's way.
Expected<TruePicture> traced_picture(const Job& job, double time_s, double reach_px, int blocked_samples = 0);
// Pixels of the path tracer that are not finite, at a few samples each.
Expected<uint64_t> nonfinite_paths(const Job& job, double time_s);
// Another picture's own pixels.
TruePicture picture_truth(const Beauty& beauty, double pre_exposure);

struct TruthError {
  double max_relative =
      0;  // of the worst pixel, against the largest of its own value, a hundredth of the picture's median, least_light
  uint64_t beyond = 0;  // pixels above the bound
  int worst_x = 0, worst_y = 0;
  double energy = 0;  // sum over the picture against the truth's, minus 1
  // How far the sum over the pixels within the bound lies outside the sums of their least and largest values, as a part
  // of the truth's sum; pixels beyond are counted, and not finite ones are faults by themselves.
  double energy_beyond = 0;
};
TruthError picture_error(const Beauty& beauty, double pre_exposure, const TruePicture& truth, double bound,
                         double least_light = 0);

struct PixelCounts {
  uint64_t nonfinite = 0;  // pixels
  int first_x = -1, first_y = -1;
  uint64_t beyond_half = 0;  // colour values that an EXR file of halves holds clamped
  bool black = true;         // all colour is 0
  double most = 0;           // the largest colour value
};
PixelCounts count_pixels(const Beauty& beauty, double pre_exposure);

// Pixels of a picture with effects: not finite, with a negative colour, or brighter than the bare one by more than
// rounding (bare may be null), or than `most`.
struct EffectCounts {
  uint64_t nonfinite = 0, negative = 0, brighter = 0;
  int first_x = -1, first_y = -1;
};
EffectCounts count_effects(const Beauty* bare, double bare_pre_exposure, const Beauty& drawn, double pre_exposure,
                           double most = std::numeric_limits<double>::infinity());

// Of the layers of one frame, one after the other: values that are not finite (ids of Cryptomatte are floats, too), and
// the coverage of each pixel by names, of objects and of materials apart.
struct LayerCounts {
  uint64_t nonfinite = 0;
  std::map<std::string, std::vector<float>> coverage;  // by Cryptomatte's layer
  void add(const FloatImage& layer);
  uint64_t overcovered() const;  // pixels that some layer covers by more than 1
};

// Largest difference between the 16-bit display picture and the curve in double from the same linear pixels, in parts
// of one.
double display_error(const DisplayImage& display, const Beauty& beauty, double pre_exposure, const Job& job);

}  // namespace candela
