#pragma once
#include "frame/job.h"
#include "scene/look.h"

namespace candela {

// The job's look file at a time; an empty look where the job names none.
Expected<Look> look_of(const Job& job, double time_s = 0);

// What a frame of the GPU leaves out of it, as a line of warning; empty: nothing.
std::string left_out_of(const Job& job, const Look& look);

}  // namespace candela
