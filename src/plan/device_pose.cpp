#include "plan/device_pose.h"

#include "passes/debug/tree_views.h"
#include "passes/geometry/depth_views.h"
#include "passes/geometry/pose_items.h"
#include "passes/lights/pose_lights.h"
#include "passes/occlusion/occlusion.h"
#include "passes/reflections/reflections.h"
#include "passes/shadows/lamp_knobs.h"
#include "passes/shadows/sun_knobs.h"
#include "passes/shared/knob_values.h"
#include "passes/surfaces/refraction.h"

namespace candela {
namespace {

// The host looks at each light where it is of a named group, it chooses lamps for shadow maps, and where it measures
// the air that lights reach.
bool poses_lights_on_device(const FrameRequest& request, const KnobValues& knobs, bool is_cpu, uint32_t instances) {
  const LampKnobs& lamps = knobs.get<LampKnobs>();
  const bool maps = request.wants_true(DepthViews::effect) && !lamps.traced() && lamps.lights != LampKnobs::none;
  return knobs.get<PoseLights::Knobs>().on_device(is_cpu, instances) && !maps && !request.draws_fog() &&
         !request.draws_volumetric() && request.light_groups.empty();
}

// What looks at each item on the host: trees for rays, and the time before.
bool poses_items_on_device(const FrameRequest& request, const KnobValues& knobs, const Technique& technique) {
  const bool occlusion = knobs.get<AmbientOcclusion::Knobs>().sends_rays() &&
                         (request.has_layer("occlusion") || request.wants_true(AmbientOcclusion::effect));
  const bool reflections =
      knobs.get<Reflections::Knobs>().method == Reflections::Knobs::by_rays && request.draws_reflections();
  const bool refraction =
      knobs.get<Refraction::Knobs>().method == Refraction::Knobs::by_rays && request.wants_true(Refraction::effect);
  const bool shadows = request.wants_true(DepthViews::effect) &&
                       (knobs.get<LampKnobs>().traced() || sends_rays(SunMode(knobs.get<SunKnobs>().mode)));
  const bool rays = technique.keys == Technique::Keys::traced || shows_trees(request) || shadows || occlusion ||
                    reflections || refraction;
  return knobs.get<PoseItems::Knobs>().enabled != 0 && !rays && !request.wants_motion();
}

}  // namespace

DevicePose posed_on_device(const FrameRequest& request, const KnobValues& knobs, const Technique& technique,
                           const DevicePose& able, bool is_cpu) {
  const uint32_t lights = able.lights ? able.lights->instance_count : 0;
  return {poses_lights_on_device(request, knobs, is_cpu, lights) ? able.lights : nullptr,
          poses_items_on_device(request, knobs, technique) ? able.instances : nullptr};
}

}  // namespace candela
