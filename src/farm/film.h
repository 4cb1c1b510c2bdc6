#pragma once
#include "farm/farm_job.h"

namespace candela {

// Makes the film of a job from the frames that it wrote as PNG, in the order of its list: the bytes that `sequence
// --video` gives. All frames must be there.
Expected<void> make_farm_film(const FarmJob& job);

}  // namespace candela
