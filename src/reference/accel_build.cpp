#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "bvh/simd.h"
#include "reference/accel_trees.h"
#include "scene/glow.h"

namespace candela {
namespace {

// Geometry of up to this many triangles is cheaper to repeat than to enter.
constexpr size_t small_section = 32;
// What a spatial split takes beyond one by areas, a triangle, over what it saves a ray (bench/results/cpu/rays.json).
constexpr double rays_a_triangle_that_pay = 50;
// Rays are rounded to floats in mesh space. Where that would lose more than a few bits (axes scaled very differently)
// or come near the ends of the float range, the triangles are brought to relative space instead.
constexpr double worst_condition = 1e4, smallest_scale = 1e-6, largest_scale = 1e6;

// By columns and rows: bounds of how far the matrix stretches any direction.
double largest_stretch(const glm::dmat3& m) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += glm::dot(m[c], m[c]);
  return std::sqrt(sum);
}

bool invert(const glm::mat4& m, glm::dmat4x3& inverse) {
  const glm::dmat4 wide(m);
  const glm::dmat3 linear(wide);
  const double determinant = glm::determinant(linear);
  if (!std::isfinite(determinant) || determinant == 0) return false;
  const glm::dmat3 back = glm::inverse(linear);
  const double forth = largest_stretch(linear), there = largest_stretch(back);
  if (!(forth * there <= worst_condition * 3) || !(forth >= smallest_scale && forth <= largest_scale)) return false;
  inverse = glm::dmat4x3(back[0], back[1], back[2], -(back * glm::dvec3(wide[3])));
  return true;
}

// Triangles with their references; those with non-finite corners have none.
struct Soup {
  LargeVector<TriangleCorners> triangles;
  LargeVector<BoxReference> references;

  explicit Soup(size_t count) : triangles(count), references(count) {}
  void fill(size_t first, const MeshSection& section, const std::vector<glm::vec3>& position,
            const glm::mat4* transform) {
    const uint32_t* index = section.index.data();
    // glm's product of a matrix and a point, by its own operations in its order: rays and pictures must agree.
    F4 columns[4];
    for (int c = 0; transform && c < 4; ++c) columns[c] = F4::load(&(*transform)[c].x);
    const auto placed = [&columns](glm::vec3 p) {
      float out[4];
      ((columns[0] * F4::all(p.x) + columns[1] * F4::all(p.y)) + (columns[2] * F4::all(p.z) + columns[3])).store(out);
      return glm::vec3(out[0], out[1], out[2]);
    };
    tbb::parallel_for(tbb::blocked_range<size_t>(0, section.index.size() / 3, 8192), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        TriangleCorners& t = triangles[first + i];
        for (size_t k = 0; k < 3; ++k) {
          const glm::vec3 p = position[index[3 * i + k]];
          t.corner[k] = transform ? placed(p) : p;
        }
        references[first + i] = reference_to(t, uint32_t(first + i));
      }
    });
  }
  size_t drop_non_finite() {
    const auto broken = [&](const BoxReference& r) {
      const TriangleCorners& t = triangles[r.id];
      return !(finite(t.corner[0]) && finite(t.corner[1]) && finite(t.corner[2]));
    };
    const auto kept = std::remove_if(references.begin(), references.end(), broken);
    const size_t dropped = size_t(references.end() - kept);
    references.erase(kept, references.end());
    return dropped;
  }
};

class Assembly {
 public:
  Assembly(Accel::Trees& trees, const AccelOptions& o)
      : trees_(trees),
        options_(o.tree),
        measure_cost_(o.measure_cost),
        repeated_triangles_(o.repeated_triangles),
        rays_(o.rays) {}

  void run() {
    sort_items();
    if (rays_) options_.builder = builder_that_pays(*rays_, double(triangles_to_build()));
    trees_.statistics.builder = options_.builder;
    build_world();
    build_parts();
    build_top();
    count_sizes();
  }

 private:
  using Geometry = std::tuple<uint32_t, uint32_t, int>;  // mesh, section, deformation

  Geometry geometry_of(const DrawItem& item) const { return {item.mesh, item.section, item.deformed}; }

  void sort_items() {
    const std::vector<DrawItem>& items = trees_.frame->items;
    std::map<Geometry, size_t> uses;
    size_t repeated_triangles = 0;
    for (const DrawItem& item : items) {
      const MeshSection& section = trees_.section_of(item);
      if (trees_.is_implicit(item)) continue;
      if (section.topology == Topology::triangles && uses[geometry_of(item)]++ > 0)
        repeated_triangles += section.index.size() / 3;
    }
    const bool instanced = repeated_triangles > repeated_triangles_;
    for (uint32_t i = 0; i < items.size(); ++i) {
      const DrawItem& item = items[i];
      const MeshSection& section = trees_.section_of(item);
      if (trees_.is_implicit(item)) continue;
      if (section.topology != Topology::triangles) {
        ++trees_.statistics.skipped_items;
        continue;
      }
      AccelInstance instance;
      instance.item = i;
      const bool repeated = instanced && !trees_.is_skinned(item) && uses[geometry_of(item)] > 1 &&
                            section.index.size() / 3 > small_section;
      if (repeated && invert(trees_.frame->relative_from_local[item.transform], instance.local_from_relative))
        trees_.instances.push_back(instance);
      else
        singles_.push_back(i);
    }
  }

  size_t triangles_to_build() const {
    size_t count = 0;
    std::set<Geometry> parts;
    for (uint32_t i : singles_) count += trees_.section_of(trees_.frame->items[i]).index.size() / 3;
    for (const AccelInstance& instance : trees_.instances) {
      const DrawItem& item = trees_.frame->items[instance.item];
      if (parts.insert(geometry_of(item)).second) count += trees_.section_of(item).index.size() / 3;
    }
    return count;
  }

  void build_world() {
    size_t count = 0;
    trees_.item_first.assign(trees_.frame->items.size(), 0);
    for (uint32_t i : singles_) {
      trees_.item_first[i] = uint32_t(count);
      count += trees_.section_of(trees_.frame->items[i]).index.size() / 3;
    }
    Soup soup(count);
    trees_.world_item.resize(count);
    const bool mixed_doubts = std::any_of(singles_.begin(), singles_.end(),
                                          [&](uint32_t i) { return turned_doubts(i) != turned_doubts(singles_[0]); });
    if (mixed_doubts) trees_.world_doubts.resize(count);
    if (!singles_.empty()) trees_.world_doubt = turned_doubts(singles_[0]);
    tbb::parallel_for(size_t(0), singles_.size(), [&](size_t s) {
      const DrawItem& item = trees_.frame->items[singles_[s]];
      const MeshSection& section = trees_.section_of(item);
      const size_t first = trees_.item_first[singles_[s]];
      soup.fill(first, section, trees_.positions_of(item),
                trees_.is_skinned(item) ? nullptr : &trees_.frame->relative_from_local[item.transform]);
      std::fill_n(trees_.world_item.begin() + ptrdiff_t(first), section.index.size() / 3, singles_[s]);
      if (mixed_doubts)
        std::fill_n(trees_.world_doubts.begin() + ptrdiff_t(first), section.index.size() / 3,
                    turned_doubts(singles_[s]));
    });
    trees_.world = build(soup);
  }

  // What the filter is asked about, by how corners turn as seen along the ray: in relative space mirrored items have
  // their fronts where others have their backs.
  uint8_t turned_doubts(uint32_t item) const {
    const uint8_t ask = trees_.ask[item];
    return trees_.mirrored[item] ? uint8_t(ask >> 1 | (ask & 1) << 1) : ask;
  }

  void build_parts() {
    std::map<Geometry, uint32_t> parts;
    std::vector<uint32_t> shown_by;  // per part: an item
    for (AccelInstance& instance : trees_.instances) {
      const auto [at, is_new] =
          parts.try_emplace(geometry_of(trees_.frame->items[instance.item]), uint32_t(parts.size()));
      if (is_new) shown_by.push_back(instance.item);
      instance.part = at->second;
    }
    trees_.parts.resize(shown_by.size());
    for (size_t p = 0; p < shown_by.size(); ++p) {
      const DrawItem& item = trees_.frame->items[shown_by[p]];
      const MeshSection& section = trees_.section_of(item);
      Soup soup(section.index.size() / 3);
      soup.fill(0, section, trees_.positions_of(item), nullptr);
      trees_.parts[p].tree = build(soup);
    }
  }

  void build_top() {
    // A ray's origin and direction are rounded once in mesh space, which shifts it by a fraction of the distances it
    // spans.
    DAabb all = trees_.world.nodes.empty() ? DAabb{} : DAabb{trees_.world.bounds.min, trees_.world.bounds.max};
    std::vector<DAabb> boxes;
    for (const AccelInstance& instance : trees_.instances) {
      const Aabb& local = trees_.parts[instance.part].tree.bounds;
      const glm::dmat4 m(trees_.frame->relative_from_local[trees_.frame->items[instance.item].transform]);
      boxes.push_back(local.empty() ? DAabb{} : transformed(DAabb{local.min, local.max}, m));
      all.add(boxes.back());
    }
    const glm::dvec3 reach = all.empty() ? glm::dvec3(0) : glm::max(glm::abs(all.min), glm::abs(all.max));
    const double margin = std::max({reach.x, reach.y, reach.z}) * 0x1p-21;
    std::vector<BoxReference> references;
    for (uint32_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].empty()) continue;
      trees_.instances[i].bounds = {glm::vec3(boxes[i].min - margin), glm::vec3(boxes[i].max + margin)};
      BoxReference r;
      for (int a = 0; a < 3; ++a)
        r.low[a] = trees_.instances[i].bounds.min[a], r.high[a] = trees_.instances[i].bounds.max[a];
      r.id = i, r.unused = 0;
      references.push_back(r);
    }
    BvhOptions options = options_;
    options.max_leaf = 1, options.block_shift = 0, options.node_cost = BvhOptions{}.node_cost;
    trees_.top = collapse(build_tree(references, {}, options), {});
  }

  WideTree build(Soup& soup) {
    trees_.statistics.left_out += soup.drop_non_finite();
    const BinaryTree binary = build_tree(soup.references, soup.triangles, options_);
    trees_.statistics.triangles += soup.references.size();
    trees_.statistics.binary_nodes += binary.node_count;
    if (measure_cost_) trees_.statistics.sah_cost += sah_cost(binary, options_);
    WideTree wide = collapse(binary, soup.triangles);
    trees_.statistics.references += wide.references;
    return wide;
  }

  void count_sizes() {
    AccelStatistics& s = trees_.statistics;
    s.instances = trees_.instances.size();
    const auto add = [&](const WideTree& tree) {
      s.nodes += tree.nodes.size();
      s.bytes += tree.nodes.size() * sizeof(WideNode) + tree.blocks.size() * sizeof(TriangleBlock) +
                 tree.indices.size() * sizeof(uint32_t);
    };
    add(trees_.world), add(trees_.top);
    for (const AccelPart& part : trees_.parts) add(part.tree);
    s.bytes += trees_.instances.size() * sizeof(AccelInstance) + trees_.world_item.size() * sizeof(uint32_t);
  }

  Accel::Trees& trees_;
  BvhOptions options_;
  bool measure_cost_;
  size_t repeated_triangles_;
  std::optional<double> rays_;
  std::vector<uint32_t> singles_;
};

uint8_t doubts_of(const Material* material, bool always, bool open_sides) {
  constexpr uint8_t fronts = 1, backs = 2;
  if (always ||
      (material && (material->alpha_mode != AlphaMode::opaque || material->has_relief() || glows_all_over(*material))))
    return fronts | backs;
  if (material && material->double_sided) return 0;
  return open_sides ? fronts | backs : backs;
}

}  // namespace

BvhBuilder builder_that_pays(double rays, double triangles) {
  return rays >= rays_a_triangle_that_pay * triangles ? BvhBuilder::sbvh : BvhBuilder::sah;
}

Accel::Trees::Trees(const Scene& the_scene, const Pose& pose, const FrameData& the_frame, const AccelOptions& options)
    : scene(&the_scene), frame(&the_frame) {
  const auto begin = std::chrono::steady_clock::now();
  if (options.kernels) kernels = options.kernels;
  if (options.implicit)
    for (uint32_t i = 0; i < frame->items.size(); ++i) {
      const int d = frame->items[i].deformed;
      if (d < 0 || frame->deformations[size_t(d)].body < 0 || frame->deformations[size_t(d)].chunk > 0) continue;
      implicit.push_back({i, MetaballSurface(frame->metaballs[size_t(frame->deformations[size_t(d)].body)])});
    }
  meets_implicit = options.implicit;
  deformed = deform_all(*scene, *frame, !options.implicit);
  for (const DrawItem& item : frame->items) {
    mirrored.push_back(item.mirrored);
    ask.push_back(doubts_of(item.material >= 0 ? &pose.materials[size_t(item.material)] : nullptr,
                            options.always_ask_filter, options.open_sides));
  }
  Assembly(*this, options).run();
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
  statistics.build_ms = taken.count();
}

}  // namespace candela
