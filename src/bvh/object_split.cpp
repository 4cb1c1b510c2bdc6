#include "bvh/object_split.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>

namespace candela {
namespace {

struct Bins {
  union {
    BuildBox box[3][most_buckets];  // only the first `buckets` are ever begun
  };
  uint32_t count[3][most_buckets];
  int buckets;

  explicit Bins(int n) : buckets(n) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < n; ++b) box[a][b] = {}, count[a][b] = 0;
  }
  void add(Span references, const Buckets& how) {
    for (const BoxReference& r : references) {
      const F4 low = low_of(r), high = high_of(r);
      int32_t k[4];
      how.of(low + high, k);
      for (int a = 0; a < 3; ++a) {
        box[a][k[a]].add(low, high);
        ++count[a][k[a]];
      }
    }
  }
  void add(const Bins& other) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < buckets; ++b) box[a][b].add(other.box[a][b]), count[a][b] += other.count[a][b];
  }
};

struct ParallelBins {
  Span references;
  const Buckets& how;
  Bins bins;
  ParallelBins(Span r, const Buckets& h) : references(r), how(h), bins(h.count()) {}
  ParallelBins(ParallelBins& other, tbb::split) : ParallelBins(other.references, other.how) {}
  void operator()(const tbb::blocked_range<uint32_t>& range) {
    bins.add({references.references + range.begin(), uint32_t(range.size())}, how);
  }
  void join(const ParallelBins& other) { bins.add(other.bins); }
};

BuildBox union_of(const BuildBox* boxes, int first, int last) {
  BuildBox all;
  for (int i = first; i < last; ++i) all.add(boxes[i]);
  return all;
}

ObjectSplit best_split(const Bins& bins, const Buckets& how, uint32_t block_shift, bool with_overlap) {
  ObjectSplit best;
  const int n = bins.buckets;
  for (int a = 0; a < 3; ++a) {
    if (!how.usable(a)) continue;
    float right_cost[most_buckets];
    BuildBox box;
    uint32_t count = 0;
    for (int b = n - 1; b > 0; --b) {
      box.add(bins.box[a][b]), count += bins.count[a][b];
      right_cost[b] = count > 0 ? box.half_area() * tests_of(count, block_shift) : -1.0f;  // -1: an empty side
    }
    box = {}, count = 0;
    for (int b = 1; b < n; ++b) {
      box.add(bins.box[a][b - 1]), count += bins.count[a][b - 1];
      if (count == 0 || right_cost[b] < 0) continue;
      const float cost = box.half_area() * tests_of(count, block_shift) + right_cost[b];
      if (cost < best.cost) best.axis = a, best.bucket = b, best.cost = cost;
    }
  }
  if (best.axis >= 0 && with_overlap) {
    const BuildBox left = union_of(bins.box[best.axis], 0, best.bucket);
    const BuildBox right = union_of(bins.box[best.axis], best.bucket, n);
    const Aabb common = BuildBox{max(left.low, right.low), min(left.high, right.high)}.aabb();
    if (!common.empty()) best.overlap = BuildBox{max(left.low, right.low), min(left.high, right.high)}.half_area();
  }
  return best;
}

}  // namespace

Buckets::Buckets(const BuildBox& centres2, int buckets)
    : low4_(without_lane_3(centres2.low)), last4_(F4::all(float(buckets - 1))), buckets_(buckets) {
  float extent[4];
  (centres2.high - centres2.low).store(extent);
  for (int a = 0; a < 3; ++a) {
    // A hair below the count, so that the highest centre falls into the last bucket. An extent whose inverse overflows
    // is as good as none.
    const float scale = float(buckets) * 0.99999f / extent[a];
    scale_[a] = extent[a] > 0 && std::isfinite(scale) ? scale : 0.0f;
  }
  scale_[3] = 0;
  scale4_ = F4::load(scale_);
}

ObjectSplit find_object_split(Span references, const Buckets& buckets, uint32_t block_shift, bool with_overlap) {
  if (references.count < parallel_binning) {
    Bins bins(buckets.count());
    bins.add(references, buckets);
    return best_split(bins, buckets, block_shift, with_overlap);
  }
  ParallelBins bins(references, buckets);
  tbb::parallel_reduce(tbb::blocked_range<uint32_t>(0, references.count, parallel_binning / 8), bins);
  return best_split(bins.bins, buckets, block_shift, with_overlap);
}

}  // namespace candela
