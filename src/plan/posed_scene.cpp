#include "plan/posed_scene.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "job/picture_window.h"
#include "plan/scene_motion.h"
#include "scene/cut_outs.h"
#include "scene/probe.h"
#include "scene/shading.h"
#include "scene/up_axis.h"

namespace candela {

Expected<Scene> load_scene(const Job& job, LoadFor use) {
  auto scene = load_gltf(job.scene, {use, job.variant, job.animation != "none"});
  if (!scene) return scene;
  if (const auto covering = make_covering_opaque(*scene); !covering.empty())
    log::debug("{} materials of alphaMode BLEND hide all that is behind them: drawn as opaque", covering.size());
  apply_cut_outs(*scene, job.cut_outs);
  turn_up(*scene, job.up);
  apply_shading(*scene, job.shading);
  if (auto moved = add_motion(*scene, job); !moved) return std::unexpected(moved.error());
  add_probe(*scene, probe_from_name(job.probe));
  scene->view_hulls = std::make_shared<KeptViewHulls>();
  return scene;
}

Expected<double> focus_m(const Scene& scene, const LensLook& lens, const Pose& pose, const View& view) {
  if (lens.focus_node.empty()) return lens.focus_m;
  const auto of_name =
      std::ranges::find_if(scene.order, [&](int n) { return scene.nodes[size_t(n)].name == lens.focus_node; });
  if (of_name == scene.order.end()) {
    std::vector<std::string> names;
    for (const int n : scene.order)
      if (!scene.nodes[size_t(n)].name.empty()) names.push_back(scene.nodes[size_t(n)].name);
    return fail(ErrorKind::usage, "--focus", "{}", unknown_name("node", lens.focus_node, names));
  }
  const glm::dvec3 place(pose.world_from_node[size_t(*of_name)][3]);
  const double depth_m = -(glm::dmat3(view.view_from_relative) * (place - view.position)).z;
  if (depth_m >= view.near_m) return depth_m;
  return fail(ErrorKind::usage, "--focus", "node '{}' is not before the camera at {:.6g} s ({:.4g} m along its axis)",
              lens.focus_node, pose.time_s, depth_m);
}

namespace {

Expected<ImageWindow> seen_by_subframe(const Scene& scene, const Job& job, const Subframe& subframe,
                                       PosedScene& posed) {
  constexpr int most_px = 16384;  // as check_job()
  LensPoint point;
  if (subframe.camera) {
    const auto focus = focus_m(scene, *subframe.camera, posed.pose, posed.view);
    if (!focus) return std::unexpected(focus.error());
    point.focus_m = *focus;
    point.radius_m = lens_radius_m(*subframe.camera, posed.view);
    point.from_middle_m = subframe.lens * point.radius_m;
    if (!posed.view.perspective) posed.view.notes.push_back("an orthographic camera has no lens: --fstop does nothing");
  }
  const PictureWindow picture = picture_window(job);
  return look_through(posed.view, point, subframe.offset_px, picture.width_px, picture.height_px, most_px);
}

}  // namespace

bool any_in_view(std::span<const DrawItem> items, const View& view) {
  const FrustumPlanes planes = frustum_planes(view.clip_from_relative);
  return std::ranges::any_of(items, [&](const DrawItem& item) {
    const glm::dvec3 centre(item.bounds_relative.centre()), extent(item.bounds_relative.extent());
    return std::ranges::all_of(planes, [&](const glm::dvec4& plane) {
      const glm::dvec3 normal(plane);
      return !(glm::dot(normal, centre) + plane.w + glm::dot(glm::abs(normal), extent) < 0);
    });
  });
}

double lens_radius_m(const LensLook& lens, const View& view) {
  return view.perspective ? lens.sensor_mm / 1000 / 2 / view.tan_y / lens.f_stop / 2 : 0;
}

Expected<PosedScene> pose_scene(const Scene& scene, const Job& job, double time_s, double lamp_radius_m,
                                const View* given, const DevicePose& on_device, double cells,
                                const Subframe* subframe) {
  PosedScene out;
  auto posed = pose_scene(scene, job, nullptr, time_s, lamp_radius_m, given, on_device, cells, subframe, out);
  if (!posed) return std::unexpected(posed.error());
  return out;
}

Expected<void> pose_scene(const Scene& scene, const Job& job, const PosedParts* parts, double time_s,
                          double lamp_radius_m, const View* given, const DevicePose& on_device, double cells,
                          const Subframe* subframe, PosedScene& out) {
  std::optional<PosedParts> own;
  if (!parts) {
    const auto animations = choose_animations(scene, job.animation);
    if (!animations) return std::unexpected(animations.error());
    parts = &own.emplace(posed_parts(scene, *animations));
  }
  const AnimationChoice& animations = parts->choice;
  out.window = {};
  evaluate_pose(scene, *parts, time_s, out.state, out.pose);
  if (given) {
    out.view = *given;
  } else {
    const auto outlines = [&](const glm::dmat3& axes, bool turned) {
      if (job.camera.framing == Framing::film && scene.view_hulls)
        return scene.view_hulls->of_film(scene, animations, axes, turned);
      return view_hulls(scene, {animations, job.camera.framing == Framing::film ? nullptr : &out.pose}, axes, turned);
    };
    const DrawnBounds bounds([&] { return world_bounds(scene, out.pose); }, outlines);
    auto view = make_view(scene, out.pose, camera_at(job.camera, time_s), job.width_px, job.height_px, bounds);
    if (!view) return std::unexpected(view.error());
    out.view = std::move(*view);
    if (const PictureWindow w = picture_window(job); w.width_px != w.display_width || w.height_px != w.display_height)
      out.view = with_overscan(std::move(out.view), double(w.width_px) / w.display_width,
                               double(w.height_px) / w.display_height);
    place_probe(scene, out.pose, out.view, bounds);
  }
  if (subframe && subframe->role == SubframePart::Role::subframe) {
    auto window = seen_by_subframe(scene, job, *subframe, out);
    if (!window) return std::unexpected(window.error());
    out.window = *window;
  }
  fill_frame_data(scene, out.pose, out.view, lamp_radius_m, on_device, cells, out.data);
  return {};
}

Expected<PosedScene> pose_before(const Scene& scene, const Job& job, double time_s, const Pose& now) {
  double before_s = time_s - job.motion_s;
  const std::vector<double> cuts = camera_cuts(scene, job);
  if (const auto next = std::ranges::upper_bound(cuts, time_s); next != cuts.begin())
    before_s = std::max(before_s, *std::prev(next));
  auto before = pose_scene(scene, job, before_s);
  if (!before)
    return fail(before.error().kind, before.error().place,
                "{} (at {} s, the time before, which the layer motion needs)", before.error().message, before_s);
  if (before->pose.node_visible == now.node_visible) return before;
  before->pose.node_visible = now.node_visible;
  before->data = make_frame_data(scene, before->pose, before->view);
  return before;
}

}  // namespace candela
