#pragma once
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "bench/picture.h"
#include "render/job.h"

namespace candela {

// What a picture should be: of every pixel the value at its centre, and the least and largest that it takes nearby, inside the pixel.
// Where these are more than a tenth apart, an edge runs through the pixel and any value between is right: rounding decides which side
// the centre is on.
struct TruePicture {
  int width_px = 0, height_px = 0;
  std::vector<glm::dvec4> centre, low, high;  // linear, premultiplied, without exposure
};
// By the reference ray tracer: direct light without shadows and the ambient term as the techniques have it; side * side samples a
// pixel (an odd number, so that one of them is the centre).
Expected<TruePicture> traced_picture(const Job& job, double time_s, int side);
// Pixels of the path tracer that are not finite, at a few samples each.
Expected<uint64_t> nonfinite_paths(const Job& job, double time_s);
// Another picture's own pixels.
TruePicture picture_truth(const Beauty& beauty, double pre_exposure);

struct TruthError {
  double max_relative = 0;  // of the worst pixel, against its own value or a hundredth of the picture's median, whichever is larger
  uint64_t beyond = 0;      // pixels above the bound
  int worst_x = 0, worst_y = 0;
  double energy = 0;        // sum over the picture against the truth's, minus 1
};
TruthError picture_error(const Beauty& beauty, double pre_exposure, const TruePicture& truth, double bound);

struct PixelCounts {
  uint64_t nonfinite = 0;    // pixels
  int first_x = -1, first_y = -1;
  uint64_t beyond_half = 0;  // colour values that an EXR file of halves holds clamped
  bool black = true;         // all colour is 0
};
PixelCounts count_pixels(const Beauty& beauty, double pre_exposure);

// Largest difference between the 16-bit display picture and the curve in double from the same linear pixels, in parts of one.
double display_error(const DisplayImage& display, const Beauty& beauty, double pre_exposure, const Job& job);

}  // namespace candela
