#include "plan/choose_sides.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "plan/posed_scene.h"

namespace candela {
namespace {

constexpr int grid_x = 32, grid_y = 18, most_times = 5;
constexpr uint64_t most_triangles = 2'000'000;  // over all times
constexpr double most_culled = 0.1;

// What the camera's rays meet first, on a grid of the picture, by triangles in clip space (Olano and Greer, "Triangle
// Scan Conversion using 2D Homogeneous Coordinates", 1997).
class FirstHits {
 public:
  FirstHits() { nearest_.fill(std::numeric_limits<double>::infinity()), culled_.fill(false); }

  // Whether corners (as in add) lie all behind the camera or beyond one side of the picture.
  static bool misses(const glm::dvec3 (&v)[3]) {
    const auto all = [&](auto beyond) { return beyond(v[0]) && beyond(v[1]) && beyond(v[2]); };
    return all([](const glm::dvec3& c) { return c.z <= 0; }) || all([](const glm::dvec3& c) { return c.x > c.z; }) ||
           all([](const glm::dvec3& c) { return c.x < -c.z; }) || all([](const glm::dvec3& c) { return c.y > c.z; }) ||
           all([](const glm::dvec3& c) { return c.y < -c.z; });
  }
  // x, y and w of the corners. culled: the camera does not see it.
  void add(const glm::dvec3 (&v)[3], bool culled) {
    const double det = glm::dot(v[0], glm::cross(v[1], v[2]));
    if (!(std::abs(det) > 0)) return;
    int low[2] = {0, 0}, high[2] = {grid_x - 1, grid_y - 1};
    if (std::min({v[0].z, v[1].z, v[2].z}) > 0) {
      for (int a = 0; a < 2; ++a) {
        const double at[] = {v[0][a] / v[0].z, v[1][a] / v[1].z, v[2][a] / v[2].z};
        const double cells = a == 0 ? grid_x : grid_y;
        low[a] = int(std::clamp((*std::min_element(at, at + 3) * 0.5 + 0.5) * cells - 1, -1.0, cells));
        high[a] = int(std::clamp((*std::max_element(at, at + 3) * 0.5 + 0.5) * cells, -1.0, cells));
        low[a] = std::max(low[a], 0), high[a] = std::min(high[a], int(cells) - 1);
      }
    }
    const glm::dvec3 edge[] = {glm::cross(v[1], v[2]) / det, glm::cross(v[2], v[0]) / det,
                               glm::cross(v[0], v[1]) / det};
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const glm::dvec3 p((x + 0.5) / grid_x * 2 - 1, (y + 0.5) / grid_y * 2 - 1, 1);
        const double e[] = {glm::dot(edge[0], p), glm::dot(edge[1], p), glm::dot(edge[2], p)};
        if (!(e[0] >= 0 && e[1] >= 0 && e[2] >= 0)) continue;
        const double w = 1 / (e[0] + e[1] + e[2]);
        const size_t i = size_t(y * grid_x + x);
        if (!(w < nearest_[i])) continue;
        nearest_[i] = w, culled_[i] = culled;
      }
  }
  int met() const {
    return int(std::ranges::count_if(nearest_, [](double w) { return std::isfinite(w); }));
  }
  int culled() const { return int(std::ranges::count(culled_, true)); }

 private:
  std::array<double, size_t(grid_x) * grid_y> nearest_;
  std::array<bool, size_t(grid_x) * grid_y> culled_;
};

void add_item(const Scene& scene, const PosedScene& posed, const DrawItem& item, FirstHits& hits) {
  const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
  const Material& material = item.material >= 0 ? posed.pose.materials[size_t(item.material)] : scene.default_material;
  if (section.topology != Topology::triangles || material.alpha_mode != AlphaMode::opaque) return;
  const glm::dmat4 relative(posed.data.relative_from_local[item.transform]);
  const glm::dmat4 clip = posed.view.clip_from_view * posed.view.view_from_relative;
  const glm::dvec3 forward = -glm::dvec3(glm::transpose(posed.view.view_from_relative)[2]);
  struct Corner {
    glm::dvec3 relative, seen;
  };
  std::vector<Corner> corners;
  corners.reserve(section.position.size());
  for (const auto& position : section.position) {
    const glm::dvec3 at(relative * glm::dvec4(glm::dvec3(position), 1));
    const glm::dvec4 c = clip * glm::dvec4(at, 1);
    corners.push_back({at, {c.x, c.y, c.w}});
  }
  for (size_t t = 0; t + 2 < section.index.size(); t += 3) {
    glm::dvec3 corner[3], seen[3];
    for (size_t k = 0; k < 3; ++k) {
      corner[k] = corners[section.index[t + k]].relative;
      seen[k] = corners[section.index[t + k]].seen;
    }
    if (FirstHits::misses(seen)) continue;
    const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]) * (item.mirrored ? -1.0 : 1.0);
    const bool from_behind = glm::dot(normal, posed.view.perspective ? corner[0] : forward) > 0;
    hits.add(seen, from_behind && !material.double_sided);
  }
}

}  // namespace

ChosenSides choose_sides(const Scene& scene, const Job& job) {
  const ChosenSides block{"block", {}};
  const auto animations = choose_animations(scene, job.animation);
  const double end_s = std::max(animations ? clips_end_s(scene, *animations) : 0, job.camera.turn_s);
  std::atomic<uint64_t> met = 0, culled = 0, triangles = 0;
  std::atomic<bool> cannot = false;
  tbb::parallel_for(0, end_s > 0 ? most_times : 1, [&](int i) {
    const auto posed = pose_scene(scene, job, end_s * i / (most_times - 1));
    if (!posed) cannot = true;  // planning says why
    if (!posed) return;
    for (const DrawItem& item : posed->data.items)
      triangles += scene.meshes[item.mesh].sections[item.section].index.size() / 3;
    if (triangles > most_triangles) return;
    FirstHits hits;
    for (const DrawItem& item : posed->data.items)
      if (item.deformed < 0) add_item(scene, *posed, item, hits);
    met += uint64_t(hits.met()), culled += uint64_t(hits.culled());
  });
  if (cannot || triangles > most_triangles) return block;
  const double fraction = met > 0 ? double(culled) / double(met) : 0;
  if (fraction <= most_culled) return block;
  return {"open", fmt::format("{:.0f} % of what the camera meets first are backs of single-sided faces, which it looks "
                              "through",
                              100 * fraction)};
}

}  // namespace candela
