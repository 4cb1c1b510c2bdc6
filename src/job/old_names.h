#pragma once
#include "job/job.h"

namespace candela {

// Layers, effects and tables of knobs that had other names: jobs, suites and scripts of before go on, and a line of the
// log says the new name. Does nothing to names that are not among these.
void take_new_names(Job& job);
// The same for one setting of a knob.
void take_new_names(KnobSetting& setting);

}  // namespace candela
