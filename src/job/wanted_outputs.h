#pragma once
#include <vector>

#include "job/dump_request.h"

namespace candela {

// What the host gets of a frame.
struct WantedOutputs {
  bool linear = true;    // EXR
  bool display = false;  // PNG, video
  int display_bits = 8;  // 8 or 16
  // For prepare_outputs() and nothing else: packed on the device as the job's files hold it. linear is then of EXR
  // files alone: pixels that are not finite are counted on the device.
  bool files = false;
  std::vector<DumpRequest> dumps = {};
};

}  // namespace candela
