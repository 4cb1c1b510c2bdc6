#include "gltf/mikktspace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "gltf/vertex_remap.h"

// Tangent spaces as Mikkelsen defines them ("Simulation of Wrinkled Surfaces Revisited", 2008, section 3.7), so that a
// normal map baked with any tool that follows him is read with the same frame: corners that agree in position, normal
// and texture coordinate are one vertex; around a vertex, triangles that are joined by edges and have the same
// orientation of their texture coordinates form a group; a group has one tangent, the mean of its triangles' directions
// of growing u, each projected into the plane of the vertex normal, weighted by the triangle's angle there.
namespace candela {
namespace {

constexpr uint32_t none = ~0u;

struct Triangle {
  std::array<uint32_t, 3> vertex;                       // welded
  std::array<uint32_t, 3> neighbour{none, none, none};  // across the edge from corner i to i + 1
  std::array<uint32_t, 3> group{none, none, none};      // of each corner
  glm::dvec3 along_u{0};                                // direction of growing u on the surface
  bool keeps_orientation = false;                       // texture coordinates run counter-clockwise with the corners
  bool any_orientation = true;  // no area in texture space: joins whichever group reaches it first
  bool degenerate = false;      // two corners in one place: has no say, and takes what its neighbours have
};

struct Group {
  uint32_t vertex;
  bool keeps_orientation;
  glm::dvec3 tangent{0};
};

class TangentSpaces {
 public:
  TangentSpaces(const MeshSection& section, const std::vector<glm::vec2>& uv) : section_(section), uv_(uv) {}

  // One tangent for each corner of each triangle.
  std::vector<glm::vec4> corners() {
    weld();
    measure();
    connect();
    form_groups();
    average();
    return read_out();
  }

 private:
  const glm::vec3& position(uint32_t v) const { return section_.position[v]; }

  int compare(uint32_t a, uint32_t b) const {
    const auto order = [](const auto& x, const auto& y) {
      for (int i = 0; i < int(x.length()); ++i)
        if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
      return 0;
    };
    if (const int p = order(section_.position[a], section_.position[b])) return p;
    if (const int n = order(section_.normal[a], section_.normal[b])) return n;
    return order(uv_[a], uv_[b]);
  }

  // Gives vertices that agree in position, normal and texture coordinate the lowest index among them.
  void weld() {
    std::vector<uint32_t> sorted(section_.position.size()), welded(sorted.size());
    std::iota(sorted.begin(), sorted.end(), 0u);
    std::sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) {
      const int order = compare(a, b);
      return order ? order < 0 : a < b;
    });
    for (size_t i = 0; i < sorted.size(); ++i)
      welded[sorted[i]] = i > 0 && compare(sorted[i - 1], sorted[i]) == 0 ? welded[sorted[i - 1]] : sorted[i];
    triangles_.resize(section_.index.size() / 3);
    for (size_t t = 0; t < triangles_.size(); ++t)
      for (size_t c = 0; c < 3; ++c) triangles_[t].vertex[c] = welded[section_.index[3 * t + c]];
  }

  void measure() {
    for (Triangle& t : triangles_) {
      const glm::vec3 &p0 = position(t.vertex[0]), &p1 = position(t.vertex[1]), &p2 = position(t.vertex[2]);
      t.degenerate = p0 == p1 || p1 == p2 || p2 == p0;
      const glm::dvec2 s1 = glm::dvec2(uv_[t.vertex[1]]) - glm::dvec2(uv_[t.vertex[0]]);
      const glm::dvec2 s2 = glm::dvec2(uv_[t.vertex[2]]) - glm::dvec2(uv_[t.vertex[0]]);
      const glm::dvec3 d1 = glm::dvec3(p1) - glm::dvec3(p0), d2 = glm::dvec3(p2) - glm::dvec3(p0);
      const double area = s1.x * s2.y - s1.y * s2.x;
      t.keeps_orientation = area > 0;
      const glm::dvec3 u = d1 * s2.y - d2 * s1.y, v = d2 * s1.x - d1 * s2.x;
      if (!(std::abs(area) > std::numeric_limits<float>::min()) || !(glm::length(u) > 0) || !(glm::length(v) > 0))
        continue;
      t.any_orientation = false;
      t.along_u = glm::normalize(u) * (t.keeps_orientation ? 1.0 : -1.0);
    }
  }

  // Joins two triangles where one runs along an edge and the other against it; of more than two, the first that fit.
  void connect() {
    struct Edge {
      uint32_t low, high, triangle;
      uint8_t corner;
      bool forward;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles_.size());
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      if (triangles_[t].degenerate) continue;
      for (uint8_t c = 0; c < 3; ++c) {
        const uint32_t a = triangles_[t].vertex[c], b = triangles_[t].vertex[(c + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t, c, a < b});
      }
    }
    const auto key = [](const Edge& e) { return std::make_tuple(e.low, e.high, e.forward, e.triangle); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
    for (size_t first = 0; first < edges.size();) {
      size_t middle = first, last = first;
      while (last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high)
        middle += !edges[last++].forward;
      for (size_t a = first, b = middle; a < middle && b < last; ++a, ++b) {
        triangles_[edges[a].triangle].neighbour[edges[a].corner] = edges[b].triangle;
        triangles_[edges[b].triangle].neighbour[edges[b].corner] = edges[a].triangle;
      }
      first = last;
    }
  }

  void form_groups() {
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& triangle = triangles_[t];
      if (triangle.degenerate || triangle.any_orientation) continue;
      for (uint32_t c = 0; c < 3; ++c)
        if (triangle.group[c] == none) grow_group(t, triangle.vertex[c]);
    }
  }

  // Takes in what can be reached around the vertex, from triangle to triangle.
  void grow_group(uint32_t first_triangle, uint32_t vertex) {
    const uint32_t group = uint32_t(groups_.size());
    groups_.push_back({vertex, triangles_[first_triangle].keeps_orientation});
    pending_.assign(1, first_triangle);
    while (!pending_.empty()) {
      const uint32_t t = pending_.back();
      pending_.pop_back();
      if (t == none || !join(triangles_[t], group)) continue;
      const Triangle& triangle = triangles_[t];
      const size_t corner = corner_of(triangle, vertex);
      pending_.push_back(triangle.neighbour[(corner + 2) % 3]);
      pending_.push_back(triangle.neighbour[corner]);
    }
  }

  static size_t corner_of(const Triangle& triangle, uint32_t vertex) {
    return size_t(std::find(triangle.vertex.begin(), triangle.vertex.end(), vertex) - triangle.vertex.begin());
  }

  bool join(Triangle& triangle, uint32_t group) {
    const size_t corner = corner_of(triangle, groups_[group].vertex);
    if (corner == 3 || triangle.group[corner] != none) return false;
    const bool untouched = triangle.group == std::array<uint32_t, 3>{none, none, none};
    if (triangle.any_orientation && untouched) triangle.keeps_orientation = groups_[group].keeps_orientation;
    if (triangle.keeps_orientation != groups_[group].keeps_orientation) return false;
    triangle.group[corner] = group;
    return true;
  }

  void average() {
    for (const Triangle& triangle : triangles_) {
      if (triangle.degenerate || triangle.any_orientation) continue;
      for (size_t c = 0; c < 3; ++c)
        if (triangle.group[c] != none) add_to_group(triangle, c, groups_[triangle.group[c]]);
    }
  }

  void add_to_group(const Triangle& triangle, size_t corner, Group& group) const {
    const glm::dvec3 n = normal(group.vertex);
    const auto in_plane = [&](glm::dvec3 v) { return unit_or_zero(v - n * glm::dot(n, v)); };
    const glm::dvec3 p(position(triangle.vertex[corner]));
    const glm::dvec3 a = in_plane(glm::dvec3(position(triangle.vertex[(corner + 1) % 3])) - p);
    const glm::dvec3 b = in_plane(glm::dvec3(position(triangle.vertex[(corner + 2) % 3])) - p);
    const double angle = std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
    group.tangent += in_plane(triangle.along_u) * angle;
  }

  glm::dvec3 normal(uint32_t v) const { return unit_or_zero(glm::dvec3(section_.normal[v])); }

  static glm::dvec3 unit_or_zero(glm::dvec3 v) {
    const double length = glm::length(v);
    return length > 1e-30 && std::isfinite(length) ? v / length : glm::dvec3(0);
  }

  // Something finite and perpendicular to the normal where texture coordinates tell nothing.
  glm::dvec3 perpendicular(uint32_t v) const {
    const glm::dvec3 n = normal(v);
    const glm::dvec3 axis = std::abs(n.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return unit_or_zero(axis - n * glm::dot(n, axis));
  }

  // The bitangent's sign: glTF counts v downwards in the image, the method upwards, hence -1 where orientation is kept.
  glm::vec4 tangent_of(const Group& group) const {
    glm::dvec3 t = unit_or_zero(group.tangent);
    if (t == glm::dvec3(0)) t = perpendicular(group.vertex);
    return glm::vec4(glm::vec3(t), group.keeps_orientation ? -1.0f : 1.0f);
  }

  std::vector<glm::vec4> read_out() const {
    std::vector<uint32_t> group_at(section_.position.size(), none);  // any group of a welded vertex
    for (uint32_t g = uint32_t(groups_.size()); g-- > 0;) group_at[groups_[g].vertex] = g;
    std::vector<glm::vec4> result(3 * triangles_.size());
    for (size_t t = 0; t < triangles_.size(); ++t) {
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t v = triangles_[t].vertex[c];
        const uint32_t own = triangles_[t].group[c], group = own != none ? own : group_at[v];
        result[3 * t + c] = group != none ? tangent_of(groups_[group]) : glm::vec4(glm::vec3(perpendicular(v)), 1.0f);
      }
    }
    return result;
  }

  const MeshSection& section_;
  const std::vector<glm::vec2>& uv_;
  std::vector<Triangle> triangles_;
  std::vector<Group> groups_;
  std::vector<uint32_t> pending_;
};

// Gives each vertex its tangent, and corners with another tangent a copy of the vertex.
void assign_tangents(MeshSection& section, const std::vector<glm::vec4>& corners) {
  const size_t old_count = section.position.size();
  std::vector<uint32_t> source(old_count), next(old_count, none);  // next: another copy of the same vertex
  std::iota(source.begin(), source.end(), 0u);
  std::vector<glm::vec4> tangent(old_count, glm::vec4(0));  // 0: not given yet
  for (size_t i = 0; i < corners.size(); ++i) {
    uint32_t v = section.index[i];
    while (tangent[v] != glm::vec4(0) && tangent[v] != corners[i] && next[v] != none) v = next[v];
    if (tangent[v] != glm::vec4(0) && tangent[v] != corners[i]) {
      next[v] = uint32_t(source.size());
      source.push_back(source[v]);
      tangent.push_back(corners[i]);
      next.push_back(none);
      v = next[v];
    }
    tangent[v] = corners[i];
    section.index[i] = v;
  }
  for (glm::vec4& t : tangent)
    if (t == glm::vec4(0)) t = glm::vec4(1, 0, 0, 1);  // vertices of no triangle
  if (source.size() > old_count) remap_vertices(section, source);
  section.tangent = std::move(tangent);
}

}  // namespace

void generate_tangents(MeshSection& section, int uv_set) {
  if (section.topology != Topology::triangles || section.normal.empty()) return;
  section.index.resize(section.index.size() / 3 * 3);
  section.tangent.clear();
  const std::vector<glm::vec2>& given = uv_set == 1 ? section.uv1 : section.uv0;
  const std::vector<glm::vec2> zeros(given.empty() ? section.position.size() : 0);
  const std::vector<glm::vec4> corners = TangentSpaces(section, given.empty() ? zeros : given).corners();
  assign_tangents(section, corners);
}

}  // namespace candela
