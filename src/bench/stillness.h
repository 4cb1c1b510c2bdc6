#pragma once
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "job/job.h"

namespace candela {

// How much a picture boils under a slowly moving camera: frames know nothing of each other, so that noise that stands
// on the screen crawls over surfaces. Of a value f of a pixel in frames t-1, t, t+1 the second difference
// f(t-1) - 2 f(t) + f(t+1) is small where what moves through the pixel is smooth, and three times a change's size where
// it comes and goes. Measured away from the edges of objects, against the same of traced frames.

// A view that moves to the right by a part of a pixel a frame, at the distance of its target.
struct StillnessPlace {
  std::string scene;  // generated
  std::string what;
  glm::dvec3 eye{0}, target{0};  // metres
  double yfov_deg = 10;
};
std::vector<StillnessPlace> stillness_places();

struct StillnessOptions {
  std::vector<StillnessPlace> places;
  std::vector<std::string> qualities = {"draft", "normal", "high"};
  std::vector<KnobSetting> settings;
  std::string technique = "clustered";
  int width_px = 160, height_px = 90, frames = 12;
  double step_px = 0.25;
  uint64_t spp = 64;  // of the traced frames
};

// A layer of a place at a quality. Root mean squares over the pixels that lie off edges in every frame.
struct StillnessRow {
  std::string scene, what, quality, layer;  // layer: shadow_sun, shadow_local, occlusion, or picture (display values)
  uint64_t pixels = 0;
  double second = 0;        // second difference over frames
  double truth_second = 0;  // of traced frames, their own noise taken off
  double truth_noise = 0;   // what was taken off, as a second difference
  double error = 0;         // difference from the traced frames, with their noise
  double ratio() const { return truth_second > 0 ? second / truth_second : 0; }
};
struct StillnessReport {
  std::vector<StillnessRow> rows;
  std::string device, driver;
  double wall_s = 0;
  bool stopped = false;
};
Expected<StillnessReport> measure_stillness(const StillnessOptions& options, const RunSettings& settings,
                                            const std::function<bool()>& stop);

}  // namespace candela
