#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "base/hash.h"
#include "bvh/acceleration_input.h"
#include "bvh/raw_vector.h"
#include "passes/shared/scene_inputs.h"
#include "reference/accel.h"
#include "scene/frame_data.h"

namespace candela {

// The trees of a frame's triangles as shaders/lib/trace.glsl takes them: those of reference/accel.h, for the CPU and
// the device are to meet the same triangles.
struct FrameRays {
  Hash128 key;                  // of all that decides the content
  RawVector<std::byte> bytes;   // a shared::TraceScene and its tables
  uint32_t stack = 1;           // entries that a ray's stack needs at most
  bool blended = false;         // something lets a part of the light through
  AccelerationInput on_device;  // with bvh.traversal: the same triangles, for the device's own trees
  AccelStatistics statistics;
  std::shared_ptr<const std::vector<TreeRange>> ranges;
};

// refraction: surfaces that let light through are drawn so, and rays of light pass them. open_sides: rays of light pass
// single-sided faces from behind (--sides).

// Of the posed geometry: equal keys mean equal trees, whatever frames they are of.
Hash128 rays_key(const Scene& scene, const Pose& pose, const FrameData& data, bool refraction, bool open_sides,
                 const BvhKnobs& knobs);

// Lays out trees that are built; on_device: with what the device's own are built of.
FrameRays lay_out_rays(const Accel& accel, const Scene& scene, const Pose& pose, const FrameData& data,
                       bool refraction = false, bool open_sides = false, bool on_device = false);

// Builds them for a frame.
std::shared_ptr<const FrameRays> make_frame_rays(const Scene& scene, const Pose& pose, const FrameData& data,
                                                 bool refraction, bool open_sides, const BvhKnobs& knobs);

}  // namespace candela
