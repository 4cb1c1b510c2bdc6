#pragma once
#include <utility>
#include <vector>

#include "plan/frame_views.h"

namespace candela::test {

// Views with room for their draws.
template <class... Args>
Expected<FrameViews> placed_views(const std::vector<shared::View>& views, Args&&... args) {
  FrameViews placed;
  placed.table = views;
  if (auto fine = place_views(placed, std::forward<Args>(args)...); !fine) return std::unexpected(fine.error());
  return placed;
}

}  // namespace candela::test
