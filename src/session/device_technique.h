#pragma once
#include <string>

#include "base/error.h"
#include "plan/plan_frame.h"

namespace candela {

// What the technique `auto` is on the device that `which` means (gpu/device.h, DeviceOptions), without opening it. For
// what names techniques before it renders: rows of a benchmark say what was measured. Errors (device): as opening it.
Expected<ChosenTechnique> device_technique(const std::string& which);

}  // namespace candela
