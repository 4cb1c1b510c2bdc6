#include "reference/accel.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>

#include "reference/triangle.h"

namespace candela {
namespace {

struct Corner3 {
  std::array<glm::vec3, 3> p;
  uint32_t item, primitive;
};
struct TreeNode {
  Aabb box;
  uint32_t first = 0, count = 0;  // count 0: children first and first + 1
};

bool finite(glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

struct Accel::Trees {
  const Scene* scene = nullptr;
  const FrameData* frame = nullptr;
  std::vector<DeformedVertices> deformed;
  std::vector<uint8_t> ask;  // per item: 1 front, 2 back
  std::vector<Corner3> triangles;
  std::vector<TreeNode> nodes;
  AccelStatistics statistics;

  const MeshSection& section(const DrawItem& item) const { return scene->meshes[item.mesh].sections[item.section]; }

  PosedTriangle posed(uint32_t item_index, uint32_t primitive) const {
    const DrawItem& item = frame->items[item_index];
    const MeshSection& s = section(item);
    PosedTriangle out;
    const bool skinned = item.deformed >= 0 && frame->deformations[size_t(item.deformed)].joint_count > 0;
    const std::vector<glm::vec3>& position = item.deformed >= 0 ? deformed[size_t(item.deformed)].position : s.position;
    for (size_t i = 0; i < 3; ++i) {
      out.vertex[i] = s.index[3 * size_t(primitive) + i];
      const glm::vec3 p = position[out.vertex[i]];
      out.position[i] = skinned ? p : glm::vec3(frame->relative_from_local[item.transform] * glm::vec4(p, 1.0f));
    }
    return out;
  }

  void split(uint32_t n) {
    TreeNode& node = nodes[n];
    Aabb centres;
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      Aabb b;
      for (glm::vec3 p : triangles[i].p) b.add(p);
      node.box.add(b);
      centres.add(b.centre());
    }
    if (node.count <= 4) return;
    const glm::vec3 size = centres.max - centres.min;
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const auto key = [axis](const Corner3& c) {
      return std::min({c.p[0][axis], c.p[1][axis], c.p[2][axis]}) + std::max({c.p[0][axis], c.p[1][axis], c.p[2][axis]});
    };
    const uint32_t first = node.first, count = node.count, half = count / 2;
    std::nth_element(triangles.begin() + first, triangles.begin() + first + half, triangles.begin() + first + count,
                     [&](const Corner3& a, const Corner3& b) { return key(a) < key(b); });
    const uint32_t child = uint32_t(nodes.size());
    node.first = child, node.count = 0;
    nodes.push_back({{}, first, half});
    nodes.push_back({{}, first + half, count - half});
    split(child), split(child + 1);
  }

  bool slab(const Aabb& box, const Ray& ray, glm::vec3 inverse, float t_max) const {
    float near = ray.t_min, far = t_max;
    for (int i = 0; i < 3; ++i) {
      const float a = (box.min[i] - ray.origin[i]) * inverse[i], b = (box.max[i] - ray.origin[i]) * inverse[i];
      near = std::fmax(near, inverse[i] >= 0 ? a : b), far = std::fmin(far, inverse[i] >= 0 ? b : a);
    }
    return near <= far * 1.000001f;
  }

  bool trace(const Ray& ray, const HitFilter* filter, TraceCounts* counts, bool any, Hit& best) const {
    if (nodes.empty() || !finite(ray.origin) || !finite(ray.direction) || ray.direction == glm::vec3(0)) return false;
    const RayShear shear = shear_of(ray.direction);
    const glm::vec3 inverse = 1.0f / ray.direction;
    bool found = false;
    float t_max = ray.t_max;
    uint32_t stack[256], top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const TreeNode& node = nodes[stack[--top]];
      if (counts) ++counts->boxes;
      if (!slab(node.box, ray, inverse, t_max)) continue;
      if (node.count == 0) {
        if (counts) ++counts->nodes;
        stack[top++] = node.first, stack[top++] = node.first + 1;
        continue;
      }
      for (uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Corner3& c = triangles[i];
        TriangleHit h;
        if (counts) ++counts->triangles;
        if (!meet_triangle(shear, ray.origin, c.p[0], c.p[1], c.p[2], ray.t_min, t_max, h)) continue;
        const bool back = h.clockwise != frame->items[c.item].mirrored;
        const Hit hit{h.t, h.u, h.v, c.item, c.primitive, back};
        if (found && h.t == best.t && std::tie(c.item, c.primitive) >= std::tie(best.item, best.primitive)) continue;
        if (filter && (ask[c.item] & (back ? 2 : 1)) && !filter->accepts(hit)) continue;
        best = hit, t_max = h.t, found = true;
        if (any) return true;
      }
    }
    return found;
  }
};

Accel::Accel(const Scene& scene, const Pose& pose, const FrameData& frame, const AccelOptions& options)
    : trees_(std::make_unique<Trees>()) {
  const auto begin = std::chrono::steady_clock::now();
  Trees& t = *trees_;
  t.scene = &scene, t.frame = &frame;
  for (const Deformation& d : frame.deformations) t.deformed.push_back(deform_vertices(scene, frame, d));
  for (uint32_t i = 0; i < frame.items.size(); ++i) {
    const DrawItem& item = frame.items[i];
    const Material* m = item.material >= 0 ? &pose.materials[size_t(item.material)] : nullptr;
    const bool doubtful = options.always_ask_filter || (m && m->alpha_mode != AlphaMode::opaque);
    t.ask.push_back(doubtful ? 3 : m && m->double_sided ? 0 : 2);
    const MeshSection& s = t.section(item);
    if (s.topology != Topology::triangles) {
      ++t.statistics.skipped_items;
      continue;
    }
    for (uint32_t k = 0; k < s.index.size() / 3; ++k) {
      const PosedTriangle p = t.posed(i, k);
      if (finite(p.position[0]) && finite(p.position[1]) && finite(p.position[2]))
        t.triangles.push_back({p.position, i, k});
      else
        ++t.statistics.left_out;
    }
  }
  t.statistics.triangles = t.statistics.references = t.triangles.size();
  if (!t.triangles.empty()) {
    t.nodes.reserve(t.triangles.size() + 2);
    t.nodes.push_back({{}, 0, uint32_t(t.triangles.size())});
    t.split(0);
  }
  t.statistics.nodes = t.nodes.size();
  t.statistics.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;
Accel& Accel::operator=(Accel&&) noexcept = default;

std::optional<Hit> Accel::closest(const Ray& ray, const HitFilter* filter, TraceCounts* counts) const {
  Hit hit;
  if (!trees_->trace(ray, filter, counts, false, hit)) return {};
  return hit;
}

bool Accel::occluded(const Ray& ray, const HitFilter* filter, TraceCounts* counts) const {
  Hit hit;
  return trees_->trace(ray, filter, counts, true, hit);
}

PosedTriangle Accel::triangle(uint32_t item, uint32_t primitive) const { return trees_->posed(item, primitive); }

SurfacePoint Accel::surface(const Hit& hit) const {
  const DrawItem& item = trees_->frame->items[hit.item];
  const auto p = trees_->posed(hit.item, hit.primitive).position;
  SurfacePoint out;
  out.position = (1.0f - hit.u - hit.v) * p[0] + hit.u * p[1] + hit.v * p[2];
  const glm::dvec3 a(p[0]), n = glm::cross(glm::dvec3(p[1]) - a, glm::dvec3(p[2]) - a);
  const double length = glm::length(n);
  if (length > 0) out.geometric_normal = glm::vec3((item.mirrored ? -n : n) / length);
  float reach = 0;
  for (glm::vec3 q : p) reach = std::max({reach, std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  out.error_m = reach * 32 * 0x1p-24f;
  return out;
}

const DeformedVertices& Accel::deformed(int deformation) const { return trees_->deformed[size_t(deformation)]; }

std::vector<LeafBox> Accel::leaves() const {
  std::vector<LeafBox> out;
  for (const TreeNode& n : trees_->nodes)
    if (n.count > 0) out.push_back({n.box, n.count, 0});
  return out;
}

const AccelStatistics& Accel::statistics() const { return trees_->statistics; }

glm::vec3 leaving_origin(const SurfacePoint& point, glm::vec3 direction) {
  const float side = glm::dot(direction, point.geometric_normal) < 0 ? -1.0f : 1.0f;
  return point.position + (side * point.error_m) * point.geometric_normal;
}

}  // namespace candela
