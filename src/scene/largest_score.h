#pragma once
#include <algorithm>
#include <limits>

#include "base/scratch.h"
#include "scene/frame_data.h"

namespace candela {

// The largest score of the groups' items, by their boxes; -infinity without any. most: no less than what any box within
// the given one scores.
template <class Most, class Score>
double largest_score(const Scene& scene, const FrameData& data, Most most, Score score) {
  double largest = -std::numeric_limits<double>::infinity();
  Scratch scratch;
  ScratchVector<double> bounds(&scratch);
  for (const ItemGroup& group : data.item_groups) {
    if (!(most(relative_box(group, group.set->all)) > largest)) continue;
    const std::vector<InstanceCluster>& clusters = group.set->clusters;
    bounds.clear();
    for (const InstanceCluster& cluster : clusters) bounds.push_back(most(relative_box(group, cluster)));
    const auto look_at = [&](size_t c) {
      if (!(bounds[c] > largest)) return;
      for (uint32_t i = 0; i < clusters[c].count; ++i)
        for (const uint32_t section : group.set->sections)
          largest = std::max(largest, score(bounds_of(scene, group, group.set->order[clusters[c].first + i], section)));
    };
    look_at(size_t(std::max_element(bounds.begin(), bounds.end()) - bounds.begin()));  // it spares most others
    for (size_t c = 0; c < clusters.size(); ++c) look_at(c);
  }
  return largest;
}

}  // namespace candela
