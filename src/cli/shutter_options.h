#pragma once
#include "cli/job_options.h"

namespace candela::cli {

// --shutter, --fstop, --focus, --sensor, --subframes and --iso.
void add_shutter_options(CLI::App& command, JobOptions& o);
// What they say, for a job whose frame rate is known.
Expected<void> read_shutter(const JobOptions& o, Job& job);

}  // namespace candela::cli
