#pragma once
#include "base/error.h"
#include "job/job.h"

namespace candela {

// --exposure auto: stops for a whole film. Small pictures are traced on the CPU at fixed times of the animations that
// play, from their beginning to their end, so that frames, lists, shards and devices agree. The luminance below which
// half of their covered pixels lie goes to 0.18 of white, as far as that leaves at most one in a hundred a stop above
// white; what the job or its look says of exposure does not count. 0 where nothing is covered or lit.
Expected<double> metered_ev(const Job& job);

}  // namespace candela
