#pragma once
#include "render/sequence.h"

namespace candela::cli {

std::string duration_text(double seconds);  // "2m05s"

// Progress on stderr: one line that is written over on a terminal, a plain line every few seconds elsewhere.
class ProgressLine {
 public:
  ProgressLine(bool quiet);
  void show(const SequenceProgress& progress);
  void end();  // leaves the last line standing

 private:
  bool quiet_, terminal_, open_ = false;
  double last_us_ = 0;
};

}  // namespace candela::cli
