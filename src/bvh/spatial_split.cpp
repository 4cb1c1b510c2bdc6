#include "bvh/spatial_split.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace candela {
namespace {

// A triangle made ready to be cut by several planes.
class Cutter {
 public:
  explicit Cutter(const TriangleCorners& t) : triangle_(t) {
    F4 low = F4::all(0), high = low;
    for (int i = 0; i < 3; ++i) {
      corner_[i] = F4::load3(&t.corner[i].x);
      low = i == 0 ? corner_[i] : min(low, corner_[i]), high = i == 0 ? corner_[i] : max(high, corner_[i]);
    }
    margin_ = F4::all((high - low).largest3() * rounding_fraction);
    // Where an edge meets a plane: off by the rounding of the parameter, which moves the point along the edge, and of
    // the point itself.
    slack_ = ((high - low) + max(absolute(low), absolute(high))) * F4::all(4 * 0x1p-24f) + margin_;
  }

  CutReference operator()(const BuildBox& reference, int axis, float plane) const {
    CutReference out;
    for (int i = 0; i < 3; ++i) {
      const int next = i == 2 ? 0 : i + 1;
      const float from = triangle_.corner[i][axis], to = triangle_.corner[next][axis];
      if (from <= plane) out.left.add(corner_[i] - margin_, corner_[i] + margin_);
      if (from >= plane) out.right.add(corner_[i] - margin_, corner_[i] + margin_);
      if ((from < plane && to > plane) || (from > plane && to < plane)) {
        const F4 point = corner_[i] + (corner_[next] - corner_[i]) * F4::all((plane - from) / (to - from));
        out.left.add(point - slack_, point + slack_);
        out.right.add(point - slack_, point + slack_);
      }
    }
    constexpr float infinity = std::numeric_limits<float>::infinity();
    out.left = {max(out.left.low, reference.low),
                min(min(out.left.high, reference.high), F4::one_lane(infinity, axis, plane))};
    out.right = {max(max(out.right.low, reference.low), F4::one_lane(-infinity, axis, plane)),
                 min(out.right.high, reference.high)};
    out.has_left = valid(out.left), out.has_right = valid(out.right);
    return out;
  }

 private:
  static bool valid(const BuildBox& b) { return (less_equal(b.low, b.high).bits() & 7u) == 7u; }
  const TriangleCorners& triangle_;
  F4 corner_[3], margin_, slack_;
};

struct Slabs {  // equal slabs of a box on one axis
  float low, width, scale;
  int count;
  Slabs(const BuildBox& box, int axis, int n) : count(n) {
    const Aabb b = box.aabb();
    low = b.min[axis], width = (b.max[axis] - b.min[axis]) / float(n);
    scale = width > 0 ? 1.0f / width : 0.0f;
  }
  bool usable() const { return width > 0 && std::isfinite(scale) && plane(1) > low; }
  float plane(int k) const { return low + width * float(k); }  // the lower side of slab k
  int of(float x) const {
    int k = std::clamp(int(std::min((x - low) * scale, float(count))), 0, count - 1);
    // The plane decides, not the rounded product: what straddles a plane here must do so when the split is applied.
    if (k > 0 && x < plane(k)) --k;
    if (k + 1 < count && x >= plane(k + 1)) ++k;
    return k;
  }
};

struct SlabBins {
  BuildBox* box;
  uint32_t *entry, *exit;
};

void add_reference(const SlabBins& bins, const Slabs& slabs, const BoxReference& r, const Cutter& cutter, int axis) {
  const int first = slabs.of(r.low[axis]);
  int last = std::max(first, slabs.of(r.high[axis]));
  if (last > first && r.high[axis] <= slabs.plane(last)) --last;  // merely touches the next slab
  BuildBox rest = box_of(r);
  int entry = -1;
  for (int k = first; k < last; ++k) {
    const CutReference parts = cutter(rest, axis, slabs.plane(k + 1));
    if (parts.has_left) {
      bins.box[k].add(parts.left);
      if (entry < 0) entry = k;
    }
    if (!parts.has_right) {
      ++bins.entry[entry < 0 ? k : entry], ++bins.exit[k];
      return;
    }
    rest = parts.right;
  }
  bins.box[last].add(rest);
  ++bins.entry[entry < 0 ? last : entry], ++bins.exit[last];
}

struct SpatialBinning {
  Span references;
  std::span<const TriangleCorners> triangles;
  const Slabs* slabs;
  // Buckets of all axes side by side, so that few buckets touch little memory.
  std::vector<BuildBox> boxes;
  std::vector<uint32_t> counts;

  SpatialBinning(Span r, std::span<const TriangleCorners> t, const Slabs* s)
      : references(r), triangles(t), slabs(s), boxes(size_t(3 * s->count)), counts(size_t(6 * s->count)) {}
  SpatialBinning(SpatialBinning& other, tbb::split) : SpatialBinning(other.references, other.triangles, other.slabs) {}
  SlabBins axis(int a) {
    const int n = slabs->count;
    return {&boxes[size_t(a * n)], &counts[size_t(2 * a * n)], &counts[size_t((2 * a + 1) * n)]};
  }
  void operator()(const tbb::blocked_range<uint32_t>& range) {
    const SlabBins bins[3] = {axis(0), axis(1), axis(2)};
    for (uint32_t i = range.begin(); i < range.end(); ++i) {
      const BoxReference& r = references.references[i];
      const Cutter cutter(triangles[r.id]);
      for (int a = 0; a < 3; ++a)
        if (slabs[a].usable()) add_reference(bins[a], slabs[a], r, cutter, a);
    }
  }
  void join(const SpatialBinning& other) {
    for (size_t i = 0; i < boxes.size(); ++i) boxes[i].add(other.boxes[i]);
    for (size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
  }
};

void best_on_axis(const SlabBins& bins, const Slabs& slabs, int axis, uint32_t most, uint32_t block_shift,
                  SpatialSplit& best) {
  BuildBox right_box[most_buckets];
  uint32_t right_count[most_buckets];
  BuildBox box;
  uint32_t count = 0;
  for (int k = slabs.count - 1; k > 0; --k) {
    box.add(bins.box[k]), count += bins.exit[k];
    right_box[k] = box, right_count[k] = count;
  }
  box = {}, count = 0;
  for (int k = 1; k < slabs.count; ++k) {
    box.add(bins.box[k - 1]), count += bins.entry[k - 1];
    if (count == 0 || right_count[k] == 0 || count + right_count[k] > most) continue;
    const float cost = box.half_area() * tests_of(count, block_shift) +
                       right_box[k].half_area() * tests_of(right_count[k], block_shift);
    if (cost < best.cost) best = {axis, slabs.plane(k), cost, count, right_count[k], box, right_box[k]};
  }
}

void write(const BuildBox& box, BoxReference& r) {
  const Aabb b = box.aabb();
  for (int i = 0; i < 3; ++i) r.low[i] = b.min[i], r.high[i] = b.max[i];
}

BuildBox joined(BuildBox a, const BuildBox& b) {
  a.add(b);
  return a;
}

}  // namespace

SpatialSplit find_spatial_split(Span references, std::span<const TriangleCorners> triangles, const BuildBox& box,
                                int buckets, uint32_t block_shift, uint32_t room) {
  const Slabs slabs[3] = {{box, 0, buckets}, {box, 1, buckets}, {box, 2, buckets}};
  SpatialBinning binning(references, triangles, slabs);
  const tbb::blocked_range<uint32_t> all(0, references.count, parallel_binning / 32);
  if (references.count < parallel_binning / 8)
    binning(all);
  else
    tbb::parallel_reduce(all, binning);
  SpatialSplit best;
  for (int a = 0; a < 3; ++a)
    if (slabs[a].usable()) best_on_axis(binning.axis(a), slabs[a], a, references.count + room, block_shift, best);
  return best;
}

SplitCounts apply_spatial_split(BoxReference* references, uint32_t count, uint32_t room,
                                std::span<const TriangleCorners> triangles, const SpatialSplit& split) {
  // The split's own counts and areas decide about unsplitting, as in the paper: they do not change on the way.
  const float left_area = split.left_box.half_area(), right_area = split.right_box.half_area();
  const float both = left_area * float(split.left) + right_area * float(split.right);
  uint32_t low = 0, high = count, end = count;
  while (low < high) {
    BoxReference& r = references[low];
    if (r.high[split.axis] <= split.plane) {
      ++low;
      continue;
    }
    if (r.low[split.axis] >= split.plane) {
      std::swap(r, references[--high]);
      continue;
    }
    const BuildBox whole = box_of(r);
    const CutReference parts = Cutter(triangles[r.id])(whole, split.axis, split.plane);
    bool to_left = !parts.has_right, to_right = !parts.has_left;
    if (!to_left && !to_right) {
      const float left_only =
          joined(split.left_box, whole).half_area() * float(split.left) + right_area * float(split.right - 1);
      const float right_only =
          left_area * float(split.left - 1) + joined(split.right_box, whole).half_area() * float(split.right);
      const bool full = end - count == room;
      if (full || std::min(left_only, right_only) < both) (left_only <= right_only ? to_left : to_right) = true;
    }
    if (to_left) {
      ++low;
    } else if (to_right) {
      std::swap(r, references[--high]);
    } else {
      references[end] = r;
      write(parts.right, references[end++]);
      write(parts.left, r);
      ++low;
    }
  }
  return {low, end - low};
}

}  // namespace candela
