#include "frame/frame_views.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace candela {
namespace {

// The device adds and multiplies in float: about six roundings, and it keeps what lies outside by up to four.
constexpr double rounding = 16 * 0x1p-23;

}  // namespace

bool casts_shadows(const DrawRun& run) { return run.solid() && run.topology == Topology::triangles; }

bool may_keep(const shared::View& view, const shared::Item& item) {
  const glm::dvec3 centre(item.bounds_centre), extent(item.bounds_extent);
  for (const glm::vec4& plane : view.planes) {
    const glm::dvec3 n(plane), n_abs = glm::abs(n);
    const double outwards = glm::dot(n_abs, extent);
    const double reach = glm::dot(n, centre) + double(plane.w) + outwards;
    const double scale = glm::dot(n_abs, glm::abs(centre)) + outwards + std::abs(double(plane.w));
    if (reach < -rounding * scale) return false;  // not for NaN
  }
  return true;
}

Expected<FrameViews> place_views(std::vector<shared::View> views, std::span<const shared::Item> items,
                                 std::span<const DrawRun> runs, bool culling, uint64_t budget, std::string_view knob,
                                 bool see_through) {
  FrameViews placed;
  placed.table = std::move(views);
  std::vector<uint32_t> counts(placed.table.size() * runs.size());
  tbb::parallel_for(size_t(0), placed.table.size(), [&](size_t v) {
    for (size_t r = 0; r < runs.size(); ++r) {
      if (!casts_shadows(runs[r]) && !(see_through && runs[r].topology == Topology::triangles)) continue;
      const auto of_run = items.subspan(runs[r].first, runs[r].count);
      counts[v * runs.size() + r] =
          !culling ? runs[r].count
                   : uint32_t(std::count_if(of_run.begin(), of_run.end(),
                                            [&](const shared::Item& item) { return may_keep(placed.table[v], item); }));
    }
  });
  uint64_t needed = 0;
  for (const uint32_t count : counts) {
    placed.first_command.push_back(uint32_t(std::min<uint64_t>(needed, std::numeric_limits<uint32_t>::max())));
    needed += count;
  }
  const uint64_t most = std::min<uint64_t>(budget, std::numeric_limits<uint32_t>::max());
  if (needed > most)
    return fail(ErrorKind::usage, "--set",
                "the frame's {} shadow views need room for {} draw commands, more than {} = {}; set {} "
                "to {} or more ({} bytes each), or have fewer shadows",
                placed.table.size(), needed, knob, budget, knob, needed, sizeof(shared::DrawCommand));
  placed.first_command.push_back(uint32_t(needed));
  return placed;
}

}  // namespace candela
