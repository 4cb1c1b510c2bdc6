#include "plan/scene_motion.h"

#include <algorithm>

#include "base/input.h"
#include "base/names.h"
#include "base/text.h"
#include "look/look.h"
#include "scene/frame_data.h"
#include "scene/motion_files.h"
#include "scene/pose.h"
#include "scene/scene_path.h"
#include "scene/scene_size.h"
#include "scene/up_axis.h"
#include "scene/view.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

// What is asked for, and by whom: files of a look lie below its folder.
struct Asker {
  std::string place;  // for messages; empty: the job
  fs::path folder;
  const std::string* look = nullptr;
  Expected<std::string> file(const std::string& name) const {
    if (!look) return name;
    const fs::path path = folder / name;
    if (auto allowed = check_named_file(path, folder.empty() ? "." : folder, *look); !allowed)
      return fail(ErrorKind::input, place, "{}", allowed.error().message);
    return path.string();
  }
};

template <class... A>
std::unexpected<Error> refuse(const Asker& by, const char* option, fmt::format_string<A...> format, A&&... args) {
  const std::string message = fmt::format(format, std::forward<A>(args)...);
  return by.look ? fail(ErrorKind::input, by.place, "{}", message) : fail(ErrorKind::usage, option, "{}", message);
}

Expected<int> node_named(const Scene& scene, const std::string& name, const Asker& by, const char* option) {
  std::vector<std::string> names;
  for (const int n : scene.order) {
    if (scene.nodes[size_t(n)].name == name) return n;
    if (!scene.nodes[size_t(n)].name.empty() && names.size() < 32) names.push_back(scene.nodes[size_t(n)].name);
  }
  return refuse(by, option, "{}", unknown_name("node", name, names));
}

// By the light's name, else by that of the node that carries it.
Expected<int> node_of_light(const Scene& scene, const std::string& name, const Asker& by) {
  std::vector<std::string> names;
  int of_node = -1;
  for (const int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    const int light = node.light >= 0 ? node.light : node.light_instances ? node.light_instances->light : -1;
    if (light < 0) continue;
    const std::string& of_light = scene.lights[size_t(light)].name;
    if (of_light == name) return n;
    if (node.name == name && of_node < 0) of_node = n;
    for (const std::string& known : {of_light, node.name})
      if (!known.empty() && names.size() < 32) names.push_back(known);
  }
  if (of_node >= 0) return of_node;
  return refuse(by, "--path", "{}", unknown_name("light", name, names));
}

// Where a file has no camera, one that is nowhere yet. Its near plane is a part of the scene's size.
int add_camera(Scene& scene, const std::string& name) {
  constexpr double near_part = 1e-4;
  const double size_m = scene_size_m(scene);
  Camera camera;
  camera.name = name;
  camera.near_m = size_m > 0 ? near_part * size_m : near_part;
  Node node;
  node.name = name;
  node.camera = int(scene.cameras.size());
  scene.cameras.push_back(std::move(camera));
  scene.nodes.push_back(std::move(node));
  const int added = int(scene.nodes.size()) - 1;
  scene.roots.push_back(added);
  scene.order.push_back(added);
  return added;
}

constexpr const char* added_camera = "path";

class PathReader {
 public:
  PathReader(Scene& scene, const Job& job) : scene_(scene), job_(job), world_from_file_(world_from_file(job.up)) {
    made_.of_node.assign(scene.nodes.size() + 1, -1);  // and of a camera that is added
  }

  // Of a job: none may have a path yet; of a look: those that the job gave one are passed over.
  Expected<void> add(const std::vector<PathRequest>& requests, const Asker& asker) {
    std::vector<int> own;
    for (size_t i = 0; i < requests.size(); ++i) {
      Asker by = asker;
      if (by.look) by.place = fmt::format("{}: /paths/{}", *by.look, i);
      const auto node = node_of(requests[i], by);
      if (!node) return std::unexpected(node.error());
      if (std::find(own.begin(), own.end(), *node) != own.end())
        return refuse(by, "--path", "{} has another path already", requests[i].target);
      own.push_back(*node);
      if (made_.of_node[size_t(*node)] >= 0) continue;
      if (auto read = read_path(requests[i], *node, by); !read) return read;
    }
    return {};
  }

  std::shared_ptr<const ScenePaths> finish() {
    return made_.paths.empty() ? nullptr : std::make_shared<const ScenePaths>(std::move(made_));
  }
  const std::vector<std::string>& files() const { return files_; }

 private:
  Expected<int> node_of(const PathRequest& request, const Asker& by) {
    if (request.target == "camera") {
      auto node = find_camera_node(scene_, job_.camera.camera);
      if (!node || *node >= 0) return node;
      return add_camera(scene_, added_camera);
    }
    if (request.target.starts_with("light ")) return node_of_light(scene_, request.target.substr(6), by);
    return node_named(scene_, request.target.substr(5), by, "--path");
  }

  Expected<void> read_path(const PathRequest& request, int node, const Asker& by) {
    const auto points_file = by.file(request.points);
    if (!points_file) return std::unexpected(points_file.error());
    auto points = read_points(*points_file);
    if (!points) return std::unexpected(points.error());
    files_.push_back(*points_file);
    if (!request.closed && !request.touches_ends && points->size() < 4)
      return fail(ErrorKind::input, *points_file,
                  "holds {} points; a path with plain ends needs 4 (ends=touch takes any number)", points->size());
    const bool in_world = request.target == "camera";
    if (in_world)
      for (glm::dvec3& p : *points) p = world_from_file_ * p;
    const Spline spline(*points, request.closed         ? Spline::Ends::closed
                                 : request.touches_ends ? Spline::Ends::touch
                                                        : Spline::Ends::plain);
    ScenePath path{.node = node, .spline = spline, .in_world = in_world};
    if (request.constant_speed) path.length.emplace(spline);
    if (auto timed = set_times(request, by, path); !timed) return timed;
    if (auto looking = set_looks(request, by, path); !looking) return looking;
    made_.notes.push_back(note(request, *points_file, points->size(), path));
    made_.end_s = std::max(made_.end_s, path.end_s());
    made_.look_at_nodes += path.looks == ScenePath::Looks::at_node;
    made_.of_node[size_t(node)] = int(made_.paths.size());
    made_.paths.push_back(std::move(path));
    return {};
  }

  Expected<void> set_times(const PathRequest& request, const Asker& by, ScenePath& path) {
    const double end = double(path.spline.spans());
    if (request.times.empty()) {
      path.times = {{0, request.seconds.value_or(end)}, {0, end}};
      return {};
    }
    const auto file = by.file(request.times);
    if (!file) return std::unexpected(file.error());
    auto times = read_times(*file);
    if (!times) return std::unexpected(times.error());
    files_.push_back(*file);
    path.times = std::move(*times);
    path.times.smooth = request.smooth_times;
    if (request.by_share)
      for (double& u : path.times.parameter) u *= end;
    return {};
  }

  Expected<void> set_looks(const PathRequest& request, const Asker& by, ScenePath& path) {
    using enum ScenePath::Looks;
    path.up = world_from_file_ * request.up;
    const Node& node = scene_.nodes[size_t(path.node)];
    const bool shines = node.camera >= 0 || ((node.light >= 0 || node.light_instances) && node.mesh < 0);
    path.front = request.front == "+z" || (request.front == "auto" && !shines) ? 1 : -1;
    if (request.along) {
      path.looks = along;
    } else if (request.look_at) {
      path.looks = at_point, path.point = world_from_file_ * *request.look_at;
    } else if (!request.look_at_node.empty()) {
      const auto target = node_named(scene_, request.look_at_node, by, "--path");
      if (!target) return std::unexpected(target.error());
      path.looks = at_node, path.looked_at = *target;
    } else if (node.camera >= 0 && node.name == added_camera && path.in_world) {
      // It was turned no way before.
      const DAabb bounds = world_bounds(scene_, evaluate_pose(scene_, {}, 0));
      if (!bounds.empty()) path.looks = at_point, path.point = bounds.centre();
      looks_at_middle_ = true;
    }
    return {};
  }

  std::string note(const PathRequest& request, const std::string& file, size_t points, const ScenePath& path) const {
    std::string text =
        fmt::format("{} goes along {} ({} point{}{}{}), from {:.4g} to {:.4g} s", request.target, file, points,
                    points == 1 ? "" : "s", request.closed ? ", closed" : "",
                    request.constant_speed ? ", at constant speed" : "", path.times.time_s.front(), path.end_s());
    if (request.target == "camera" && looks_at_middle_) text += "; it looks at the middle of what is drawn";
    return text;
  }

  Scene& scene_;
  const Job& job_;
  const glm::dmat3 world_from_file_;
  ScenePaths made_;
  std::vector<std::string> files_;
  bool looks_at_middle_ = false;
};

void add_files(Scene& scene, const std::vector<std::string>& files) {
  for (const std::string& file : files)
    if (std::ranges::find(scene.files, file) == scene.files.end()) scene.files.push_back(file);
}

Expected<void> add_instances(Scene& scene, const std::vector<InstancesRequest>& requests, const Asker& asker,
                             std::vector<int>& taken) {
  std::vector<int> own;
  for (size_t i = 0; i < requests.size(); ++i) {
    const InstancesRequest& request = requests[i];
    Asker by = asker;
    if (by.look) by.place = fmt::format("{}: /instances/{}", *by.look, i);
    const auto node = node_named(scene, request.node, by, "--instances");
    if (!node) return std::unexpected(node.error());
    if (scene.nodes[size_t(*node)].mesh < 0)
      return refuse(by, "--instances", "node {} has no mesh to draw many times", quoted_name(request.node));
    if (std::find(own.begin(), own.end(), *node) != own.end())
      return refuse(by, "--instances", "node {} has instances already", quoted_name(request.node));
    own.push_back(*node);
    if (std::find(taken.begin(), taken.end(), *node) != taken.end()) continue;
    taken.push_back(*node);
    const auto file = by.file(request.file);
    if (!file) return std::unexpected(file.error());
    auto instances = read_instances(*file, request);
    if (!instances) return std::unexpected(instances.error());
    scene.nodes[size_t(*node)].instances = std::make_shared<const Instances>(std::move(*instances));
    add_files(scene, {*file});
  }
  return {};
}

Expected<Look> motion_of_look(const Job& job) { return job.look.empty() ? Look{} : read_look_motion(job.look); }
Asker asker_of(const Job& job) { return {"", fs::path(job.look).parent_path(), &job.look}; }

Expected<void> add_paths(Scene& scene, const Job& job, const Look& look) {
  if (job.paths.empty() && look.paths.empty()) return {};
  PathReader reader(scene, job);
  if (auto added = reader.add(job.paths, {}); !added) return added;
  if (auto added = reader.add(look.paths, asker_of(job)); !added) return added;
  add_files(scene, reader.files());
  scene.paths = reader.finish();
  return {};
}

}  // namespace

Expected<void> add_motion(Scene& scene, const Job& job) {
  const auto look = motion_of_look(job);
  if (!look) return std::unexpected(look.error());
  std::vector<int> taken;
  if (auto added = add_instances(scene, job.instances, {}, taken); !added) return added;
  if (auto added = add_instances(scene, look->instances, asker_of(job), taken); !added) return added;
  return add_paths(scene, job, *look);
}

Expected<void> add_paths_again(Scene& scene, const Job& job) {
  const auto look = motion_of_look(job);
  if (!look) return std::unexpected(look.error());
  const auto before = std::exchange(scene.paths, nullptr);
  auto added = add_paths(scene, job, *look);
  if (!added) scene.paths = before;
  return added;
}

}  // namespace candela
