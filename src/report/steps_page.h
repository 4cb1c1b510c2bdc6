#pragma once
#include <string>
#include <utility>
#include <vector>

#include "gpu/frame_runner.h"
#include "graph/plan.h"
#include "render/step_pictures.h"

namespace candela {

// A frame as it grows, pass by pass (`render --steps`): time, what is read and written, pictures of what was written.
struct StepsPage {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;
  const FramePlan& plan;
  std::vector<gpu::PassTime> times;  // of its passes
  double frame_ms = 0;
  std::vector<StepPicture> pictures;  // files that lie beside the page
};
// One page without anything from outside but those files: a diagram of the flow of data, then a section a pass.
std::string steps_page_html(const StepsPage& page);

}  // namespace candela
