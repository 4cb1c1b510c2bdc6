#pragma once
#include "job/frame_knobs.h"
#include "scene/frame_data.h"
#include "techniques/technique.h"

namespace candela {

// Of the instances that the device is able to pose, those that it does pose in this frame; null: the host, which needs
// to look at each. is_cpu: of the device.
DevicePose posed_on_device(const FrameRequest& request, const KnobValues& knobs, const Technique& technique,
                           const DevicePose& able, bool is_cpu);

}  // namespace candela
