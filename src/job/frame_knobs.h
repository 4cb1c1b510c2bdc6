#pragma once
#include "base/error.h"
#include "job/job.h"
#include "passes/shared/knob_values.h"

namespace candela {

// The values that a job's quality and settings give to the knobs of all passes. Errors (usage): an unknown pass or
// knob, a value that is not a number or out of range: names what there is.
Expected<KnobValues> frame_knobs(const Job& job);

}  // namespace candela
