#include "passes/shared/frame_request.h"

namespace candela {

bool FrameRequest::names_effect(std::string_view effect) const {
  const std::string_view names = effects;
  for (size_t begin = 0;;) {
    const size_t end = names.find(',', begin);
    if (names.substr(begin, end == names.npos ? end : end - begin) == effect) return true;
    if (end == names.npos) return false;
    begin = end + 1;
  }
}

}  // namespace candela
