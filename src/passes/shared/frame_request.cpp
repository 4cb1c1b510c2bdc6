#include "passes/shared/frame_request.h"

#include <algorithm>

#include "base/text.h"

namespace candela {

bool FrameRequest::names_effect(std::string_view effect) const {
  const std::vector<std::string> names = split(effects, ',');
  return std::find(names.begin(), names.end(), effect) != names.end();
}

}  // namespace candela
