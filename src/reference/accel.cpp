#include "reference/accel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "bvh/simd.h"
#include "bvh/triangle.h"
#include "reference/accel_trees.h"
#include "reference/metaballs.h"

namespace candela {
namespace {

// Finite, and of a length that needs no direction_scale.
bool is_usual(const KernelRay& ray) {
  const F4 direction = absolute(F4::load(ray.direction)), origin = absolute(F4::load(ray.origin));
  const uint32_t in_range =
      (less_equal(direction, F4::all(usual_direction_max)) & less_equal(origin, F4::all(0x1p100f))).bits();
  return (in_range & 7u) == 7u && (less_equal(F4::all(usual_direction_min), direction).bits() & 7u) != 0;
}

// Places of KernelSearch: the world tree, then the instances.
constexpr uint32_t world_place = 0, first_instance_place = 1;

// One search through all trees: what the kernels call back.
struct Search : KernelSearch {
  const Accel::Trees& trees;
  const HitFilter* filter;
  TraceCounts* counts;
  const bool any;
  float inverse_scale = 1;  // from the kernels' t to the caller's

  Search(const Accel::Trees& t, const HitFilter* f, TraceCounts* c, bool any_hit)
      : trees(t), filter(f), counts(c), any(any_hit) {
    accept = &accept_hit, loses_tie = &loses_to_best, enter = &enter_instance;
  }

  // Number by number, as take() in trace_kernel.h.
  void resolve(const KernelHit& h, uint32_t in, Hit& hit) const {
    hit.t = h.t * inverse_scale, hit.u = h.u, hit.v = h.v;
    if (in != world_place) {
      // A mirroring transform turns corners and sight alike: in mesh space the front is always counter-clockwise.
      hit.item = trees.instances[in - first_instance_place].item, hit.primitive = h.id, hit.back = h.clockwise;
    } else {
      const uint32_t item = trees.world_item[h.id];
      hit.item = item, hit.primitive = h.id - trees.item_first[item];
      hit.back = h.clockwise != bool(trees.mirrored[item]);
    }
  }

  static bool loses_to_best(KernelSearch& search, const KernelHit& h) {
    const Search& s = static_cast<Search&>(search);
    Hit a, b;
    s.resolve(h, s.place, a), s.resolve(s.best, s.best_place, b);
    return std::tie(a.item, a.primitive) >= std::tie(b.item, b.primitive);
  }

  static bool accept_hit(KernelSearch& search, const KernelHit& h) {
    const Search& s = static_cast<Search&>(search);
    Hit hit;
    s.resolve(h, s.place, hit);
    return s.filter->accepts(hit);
  }

  static bool enter_instance(KernelSearch& search, uint32_t index, KernelRay& ray) {
    Search& s = static_cast<Search&>(search);
    const AccelInstance& instance = s.trees.instances[index];
    const glm::dmat4x3& m = instance.local_from_relative;
    const glm::vec3 origin = m * glm::dvec4(ray.origin[0], ray.origin[1], ray.origin[2], 1.0);
    const glm::vec3 direction = m * glm::dvec4(ray.direction[0], ray.direction[1], ray.direction[2], 0.0);
    if (!finite(origin) || !finite(direction) || direction == glm::vec3(0)) return false;
    KernelRay local{{origin.x, origin.y, origin.z}, ray.t_min, {direction.x, direction.y, direction.z}, ray.t_max};
    s.place = index + first_instance_place;
    const bool ended = s.run(s.trees.parts[instance.part].tree, local, nullptr, s.trees.ask[instance.item]);
    const bool nearer = local.t_max < ray.t_max || s.best_place == s.place;
    ray.t_max = local.t_max;
    return s.any ? ended : nearer;
  }

  KernelTree kernel_tree(const WideTree& tree, const uint8_t* doubts, uint8_t doubt) const {
    KernelTree t{tree.nodes.data(), tree.blocks.data(), tree.indices.data()};
    if (filter) t.doubts = doubts, t.doubt = doubt;
    if (place == world_place) t.wanted = trees.world_item.data();
    return t;
  }

  bool run(const WideTree& tree, KernelRay& ray, const uint8_t* doubts, uint8_t doubt) {
    if (tree.nodes.empty()) return false;
    const KernelTree t = kernel_tree(tree, doubts, doubt);
    return tree.indices.empty() ? trees.kernels->triangles(t, ray, *this, any, counts)
                                : trees.kernels->things(t, ray, *this, any, counts);
  }

  // False: it is no ray, or too short to hit anything.
  bool begin(const Ray& from, KernelRay& ray) {
    ray = {{from.origin.x, from.origin.y, from.origin.z},
           from.t_min,
           {from.direction.x, from.direction.y, from.direction.z},
           from.t_max};
    if (!(from.t_min <= from.t_max)) return false;
    if (!is_usual(ray)) {
      if (!finite(from.origin) || !finite(from.direction)) return false;
      const float scale = direction_scale(from.direction);
      if (!(scale > 0)) return false;
      for (float& d : ray.direction) d /= scale;
      ray.t_min *= scale, ray.t_max *= scale, inverse_scale = 1.0f / scale;
    }
    return true;
  }

  bool trace(const Ray& from) {
    KernelRay ray;
    return begin(from, ray) && (run(trees.world, ray, world_doubts(), trees.world_doubt) || in_instances(ray));
  }

  // After a search of the world tree that has not ended.
  bool in_instances(KernelRay& ray) { return run(trees.top, ray, nullptr, 0) || best.id != no_triangle; }

  const uint8_t* world_doubts() const { return trees.world_doubts.empty() ? nullptr : trees.world_doubts.data(); }
};

// Searches of rays side by side, packet by packet: take(i, search, met) has what each found.
template <class Take>
void trace_packets(const Accel::Trees& trees, std::span<const Ray> rays, const HitFilter* filter, bool any,
                   Take&& take) {
  for (size_t first = 0; first < rays.size(); first += packet_rays) {
    const size_t count = std::min(rays.size() - first, size_t(packet_rays));
    std::array<std::optional<Search>, packet_rays> searches;
    KernelSearch* started[packet_rays];
    KernelRay kernel_rays[packet_rays];
    uint32_t lanes = 0, ended = 0;
    for (size_t i = 0; i < count; ++i) {
      started[i] = &searches[i].emplace(trees, filter, nullptr, any);
      lanes |= uint32_t(searches[i]->begin(rays[first + i], kernel_rays[i])) << i;
    }
    if (lanes != 0 && !trees.world.nodes.empty())
      ended =
          trees.kernels->packet(searches[0]->kernel_tree(trees.world, searches[0]->world_doubts(), trees.world_doubt),
                                kernel_rays, started, lanes, any);
    for (size_t i = 0; i < count; ++i)
      take(first + i, *searches[i],
           (ended >> i & 1u) || ((lanes >> i & 1u) && searches[i]->in_instances(kernel_rays[i])));
  }
}

// The nearest accepted crossing of an implicit surface before `best`; any: the first accepted at all.
void meet_implicit(const Accel::Trees& trees, const Ray& ray, const HitFilter* filter, bool any,
                   std::optional<Hit>& best) {
  if (!finite(ray.origin) || !finite(ray.direction) || !(ray.t_min <= ray.t_max)) return;
  const glm::dvec3 origin(ray.origin), direction(ray.direction);
  for (const Accel::Trees::Implicit& body : trees.implicit) {
    body.surface.each_crossing(origin, direction, [&](double t, bool goes_in) {
      Hit hit;
      hit.t = float(t), hit.item = body.item, hit.back = !goes_in;
      if (hit.t < ray.t_min) return false;
      // Those that follow are farther still.
      if (hit.t > ray.t_max || (best && std::tie(best->t, best->item) <= std::tie(hit.t, hit.item))) return true;
      hit.point = origin + t * direction;
      if (filter && !filter->accepts(hit)) return false;
      best = hit;
      return true;
    });
    if (any && best) return;
  }
}

float largest_of(glm::vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

Accel::Accel(const Scene& scene, const Pose& pose, const FrameData& frame, const AccelOptions& options)
    : trees_(std::make_unique<Trees>(scene, pose, frame, options)) {}
Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;
Accel& Accel::operator=(Accel&&) noexcept = default;

std::optional<Hit> Accel::closest(const Ray& ray, const HitFilter* filter, TraceCounts* counts) const {
  Search search(*trees_, filter, counts, false);
  std::optional<Hit> hit;
  if (search.trace(ray)) search.resolve(search.best, search.best_place, hit.emplace());
  if (!trees_->implicit.empty()) meet_implicit(*trees_, ray, filter, false, hit);
  return hit;
}

bool Accel::occluded(const Ray& ray, const HitFilter* filter, TraceCounts* counts) const {
  if (Search(*trees_, filter, counts, true).trace(ray)) return true;
  std::optional<Hit> hit;
  if (!trees_->implicit.empty()) meet_implicit(*trees_, ray, filter, true, hit);
  return hit.has_value();
}

void Accel::closest(std::span<const Ray> rays, std::span<std::optional<Hit>> hits, const HitFilter* filter) const {
  trace_packets(*trees_, rays, filter, false, [&](size_t i, const Search& search, bool met) {
    hits[i].reset();
    if (met) search.resolve(search.best, search.best_place, hits[i].emplace());
    if (!trees_->implicit.empty()) meet_implicit(*trees_, rays[i], filter, false, hits[i]);
  });
}

void Accel::occluded(std::span<const Ray> rays, std::span<bool> blocked, const HitFilter* filter) const {
  trace_packets(*trees_, rays, filter, true, [&](size_t i, const Search&, bool met) {
    std::optional<Hit> hit;
    if (!met && !trees_->implicit.empty()) meet_implicit(*trees_, rays[i], filter, true, hit);
    blocked[i] = met || hit;
  });
}

PosedTriangle Accel::triangle(uint32_t item_index, uint32_t primitive) const {
  const DrawItem& item = trees_->frame->items[item_index];
  const MeshSection& section = trees_->section_of(item);
  const std::vector<glm::vec3>& position = trees_->positions_of(item);
  const bool relative = trees_->is_skinned(item);
  PosedTriangle out;
  for (size_t k = 0; k < 3; ++k) {
    out.vertex[k] = section.index[3 * size_t(primitive) + k];
    const glm::vec3 p = position[out.vertex[k]];
    out.position[k] = relative ? p : glm::vec3(trees_->frame->relative_from_local[item.transform] * glm::vec4(p, 1.0f));
  }
  return out;
}

const MetaballSurface* Accel::implicit(uint32_t item) const {
  for (const Trees::Implicit& body : trees_->implicit)
    if (body.item == item) return &body.surface;
  return nullptr;
}

SurfacePoint Accel::surface(const Hit& hit) const {
  if (const MetaballSurface* body = implicit(hit.item)) {
    SurfacePoint out;
    out.position = hit.point;
    out.geometric_normal = glm::vec3(body->geometric_normal(glm::dvec3(hit.point)));
    // Rounding of the point and of the ray's origin.
    out.error_m = 16 * largest_of(hit.point) * 0x1p-24f;
    return out;
  }
  const DrawItem& item = trees_->frame->items[hit.item];
  const auto p = triangle(hit.item, hit.primitive).position;
  SurfacePoint out;
  out.position = (1.0f - hit.u - hit.v) * p[0] + hit.u * p[1] + hit.v * p[2];
  const glm::dvec3 a(p[0]), n = glm::cross(glm::dvec3(p[1]) - a, glm::dvec3(p[2]) - a);
  const double length = glm::length(n);
  if (length > 0) out.geometric_normal = glm::vec3((item.mirrored ? -n : n) / length);
  // Roundings of the point (four sums of products), of this triangle as the next ray sees it (corners less origin,
  // shear, products) and of the sum in leaving_origin, all in units of the largest coordinate at hand.
  float reach = std::max({largest_of(p[0]), largest_of(p[1]), largest_of(p[2])});
  if (!trees_->is_skinned(item)) {
    // An instance sees the ray in mesh space, rounded there; the transform's translation may cancel.
    const glm::mat4& m = trees_->frame->relative_from_local[item.transform];
    const glm::vec3 local = trees_->positions_of(item)[trees_->section_of(item).index[3 * size_t(hit.primitive)]];
    glm::vec3 sum = glm::abs(glm::vec3(m[3]));
    for (int c = 0; c < 3; ++c) sum += glm::abs(glm::vec3(m[c]) * local[c]);
    reach = std::max(reach, largest_of(sum));
  }
  // Rounded corners tilt a thin triangle's plane: by their rounding over its width, at a distance of its length.
  const glm::dvec3 e0 = glm::dvec3(p[1]) - a, e1 = glm::dvec3(p[2]) - a, e2 = e1 - e0;
  const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
  const double thinness = length > 0 ? std::min(longest2 / length, 1000.0) : 1000.0;
  out.error_m = (16 * reach + 4 * float(std::sqrt(longest2) * thinness)) * 0x1p-24f;
  return out;
}

const DeformedVertices& Accel::deformed(int deformation) const { return trees_->deformed[size_t(deformation)]; }

const AccelStatistics& Accel::statistics() const { return trees_->statistics; }

std::vector<LeafBox> Accel::leaves() const {
  std::vector<LeafBox> out;
  const auto add = [&](const WideTree& tree, const glm::dmat4& relative_from_tree) {
    struct Place {
      uint32_t node, depth;
    };
    std::vector<Place> stack;
    if (!tree.nodes.empty()) stack.push_back({0, 1});
    while (!stack.empty()) {
      const Place at = stack.back();
      stack.pop_back();
      const WideNode& node = tree.nodes[at.node];
      for (uint32_t c = 0; c < wide_children; ++c) {
        if (node.child[c] == no_child) continue;
        if (!(node.child[c] & leaf_bit)) {
          stack.push_back({node.child[c], at.depth + 1});
          continue;
        }
        const DAabb box{{node.bounds[0][c], node.bounds[2][c], node.bounds[4][c]},
                        {node.bounds[1][c], node.bounds[3][c], node.bounds[5][c]}};
        const DAabb placed = transformed(box, relative_from_tree);
        LeafBox leaf{{glm::vec3(placed.min), glm::vec3(placed.max)}, 0, at.depth};
        const uint32_t first = first_of_leaf(node.child[c]);
        for (uint32_t b = first; b < first + count_of_leaf(node.child[c]); ++b)
          for (uint32_t id : tree.blocks[b].id) leaf.triangles += id != no_triangle;
        out.push_back(leaf);
      }
    }
  };
  add(trees_->world, glm::dmat4(1.0));
  for (const AccelInstance& instance : trees_->instances)
    add(trees_->parts[instance.part].tree,
        glm::dmat4(trees_->frame->relative_from_local[trees_->frame->items[instance.item].transform]));
  return out;
}

glm::vec3 leaving_origin(const SurfacePoint& point, glm::vec3 direction) {
  const float side = glm::dot(direction, point.geometric_normal) < 0 ? -1.0f : 1.0f;
  return point.position + (side * point.error_m) * point.geometric_normal;
}

}  // namespace candela
