#pragma once
#include <functional>
#include <string>

#include "job/job.h"

namespace candela {

// Gives each file that the job's paths and instances name the name that `rename` makes of it; the first error ends it.
Expected<void> rename_motion_files(Job& job, const std::function<Expected<std::string>(const std::string&)>& rename);

}  // namespace candela
