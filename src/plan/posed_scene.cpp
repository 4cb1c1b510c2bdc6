#include "plan/posed_scene.h"

#include "base/log.h"
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
  add_probe(*scene, probe_from_name(job.probe));
  scene->view_hulls = std::make_shared<KeptViewHulls>();
  return scene;
}

Expected<PosedScene> pose_scene(const Scene& scene, const Job& job, double time_s, double lamp_radius_m,
                                const View* given, const DevicePose& on_device) {
  const auto animations = choose_animations(scene, job.animation);
  if (!animations) return std::unexpected(animations.error());
  PosedScene out;
  out.pose = evaluate_pose(scene, *animations, time_s);
  if (given) {
    out.view = *given;
  } else {
    const auto outlines = [&](const glm::dmat3& axes, bool turned) {
      if (job.camera.framing == Framing::film && scene.view_hulls)
        return scene.view_hulls->of_film(scene, *animations, axes, turned);
      return view_hulls(scene, {*animations, job.camera.framing == Framing::film ? nullptr : &out.pose}, axes, turned);
    };
    const DrawnBounds bounds([&] { return world_bounds(scene, out.pose); }, outlines);
    auto view = make_view(scene, out.pose, camera_at(job.camera, time_s), job.width_px, job.height_px, bounds);
    if (!view) return std::unexpected(view.error());
    out.view = std::move(*view);
    place_probe(scene, out.pose, out.view, bounds);
  }
  out.data = make_frame_data(scene, out.pose, out.view, lamp_radius_m, on_device);
  return out;
}

Expected<PosedScene> pose_before(const Scene& scene, const Job& job, double time_s, const Pose& now) {
  auto before = pose_scene(scene, job, time_s - job.motion_s);
  if (!before)
    return fail(before.error().kind, before.error().place,
                "{} (at {} s, the time before, which the layer motion needs)", before.error().message,
                time_s - job.motion_s);
  if (before->pose.node_visible == now.node_visible) return before;
  before->pose.node_visible = now.node_visible;
  before->data = make_frame_data(scene, before->pose, before->view);
  return before;
}

}  // namespace candela
