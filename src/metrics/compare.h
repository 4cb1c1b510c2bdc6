#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/image.h"

namespace candela {

// Metric names as on the command line and in JSON: max, mae, rmse, relmse, psnr, ssim, flip, hdr-flip, differing.
// LDR metrics (psnr, ssim, flip) take display-encoded values in [0,1]; EXR input is first encoded with sRGB after clamping.
struct Comparison {
  std::string refusal;                    // sizes, channels or finiteness differ: said before any metric; empty when comparable
  std::map<std::string, double> metrics;  // absent metrics were not asked for
  std::vector<float> flip_map;            // width*height in [0,1] when flip was computed
  int width = 0, height = 0;
};

}  // namespace candela
