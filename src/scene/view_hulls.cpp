#include "scene/view_hulls.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <span>

#include "math/bounds.h"
#include "scene/deformation_bounds.h"
#include "scene/drawn_sections.h"
#include "scene/scene_path.h"

namespace candela {
namespace {

// A surface of one node.
struct Part {
  size_t node = 0, section = 0;
  auto operator<=>(const Part&) const = default;
};

// A constant alpha below the cutoff; vertex colours and textures only lower it.
bool is_cut_away(const Material& m) { return m.alpha_mode == AlphaMode::mask && m.base_color.w < m.alpha_cutoff; }

const Material& material_of(const Scene& scene, const Pose& pose, const MeshSection& section) {
  const bool own = section.material >= 0 && size_t(section.material) < pose.materials.size();
  return own ? pose.materials[size_t(section.material)] : scene.default_material;
}

using EachPose = std::function<void(const std::function<void(const Pose&)>&)>;

// Calls f(node, section) for every surface that is drawn at a pose, whether it counts or not.
template <class F>
void each_drawn(const Scene& scene, DrawnSections& drawn, const F& f) {
  for (const int node : scene.order) {
    const size_t n = size_t(node);
    if (!drawn.has_visible_mesh(n)) continue;
    const std::vector<MeshSection>& sections = scene.meshes[size_t(scene.nodes[n].mesh)].sections;
    for (size_t s = 0; s < sections.size(); ++s)
      if (DrawnSections::can_be_drawn(sections[s])) f(n, s);
  }
}
const MeshSection& section_of(const Scene& scene, Part part) {
  return scene.meshes[size_t(scene.nodes[part.node].mesh)].sections[part.section];
}

// Matrices and weights that a surface's vertices are posed by.
struct Posing {
  std::vector<glm::dmat4> instances;  // world from mesh; of skinned surfaces the identity
  std::vector<glm::dmat4> joints;     // world from bind
  std::vector<float> weights;
  bool operator==(const Posing&) const = default;
};
Posing posing_of(const Scene& scene, const Pose& pose, const DrawnSections& drawn, Part part,
                 const SectionDeformation& deformation) {
  Posing posing;
  const auto [n, s] = part;
  if (!section_of(scene, part).morph.empty()) posing.weights = pose.node_weights[n];
  if (deformation.skinned) {
    const Skin& skin = scene.skins[size_t(scene.nodes[n].skin)];
    for (size_t j = 0; j < skin.joints.size(); ++j)
      posing.joints.push_back(pose.world_from_node[size_t(skin.joints[j])] * skin.inverse_bind[j]);
    posing.instances = {glm::dmat4(1)};
    return posing;
  }
  const glm::dmat4 target_from_node = drawn.target_from_node(n);
  for (size_t i = 0; i < drawn.instance_count(n); ++i)
    posing.instances.push_back(drawn.target_from_instance(target_from_node, n, i));
  return posing;
}

// Vertices of what is drawn. Of masked surfaces the triangles whose vertex colours keep them below the cutoff are left
// out: alpha is linear between vertices, and textures only lower it.
std::vector<uint32_t> used_vertices(const MeshSection& section, const Material& material) {
  const bool masked = material.alpha_mode == AlphaMode::mask && section.color.size() == section.position.size();
  const auto is_kept = [&](uint32_t v) {
    return v < section.position.size() &&
           (!masked || section.color[v].w * material.base_color.w >= material.alpha_cutoff);
  };
  const size_t count = section.index.empty() ? section.position.size() : section.index.size();
  const size_t corners = section.topology == Topology::triangles ? 3 : section.topology == Topology::lines ? 2 : 1;
  std::vector<bool> used(section.position.size());
  const auto vertex = [&](size_t i) { return section.index.empty() ? uint32_t(i) : section.index[i]; };
  for (size_t first = 0; first < count; first += corners) {
    const size_t end = std::min(first + corners, count);
    bool kept = false;
    for (size_t i = first; i < end; ++i) kept = kept || is_kept(vertex(i));
    for (size_t i = first; kept && i < end; ++i)
      if (vertex(i) < used.size()) used[vertex(i)] = true;
  }
  std::vector<uint32_t> vertices;
  for (size_t v = 0; v < used.size(); ++v)
    if (used[v]) vertices.push_back(uint32_t(v));
  return vertices;
}

// A matrix without its last row, which is 0, 0, 0, 1.
using Affine = glm::dmat4x3;
glm::dvec3 moved(const Affine& m, glm::dvec3 p) { return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3]; }

// Morph targets, then linear blend skinning, as glTF has them, in double.
glm::dvec3 posed_vertex(const MeshSection& section, std::span<const float> weights, std::span<const Affine> joints,
                        uint32_t v) {
  glm::dvec3 position(section.position[v]);
  for (size_t t = 0; t < weights.size() && t < section.morph.size(); ++t)
    if (weights[t] != 0 && !section.morph[t].position.empty())
      position += double(weights[t]) * glm::dvec3(section.morph[t].position[v]);
  if (joints.empty()) return position;
  glm::dvec3 sum(0);
  const auto add = [&](const std::vector<glm::u16vec4>& which, const std::vector<glm::vec4>& shares) {
    if (which.empty() || shares.empty()) return;
    for (int i = 0; i < 4; ++i)
      if (shares[v][i] != 0 && which[v][i] < joints.size())
        sum += double(shares[v][i]) * moved(joints[which[v][i]], position);
  };
  add(section.joints0, section.weights0);
  add(section.joints1, section.weights1);
  return sum;
}

double diagonal_of(const DAabb& box) { return box.empty() ? 0 : glm::length(box.max - box.min); }

// How near a surface comes to a point at any time, metres.
double nearest_m(const Scene& scene, const EachPose& each_pose, Part part, glm::dvec3 point) {
  double nearest = std::numeric_limits<double>::infinity();
  const MeshSection& section = section_of(scene, part);
  each_pose([&](const Pose& pose) {
    DrawnSections drawn(scene, pose, glm::dmat4(1.0));
    if (!drawn.has_visible_mesh(part.node)) return;
    const Posing posing = posing_of(scene, pose, drawn, part, drawn.deformation_of(section, part.node));
    const std::vector<Affine> joints(posing.joints.begin(), posing.joints.end());
    for (const glm::dmat4& world : posing.instances)
      for (uint32_t v = 0; v < section.position.size(); ++v)
        nearest = std::min(nearest,
                           glm::length(moved(Affine(world), posed_vertex(section, posing.weights, joints, v)) - point));
  });
  return nearest;
}

// A floor is flat and not above the middle of what stands on it. A dome has room to all sides but below, and none of
// its vertices is near.
bool surrounds(const DAabb& box, const DAabb& rest, const std::function<double(glm::dvec3)>& nearest) {
  const double size = diagonal_of(rest);
  if (box.max.y - box.min.y <= 0.01 * diagonal_of(box)) return box.min.y <= rest.centre().y;
  for (int k = 0; k < 3; ++k) {
    if (box.max[k] - rest.max[k] < size) return false;
    if (k != 1 && rest.min[k] - box.min[k] < size) return false;
  }
  return nearest(rest.centre()) >= 10 * size;
}

// Boxes of what counts, over all times at which it is seen.
std::map<Part, DAabb> boxes_of_parts(const Scene& scene, const EachPose& each_pose) {
  std::map<Part, DAabb> boxes;
  each_pose([&](const Pose& pose) {
    DrawnSections drawn(scene, pose, glm::dmat4(1.0));
    each_drawn(scene, drawn, [&](size_t n, size_t s) {
      const Part part{n, s};
      const MeshSection& section = section_of(scene, part);
      if (is_cut_away(material_of(scene, pose, section))) return;
      const SectionDeformation deformation = drawn.deformation_of(section, n);
      for (const glm::dmat4& world : posing_of(scene, pose, drawn, part, deformation).instances)
        if (const DAabb box = drawn.bounds_of(section, n, deformation, world); is_finite(box)) boxes[part].add(box);
    });
  });
  return boxes;
}

// Surfaces a hundred times larger than all smaller ones together, over all times: domes and floors.
struct Surroundings {
  std::set<Part> parts;
  DAabb rest;
  std::string note;
};
Surroundings surroundings(const Scene& scene, const EachPose& each_pose) {
  constexpr double ratio = 100;
  std::vector<std::pair<Part, DAabb>> all;
  for (const auto& entry : boxes_of_parts(scene, each_pose)) all.push_back(entry);
  std::ranges::sort(all, {}, [](const auto& one) { return std::pair(diagonal_of(one.second), one.first); });
  Surroundings out;
  std::vector<std::pair<Part, DAabb>> left_out;
  for (const auto& [part, box] : all) {
    const double rest = diagonal_of(out.rest);
    const auto nearest = [&](glm::dvec3 point) { return nearest_m(scene, each_pose, part, point); };
    if (rest > 0 && diagonal_of(box) >= ratio * rest && surrounds(box, out.rest, nearest)) {
      left_out.emplace_back(part, box);
      continue;
    }
    // Beside something as large that counts, what was left out counts too.
    for (const auto& before : left_out) out.rest.add(before.second);
    left_out.clear();
    out.rest.add(box);
  }
  for (const auto& one : left_out) out.parts.insert(one.first);
  if (!left_out.empty())
    out.note = fmt::format(
        "the camera is placed without {} {} of {:.4g} m, a hundred times larger than all else (--eye and --target "
        "place it elsewhere)",
        left_out.size(), left_out.size() == 1 ? "surface" : "surfaces", diagonal_of(left_out.back().second));
  return out;
}

// Collects the outlines.
struct Outlines {
  glm::dmat3 view_from_world;
  glm::dvec3 middle;
  std::optional<glm::dvec2> axis;  // x and z of the upright axis that all turns about
  PlanarHull x, y, swept;          // swept: (distance from the axis, height)
  bool broken = false;             // some vertex is not finite

  void add(glm::dvec3 world) {
    if (!std::isfinite(world.x) || !std::isfinite(world.y) || !std::isfinite(world.z)) {
      broken = true;
      return;
    }
    if (axis) {
      swept.add({std::hypot(world.x - axis->x, world.z - axis->y), world.y - middle.y});
      return;
    }
    const glm::dvec3 p = view_from_world * (world - middle);
    x.add({p.x, p.z}), y.add({p.y, p.z});
  }
  void add(const Outlines& other) {
    x.add(other.x), y.add(other.y), swept.add(other.swept);
    broken |= other.broken;
  }
  // Whether nothing in a box could change the outlines.
  bool contain(const DAabb& box) const {
    if (axis) return false;
    for (int c = 0; c < 8; ++c) {
      const glm::dvec3 corner(c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y,
                              c & 4 ? box.max.z : box.min.z);
      const glm::dvec3 p = view_from_world * (corner - middle);
      if (!x.contains({p.x, p.z}) || !y.contains({p.y, p.z})) return false;
    }
    return true;
  }
  Outlines empty() const { return {view_from_world, middle, axis, {}, {}, {}, false}; }
};

void add_vertices(Outlines& outlines, const MeshSection& section, const std::vector<uint32_t>& vertices,
                  const Posing& posing, const glm::dmat4& world_from_posed) {
  constexpr size_t grain = 2048;
  const std::vector<Affine> joints(posing.joints.begin(), posing.joints.end());
  const Affine world(world_from_posed);
  const Outlines part = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<size_t>(0, vertices.size(), grain), outlines.empty(),
      [&](const tbb::blocked_range<size_t>& range, Outlines sum) {
        for (size_t i = range.begin(); i != range.end(); ++i)
          sum.add(moved(world, posed_vertex(section, posing.weights, joints, vertices[i])));
        return sum;
      },
      [](Outlines a, const Outlines& b) {
        a.add(b);
        return a;
      });
  outlines.add(part);
}

// Walks over surfaces at one time after another, and leaves out what stands as it stood before.
class Walk {
 public:
  Walk(const Scene& scene, const std::set<Part>& without) : scene_(scene), without_(without) {}

  void add(const Pose& pose, Outlines& outlines) {
    DrawnSections drawn(scene_, pose, glm::dmat4(1.0));
    each_drawn(scene_, drawn, [&](size_t n, size_t s) {
      const Part part{n, s};
      if (is_cut_away(material_of(scene_, pose, section_of(scene_, part))))
        cut_away_ = true;
      else if (!without_.contains(part))
        add(pose, drawn, part, outlines);
    });
  }
  bool has_cut_away() const { return cut_away_; }

 private:
  void add(const Pose& pose, DrawnSections& drawn, Part part, Outlines& outlines) {
    const MeshSection& section = section_of(scene_, part);
    const SectionDeformation deformation = drawn.deformation_of(section, part.node);
    if (section.metaballs >= 0)
      return add_box(drawn.bounds_of(section, part.node, {}, drawn.target_from_node(part.node)), outlines);
    Posing posing = posing_of(scene_, pose, drawn, part, deformation);
    Posing& before = before_[part];
    if (before == posing) return;
    std::vector<uint32_t>& vertices = vertices_[&section];
    if (vertices.empty()) vertices = used_vertices(section, material_of(scene_, pose, section));
    for (const glm::dmat4& world : posing.instances) {
      const DAabb box = drawn.bounds_of(section, part.node, deformation, world);
      if (!is_finite(box) || !outlines.contain(box)) add_vertices(outlines, section, vertices, posing, world);
    }
    before = std::move(posing);
  }
  static void add_box(const DAabb& box, Outlines& outlines) {
    if (box.empty() || !is_finite(box)) return;
    for (int c = 0; c < 8; ++c)
      outlines.add({c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y, c & 4 ? box.max.z : box.min.z});
  }

  const Scene& scene_;
  const std::set<Part>& without_;
  bool cut_away_ = false;
  std::map<Part, Posing> before_;
  std::map<const MeshSection*, std::vector<uint32_t>> vertices_;
};

// Keys of what moves, and as many times evenly between the first and the last.
std::vector<double> film_times(const Scene& scene, const AnimationChoice& choice, std::string& note) {
  constexpr size_t even = 33, most = 128;
  const double end_s = clips_end_s(scene, choice);
  std::set<double> keys;
  for (const int a : choice.animations)
    for (const AnimationChannel& channel : scene.animations[size_t(a)].channels)
      if (channel.path <= TargetPath::node_visible || channel.path >= TargetPath::metaballs_threshold)
        for (const float t : channel.times_s) keys.insert(double(t));
  if (scene.paths)
    for (const ScenePath& path : scene.paths->paths) keys.insert(path.times.time_s.begin(), path.times.time_s.end());
  std::set<double> times = {0};
  if (!keys.empty())
    for (size_t i = 0; i < even; ++i) times.insert(end_s * double(i) / double(even - 1));
  const size_t step = (keys.size() + most - 1) / most;
  size_t at = 0;
  for (const double key : keys)
    if (at++ % step == 0) times.insert(key);
  if (!keys.empty())
    note = fmt::format(
        "one camera for the whole film of {:.4g} s shows all that is drawn{} (--follow places it anew for each frame)",
        end_s, step > 1 ? fmt::format(" at {} of its {} keys", (at + step - 1) / step, keys.size()) : "");
  return {times.begin(), times.end()};
}

}  // namespace

ViewHulls view_hulls(const Scene& scene, const FramedTime& time, const glm::dmat3& axes, bool turned) {
  ViewHulls out;
  std::vector<double> times;
  if (!time.pose) {
    std::string note;
    times = film_times(scene, time.animations, note);
    if (!note.empty()) out.notes.push_back(std::move(note));
  }
  const EachPose each_pose = [&](const std::function<void(const Pose&)>& f) {
    if (time.pose) f(*time.pose);
    for (const double t : times) f(evaluate_pose(scene, time.animations, t));
  };
  Surroundings without = surroundings(scene, each_pose);
  if (!without.note.empty()) out.notes.push_back(std::move(without.note));
  if (without.rest.empty()) return out;
  // About the middle of what is drawn, so that worlds far from the origin keep their digits.
  out.middle = without.rest.centre();
  const auto outline = [&](const glm::dmat3& view_from_world, std::optional<glm::dvec2> axis) {
    Outlines outlines{view_from_world, out.middle, axis, {}, {}, {}, false};
    Walk walk(scene, without.parts);
    each_pose([&](const Pose& pose) { walk.add(pose, outlines); });
    if (walk.has_cut_away()) out.notes.emplace_back("surfaces that a mask cuts away do not count for the camera");
    if (outlines.broken) out.notes.emplace_back("vertices that are not finite do not count for the camera");
    return outlines;
  };
  const size_t notes_before = out.notes.size();
  const glm::dmat3 view_from_world = glm::transpose(axes);
  if (!turned) {
    Outlines seen = outline(view_from_world, std::nullopt);
    out.x = std::move(seen.x), out.y = std::move(seen.y);
    return out;
  }
  // Polygons about the circles that the outline's corners run along; the first of each in the direction `right`.
  const auto middle_of = [](PlanarHull& hull) {
    glm::dvec2 least(std::numeric_limits<double>::infinity()), most(-least);
    for (const glm::dvec2& p : hull.points()) least = glm::min(least, p), most = glm::max(most, p);
    return hull.points().empty() ? glm::dvec2(0) : least + (most - least) / 2.0;
  };
  Outlines world = outline(glm::dmat3(1), std::nullopt);
  out.notes.resize(notes_before);  // the second walk says the same
  const glm::dvec2 off = middle_of(world.x), axis(out.middle.x + off.x, out.middle.z + off.y);
  out.middle.x = axis.x, out.middle.z = axis.y;
  constexpr int steps = 128;
  const glm::dvec3 level(axes[0].x, 0, axes[0].z),
      side = glm::length(level) > 0 ? glm::normalize(level) : glm::dvec3(1, 0, 0);
  Outlines swept = outline(view_from_world, axis);
  for (const glm::dvec2& p : swept.swept.points())
    for (int i = 0; i < steps; ++i) {
      const double turn = 2 * std::numbers::pi * i / steps, radius = p.x / std::cos(std::numbers::pi / steps);
      const glm::dvec3 around =
          radius * (std::cos(turn) * side + std::sin(turn) * glm::dvec3(-side.z, 0, side.x)) + glm::dvec3(0, p.y, 0);
      const glm::dvec3 seen = view_from_world * around;
      out.add(seen);
    }
  return out;
}

ViewHulls KeptViewHulls::of_film(const Scene& scene, const AnimationChoice& animations, const glm::dmat3& axes,
                                 bool turned) {
  Key key{animations.animations, {}, turned};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) std::get<1>(key).push_back(axes[i][k]);
  const std::lock_guard lock(mutex_);
  const auto found = kept_.find(key);
  if (found != kept_.end()) return found->second;
  constexpr size_t most = 64;  // cameras that turn ask for others each frame
  if (kept_.size() >= most) kept_.clear();
  return kept_.emplace(std::move(key), view_hulls(scene, {animations, nullptr}, axes, turned)).first->second;
}

}  // namespace candela
