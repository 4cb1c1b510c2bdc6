#pragma once
#include "cli/job_options.h"

namespace candela::cli {

// What pictures show and how they are stored.
void add_picture_options(CLI::App& command, JobOptions& o, Renderer renderer);

}  // namespace candela::cli
