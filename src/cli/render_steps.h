#pragma once
#include <string>

#include "base/error.h"
#include "cli/job_options.h"
#include "session/session.h"

namespace candela::cli {

// `render --steps DIR`: the folder is made, and must hold no page yet.
Expected<void> check_steps(const std::string& folder, const Job& job);
// Renders the frame once more with all its images read back, and writes the page and its pictures. timed: the frame
// without that, with the times of its passes.
Expected<void> write_steps(const std::string& folder, const Job& job, const RunSettings& settings,
                           const FrameResult& timed, const std::string& device);

}  // namespace candela::cli
