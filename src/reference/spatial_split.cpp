#include "reference/spatial_split.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace candela {
namespace {

constexpr int most_buckets = 64;

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

struct Bins {
  BuildBox box[most_buckets];
  uint32_t entry[most_buckets] = {}, exit[most_buckets] = {};
};

void add_reference(Bins& bins, const Slabs& slabs, const BoxReference& r, const TriangleCorners& triangle, int axis) {
  const int first = slabs.of(r.low[axis]);
  int last = std::max(first, slabs.of(r.high[axis]));
  if (last > first && r.high[axis] <= slabs.plane(last)) --last;  // merely touches the next slab
  BuildBox rest = box_of(r);
  int begin = -1;
  for (int k = first; k < last; ++k) {
    const CutReference parts = cut(rest, triangle, axis, slabs.plane(k + 1));
    if (parts.has_left) {
      bins.box[k].add(parts.left);
      if (begin < 0) begin = k;
    }
    if (!parts.has_right) {
      last = k;
      break;
    }
    rest = parts.right;
    if (k + 1 == last) bins.box[last].add(rest);
  }
  if (first == last) bins.box[first].add(rest);
  ++bins.entry[begin < 0 ? last : begin];
  ++bins.exit[last];
}

struct AxisBins {
  Bins axis[3];
};

struct SpatialBinning {
  Span references;
  std::span<const TriangleCorners> triangles;
  const Slabs* slabs;
  std::unique_ptr<AxisBins> bins = std::make_unique<AxisBins>();

  SpatialBinning(Span r, std::span<const TriangleCorners> t, const Slabs* s) : references(r), triangles(t), slabs(s) {}
  SpatialBinning(SpatialBinning& other, tbb::split) : SpatialBinning(other.references, other.triangles, other.slabs) {}
  void operator()(const tbb::blocked_range<uint32_t>& range) {
    for (uint32_t i = range.begin(); i < range.end(); ++i)
      for (int a = 0; a < 3; ++a)
        if (slabs[a].usable())
          add_reference(bins->axis[a], slabs[a], references.references[i], triangles[references.references[i].id], a);
  }
  void join(const SpatialBinning& other) {
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < slabs[a].count; ++k) {
        bins->axis[a].box[k].add(other.bins->axis[a].box[k]);
        bins->axis[a].entry[k] += other.bins->axis[a].entry[k];
        bins->axis[a].exit[k] += other.bins->axis[a].exit[k];
      }
  }
};

void best_on_axis(const Bins& bins, const Slabs& slabs, int axis, uint32_t most, SpatialSplit& best) {
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
    const float cost = box.half_area() * float(count) + right_box[k].half_area() * float(right_count[k]);
    if (cost < best.cost) best = {axis, slabs.plane(k), cost, count, right_count[k], box, right_box[k]};
  }
}

bool valid(const BuildBox& b) { return (less_equal(b.low, b.high) & 7u) == 7u; }

void write(const BuildBox& box, BoxReference& r) {
  const Aabb b = box.aabb();
  for (int i = 0; i < 3; ++i) r.low[i] = b.min[i], r.high[i] = b.max[i];
}

BuildBox joined(BuildBox a, const BuildBox& b) {
  a.add(b);
  return a;
}

}  // namespace

CutReference cut(const BuildBox& reference, const TriangleCorners& triangle, int axis, float plane) {
  CutReference out;
  for (int i = 0; i < 3; ++i) {
    const glm::vec3& p = triangle.corner[i];
    const glm::vec3& q = triangle.corner[(i + 1) % 3];
    const float from = p[axis], to = q[axis];
    const float p4[4] = {p.x, p.y, p.z, 0}, q4[4] = {q.x, q.y, q.z, 0};
    const F4 at = F4::load(p4), next = F4::load(q4);
    if (from <= plane) out.left.add(at, at);
    if (from >= plane) out.right.add(at, at);
    if ((from < plane && to > plane) || (from > plane && to < plane)) {
      // Rounding: of the parameter, which moves the point along the edge, and of the point itself.
      const float s = (plane - from) / (to - from);
      const F4 along = next - at, point = at + along * F4::all(s);
      const F4 slack = (absolute(along) + max(absolute(at), absolute(next))) * F4::all(4 * 0x1p-24f);
      out.left.add(point - slack, point + slack);
      out.right.add(point - slack, point + slack);
    }
  }
  const F4 margin = F4::all(rounding_margin(triangle));
  out.left = {out.left.low - margin, out.left.high + margin};
  out.right = {out.right.low - margin, out.right.high + margin};
  float high[4], low[4];
  out.left.high.store(high), out.right.low.store(low);
  high[axis] = std::min(high[axis], plane), low[axis] = std::max(low[axis], plane);
  out.left = {max(out.left.low, reference.low), min(F4::load(high), reference.high)};
  out.right = {max(F4::load(low), reference.low), min(out.right.high, reference.high)};
  out.has_left = valid(out.left), out.has_right = valid(out.right);
  return out;
}

SpatialSplit find_spatial_split(Span references, std::span<const TriangleCorners> triangles, const BuildBox& box,
                                int buckets, uint32_t room) {
  const Slabs slabs[3] = {{box, 0, buckets}, {box, 1, buckets}, {box, 2, buckets}};
  SpatialBinning binning(references, triangles, slabs);
  const tbb::blocked_range<uint32_t> all(0, references.count, parallel_binning / 32);
  if (references.count < parallel_binning / 8)
    binning(all);
  else
    tbb::parallel_reduce(all, binning);
  SpatialSplit best;
  for (int a = 0; a < 3; ++a)
    if (slabs[a].usable()) best_on_axis(binning.bins->axis[a], slabs[a], a, references.count + room, best);
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
    const CutReference parts = cut(whole, triangles[r.id], split.axis, split.plane);
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
