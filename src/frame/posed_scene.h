#pragma once
#include "frame/job.h"
#include "gltf/gltf.h"
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
Expected<PosedScene> pose_scene(const Scene& scene, const Job& job, double time_s);

}  // namespace candela
