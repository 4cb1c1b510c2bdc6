#pragma once
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/rng.h"
#include "bvh/triangle.h"
#include "reference/accel_trees.h"

namespace candela::bvh_test {

// Triangle meshes placed by matrices, without a file.
struct Made {
  std::string name;
  Scene scene;
  Pose pose;
  FrameData frame;

  uint32_t add_mesh(const std::vector<TriangleCorners>& triangles) {
    MeshSection section;
    for (const TriangleCorners& t : triangles)
      for (glm::vec3 p : t.corner) {
        section.index.push_back(uint32_t(section.position.size()));
        section.position.push_back(p);
        section.bounds.add(p);
      }
    scene.meshes.push_back({"", {std::move(section)}, {}});
    return uint32_t(scene.meshes.size() - 1);
  }
  void place(uint32_t mesh, const glm::mat4& relative_from_local = glm::mat4(1.0f)) {
    DrawItem item;
    item.mesh = mesh;
    item.transform = uint32_t(frame.relative_from_local.size());
    item.mirrored = glm::determinant(glm::dmat3(relative_from_local)) < 0;
    frame.relative_from_local.push_back(relative_from_local);
    frame.items.push_back(item);
  }
};

inline std::unique_ptr<Made> made(std::string name, const std::vector<TriangleCorners>& triangles) {
  auto m = std::make_unique<Made>();
  m->name = std::move(name);
  m->place(m->add_mesh(triangles));
  return m;
}

inline glm::vec3 random_in(Rng& rng, double low, double high) {
  const double x = rng.uniform(low, high), y = rng.uniform(low, high), z = rng.uniform(low, high);
  return {float(x), float(y), float(z)};
}
inline glm::vec3 random_direction(Rng& rng) {
  while (true) {
    const glm::vec3 d = random_in(rng, -1, 1);
    if (glm::dot(d, d) > 0.01f && glm::dot(d, d) < 1) return d;
  }
}

inline std::vector<TriangleCorners> random_soup(uint64_t seed, int count, double size) {
  Rng rng(seed);
  std::vector<TriangleCorners> out;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 p = random_in(rng, -1, 1);
    TriangleCorners t{{p, p + random_in(rng, -size, size), p + random_in(rng, -size, size)}};
    if (i % 7 == 0) t.corner[2] = t.corner[1];                               // a line
    if (i % 11 == 0) t.corner[0].z = t.corner[1].z = t.corner[2].z = 0.25f;  // in a plane of the axes
    if (i % 5 == 0)
      for (glm::vec3& c : t.corner) c = glm::round(c * 4.0f) / 4.0f;  // many share coordinates
    out.push_back(t);
  }
  return out;
}

// Long and thin, along all diagonals.
inline std::vector<TriangleCorners> slivers(uint64_t seed, int count) {
  Rng rng(seed);
  std::vector<TriangleCorners> out;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 p = random_in(rng, -1, 1);
    const glm::vec3 along{i & 1 ? 0.8f : -0.8f, i & 2 ? 0.8f : -0.8f, i & 4 ? 0.8f : -0.8f};
    out.push_back({{p, p + along, p + along * 0.5f + random_in(rng, -0.01, 0.01)}});
  }
  return out;
}

// Roofs of long planks, each in its own direction.
inline std::vector<TriangleCorners> planks(uint64_t seed, int roofs, int strips) {
  Rng rng(seed);
  std::vector<TriangleCorners> out;
  for (int r = 0; r < roofs; ++r) {
    const glm::vec3 centre = random_in(rng, -1, 1), along = glm::normalize(random_direction(rng));
    const glm::vec3 across = glm::normalize(glm::cross(along, random_direction(rng)));
    for (int s = 0; s < strips; ++s) {
      const float a = float(s) / float(strips) - 0.5f, b = float(s + 1) / float(strips) - 0.5f;
      const glm::vec3 p = centre + across * a - along * 0.5f, q = centre + across * b - along * 0.5f;
      out.push_back({{p, q, q + along}}), out.push_back({{p, q + along, p + along}});
    }
  }
  return out;
}

// A closed surface that shares its corners exactly; radii vary, so that it is not convex.
inline std::vector<TriangleCorners> closed_mesh(int segments, int rings, float centre = 0) {
  const auto at = [&](int s, int r) {
    s %= segments;
    const double theta = M_PI * r / rings, phi = 2 * M_PI * s / segments;
    const double radius = r == 0 || r == rings ? 1.0 : 1.0 + 0.3 * std::sin(3.0 * s + 2.0 * r);
    return glm::vec3(centre) + glm::vec3(float(radius * std::sin(theta) * std::cos(phi)),
                                         float(radius * std::cos(theta)),
                                         float(radius * std::sin(theta) * std::sin(phi)));
  };
  const auto pole = [&](int r) { return glm::vec3(centre) + glm::vec3(0, r == 0 ? 1.0f : -1.0f, 0); };
  std::vector<TriangleCorners> out;
  for (int s = 0; s < segments; ++s) {
    out.push_back({{pole(0), at(s + 1, 1), at(s, 1)}});
    out.push_back({{pole(rings), at(s, rings - 1), at(s + 1, rings - 1)}});
    for (int r = 1; r + 1 < rings; ++r) {
      out.push_back({{at(s, r), at(s + 1, r), at(s, r + 1)}});
      out.push_back({{at(s + 1, r), at(s + 1, r + 1), at(s, r + 1)}});
    }
  }
  return out;
}

// Every triangle of every item with the same triangle test, in the space the tree has it.
class BruteForce {
 public:
  explicit BruteForce(const Accel& accel) : trees_(accel.trees()) {
    std::vector<bool> instanced(trees_.frame->items.size());
    for (const AccelInstance& i : trees_.instances) {
      instanced[i.item] = true;
      groups_.push_back({i.item, &i, {}});
      const DrawItem& item = trees_.frame->items[i.item];
      const MeshSection& s = trees_.section_of(item);
      for (size_t k = 0; k + 2 < s.index.size(); k += 3)
        groups_.back().triangles.push_back(
            {{trees_.positions_of(item)[s.index[k]], trees_.positions_of(item)[s.index[k + 1]],
              trees_.positions_of(item)[s.index[k + 2]]}});
    }
    for (uint32_t i = 0; i < trees_.frame->items.size(); ++i) {
      if (instanced[i]) continue;
      groups_.push_back({i, nullptr, {}});
      for (uint32_t k = 0; k < trees_.section_of(trees_.frame->items[i]).index.size() / 3; ++k) {
        const PosedTriangle t = accel.triangle(i, k);
        groups_.back().triangles.push_back({{t.position[0], t.position[1], t.position[2]}});
      }
    }
  }

  std::optional<Hit> closest(const Ray& ray) const {
    std::optional<Hit> best;
    const float scale = direction_scale(ray.direction);
    float t_max = ray.t_max * scale;
    for (const Group& g : groups_) {
      glm::vec3 origin = ray.origin, direction = ray.direction / scale;
      if (g.instance) {
        origin = g.instance->local_from_relative * glm::dvec4(glm::dvec3(ray.origin), 1.0);
        direction = g.instance->local_from_relative * glm::dvec4(glm::dvec3(direction), 0.0);
      }
      const bool mirrored = !g.instance && trees_.frame->items[g.item].mirrored;
      const RayShear shear = shear_of(direction);
      for (uint32_t k = 0; k < g.triangles.size(); ++k) {
        const TriangleCorners& c = g.triangles[k];
        TriangleHit h;
        if (!meet_triangle(shear, origin, c.corner[0], c.corner[1], c.corner[2], ray.t_min * scale, t_max, h)) continue;
        if (best && h.t == t_max && std::tie(g.item, k) >= std::tie(best->item, best->primitive)) continue;
        best = Hit{h.t * (1.0f / scale), h.u, h.v, g.item, k, h.clockwise != mirrored};
        t_max = h.t;
      }
    }
    return best;
  }

 private:
  struct Group {
    uint32_t item;
    const AccelInstance* instance;
    std::vector<TriangleCorners> triangles;
  };
  const Accel::Trees& trees_;
  std::vector<Group> groups_;
};

inline bool same(const std::optional<Hit>& a, const std::optional<Hit>& b) {
  if (!a || !b) return !a && !b;
  return a->t == b->t && a->u == b->u && a->v == b->v && a->item == b->item && a->primitive == b->primitive &&
         a->back == b->back;
}

// Rays of many kinds through a scene's triangles; number i is always the same ray.
class Rays {
 public:
  explicit Rays(const Accel& accel) {
    const FrameData& frame = *accel.trees().frame;
    Aabb box;
    for (uint32_t i = 0; i < frame.items.size(); ++i)
      for (uint32_t k = 0; k < accel.trees().section_of(frame.items[i]).index.size() / 3; ++k) {
        const PosedTriangle t = accel.triangle(i, k);
        triangles_.push_back({{t.position[0], t.position[1], t.position[2]}});
        for (glm::vec3 p : t.position) box.add(p);
      }
    centre_ = box.centre();
    size_ = std::max({box.extent().x, box.extent().y, box.extent().z, std::numeric_limits<float>::min()});
  }

  Ray operator[](uint64_t i) const {
    Rng rng(i * 977 + 5);
    Ray ray;
    ray.origin = centre_ + random_in(rng, -1.5, 1.5) * size_;
    ray.direction = random_direction(rng);
    if (triangles_.empty()) return ray;
    const TriangleCorners& t = triangles_[rng.next() % triangles_.size()];
    const size_t c = rng.next() % 3;
    const glm::vec3 from = t.corner[c], to = t.corner[(c + 1) % 3];
    const int axis = int(rng.next() % 3);
    glm::vec3 along(0);
    along[axis] = i & 1 ? 1.0f : -1.0f;
    switch (i % 8) {
      case 0:
        break;  // anywhere
      case 1:
        ray.direction = from - ray.origin;
        break;  // at a corner
      case 2:
        ray.direction = glm::mix(from, to, float(rng.uniform())) - ray.origin;
        break;  // at an edge
      case 3:
        ray.direction = along;
        break;  // along an axis
      case 4:   // along an axis at a corner
        ray.origin = from - along * (size_ * float(rng.uniform(0, 3)));
        ray.direction = along;
        break;
      case 5:  // along an edge
        ray.origin = from + (from - to) * float(rng.uniform(0, 4));
        ray.direction = to - from;
        break;
      case 6:
        ray.origin = glm::mix(from, to, float(rng.uniform()));
        break;  // from a surface
      case 7:
        ray.t_min = size_ * 0.1f, ray.t_max = size_;
        break;  // a piece
    }
    if (i % 16 == 10) ray.direction *= 1e-3f;
    if (i % 16 == 12) ray.direction[axis] *= 1e-30f;
    return ray;
  }

 private:
  std::vector<TriangleCorners> triangles_;
  glm::vec3 centre_{0};
  float size_ = 1;
};

// Some of each: what the tree flattens, what it instances, mirrored, skewed, flattened to nothing, tiny, huge; and more
// along a line.
inline std::unique_ptr<Made> instanced_scene(int more = 0) {
  auto m = std::make_unique<Made>();
  m->name = "instances";
  const uint32_t mesh = m->add_mesh(closed_mesh(8, 4));
  const glm::mat4 one(1.0f);
  const auto at = [&](float x, glm::vec3 scale) {
    m->place(mesh, glm::scale(glm::rotate(glm::translate(one, {x, 0.2f * x, -x}), x, {1, 2, 3}), scale));
  };
  at(0, {1, 1, 1}), at(0.5f, {0.3f, 0.9f, 0.5f}), at(-0.7f, {-1, 1, 1}), at(1.0f, {0.5f, -0.5f, -0.25f});
  at(1.3f, {1, 0, 1}), at(-1.3f, {1e-8f, 1e-8f, 1e-8f}), at(0.2f, {0, 0, 0}), at(-0.2f, {1, 1e-7f, 1});
  for (int i = 0; i < more; ++i) at(0.1f * float(i) - 2, {0.2f, 0.1f, 0.3f});
  return m;
}

constexpr BvhBuilder all_builders[] = {BvhBuilder::equal_counts, BvhBuilder::sah, BvhBuilder::sbvh,
                                       BvhBuilder::spatial_only};
// What items share has a tree of its own, however small.
inline AccelOptions with_instances() {
  AccelOptions options;
  options.repeated_triangles = 0;
  return options;
}
inline AccelOptions built_by(BvhBuilder builder) {
  AccelOptions options = with_instances();
  options.tree.builder = builder;
  return options;
}

}  // namespace candela::bvh_test
