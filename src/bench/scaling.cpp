#include "bench/scaling.h"

#include <algorithm>
#include <cmath>

namespace candela {
namespace {

double device_peak_mib(const BenchRow& row) {
  for (const auto& [name, bytes] : row.memory)
    if (name == "device_peak_bytes") return double(bytes) / double(1 << 20);
  return 0;
}

// Small numbers of lights cost what a frame costs without any: a slope through them says little about many.
PowerFit fit_top(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.empty()) return {};
  const auto first = std::lower_bound(x.begin(), x.end(), x.back() / 64);
  const size_t skipped = size_t(first - x.begin());
  return fit_power(std::span(x).subspan(skipped), std::span(y).subspan(skipped));
}

}  // namespace

std::vector<Scaling> scalings(const std::vector<const BenchRow*>& rows) {
  std::vector<const BenchRow*> sorted;
  for (const BenchRow* row : rows)
    if (!row->frame.ms.empty() && row->lights >= 0) sorted.push_back(row);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const BenchRow* a, const BenchRow* b) { return a->lights < b->lights; });
  std::vector<Scaling> all;
  for (const BenchRow* row : rows)
    if (std::none_of(all.begin(), all.end(), [&](const Scaling& s) { return s.way == row_way(*row); }))
      all.push_back({.way = row_way(*row)});
  for (Scaling& s : all) {
    for (const BenchRow* row : sorted) {
      if (row_way(*row) != s.way) continue;
      s.lights.push_back(double(row->lights));
      s.frame_ms.push_back(summary(row->frame.ms).median);
      s.frame_ci.push_back(median_interval(row->frame.ms));
      s.gpu_ms.push_back(summary(row->gpu.ms).median);
      s.lights_per_pixel.push_back(row->lists ? row->lists->mean : std::nan(""));
      s.waste_fraction.push_back(row->lists ? row->lists->waste_fraction : std::nan(""));
      s.memory_mib.push_back(device_peak_mib(*row));
    }
    s.all = fit_power(s.lights, s.frame_ms);
    s.top = fit_top(s.lights, s.frame_ms);
  }
  std::erase_if(all, [](const Scaling& s) { return s.lights.empty(); });
  return all;
}

}  // namespace candela
