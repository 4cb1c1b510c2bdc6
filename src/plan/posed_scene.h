#pragma once
#include "gltf/gltf.h"
#include "job/job.h"
#include "plan/subframes.h"
#include "scene/frame_data.h"
#include "scene/posed_parts.h"

namespace candela {

// The job's scene, with its probe.
Expected<Scene> load_scene(const Job& job, LoadFor use = LoadFor::raster);

// A scene at one time, seen as the job asks.
struct PosedScene {
  Pose pose;
  View view;
  FrameData data;
  ImageWindow window;  // of a subframe
  PoseState state;
};
// subframe: what the view is moved to and widened by; null: it is the picture's.
// parts: those of the job's animations; null: they are found anew. lamp_radius_m: of lamps that say nothing of their
// own size. view: instead of the job's, and without its probe. on_device and cells: as make_frame_data takes them.
Expected<PosedScene> pose_scene(const Scene& scene, const Job& job, double time_s, double lamp_radius_m = 0,
                                const View* view = nullptr, const DevicePose& on_device = {}, double cells = 1,
                                const Subframe* subframe = nullptr);
// out: whatever it held, its memory is used again.
Expected<void> pose_scene(const Scene& scene, const Job& job, const PosedParts* parts, double time_s,
                          double lamp_radius_m, const View* view, const DevicePose& on_device, double cells,
                          const Subframe* subframe, PosedScene& out);

// Whether the bounds of one of these reach into the view.
bool any_in_view(std::span<const DrawItem> items, const View& view);

// Half the diameter of the lens's opening; 0 of orthographic views. How far along the view axis its plane of focus
// lies. Errors (usage): there is no node of that name; it is not before the camera.
double lens_radius_m(const LensLook& lens, const View& view);
Expected<double> focus_m(const Scene& scene, const LensLook& lens, const Pose& pose, const View& view);

// The same scene and camera at Job::motion_s before time_s, but not before the last cut of the camera, with the items
// of `now`, the pose at time_s, one for one: what is visible now, where it was then.
Expected<PosedScene> pose_before(const Scene& scene, const Job& job, double time_s, const Pose& now);

}  // namespace candela
