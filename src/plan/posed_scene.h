#pragma once
#include "gltf/gltf.h"
#include "job/job.h"
#include "scene/frame_data.h"

namespace candela {

// The job's scene, with its probe.
Expected<Scene> load_scene(const Job& job, LoadFor use = LoadFor::raster);

// A scene at one time, seen as the job asks.
struct PosedScene {
  Pose pose;
  View view;
  FrameData data;
};
// lamp_radius_m: of lamps that say nothing of their own size. view: instead of the job's, and without its probe.
// on_device: as make_frame_data takes it.
Expected<PosedScene> pose_scene(const Scene& scene, const Job& job, double time_s, double lamp_radius_m = 0,
                                const View* view = nullptr, const DevicePose& on_device = {});

// The same scene and camera at Job::motion_s before time_s, with the items of `now`, the pose at time_s, one for one:
// what is visible now, where it was then.
Expected<PosedScene> pose_before(const Scene& scene, const Job& job, double time_s, const Pose& now);

}  // namespace candela
