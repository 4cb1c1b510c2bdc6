#pragma once
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene/spline.h"

namespace candela {

struct PathPlace {
  glm::dvec3 position{0};
  glm::dvec3 direction{0};  // unit, of the growing parameter; 0: the path is one point
};

// A path on which a node goes (docs/using/paths.md).
struct ScenePath {
  int node = -1;
  Spline spline;
  std::optional<ArcLength> length;  // the parameter goes by it
  TimeMap times;                    // to the parameter, 0 to the count of spans
  bool in_world = false;            // else in the node's parent's space, as its translation is
  // What the node looks at; `none`: it is turned as it is without the path.
  enum class Looks : uint8_t { none, at_point, at_node, along } looks = Looks::none;
  glm::dvec3 point{0};  // world
  int looked_at = -1;   // node
  glm::dvec3 up{0, 1, 0};
  double front = -1;  // along its z, the side that looks
  PathPlace at(double time_s) const;
  double end_s() const { return times.time_s.back(); }
};

struct ScenePaths {
  std::vector<ScenePath> paths;
  std::vector<int> of_node;        // into `paths`; -1: none. As long as the nodes were when paths were added
  size_t look_at_nodes = 0;        // how many look at nodes
  double end_s = 0;                // of the last
  std::vector<std::string> notes;  // what each is, one line each
  const ScenePath* of(size_t node) const {
    return node < of_node.size() && of_node[node] >= 0 ? &paths[size_t(of_node[node])] : nullptr;
  }
};

// World from the node that is there. parent: world from its parent; local: the node's own without the path; before: all
// nodes as they were placed the last time, where something looks at nodes; empty: not yet.
glm::dmat4 on_path(const ScenePath& path, const PathPlace& place, const glm::dmat4& parent, const glm::dmat4& local,
                   const std::vector<glm::dmat4>& before);

}  // namespace candela
