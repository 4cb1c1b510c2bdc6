#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/job_options.h"
#include "session/session.h"

namespace candela::cli {

void log_device(const gpu::DeviceInfo& device);
// A line where no device was asked for and a CPU was taken for want of a GPU; a warning on a farm.
void note_fall_to_cpu(const gpu::DeviceInfo& device, const JobOptions& options, bool on_farm);

// Which look file was read and what it switched on, in the log; as JSON, null without a look.
void log_look(const Job& job, const Look& look);
nlohmann::ordered_json look_json(const Job& job, const Look& look);

// What --json of render and sequence has in common: device, driver, version, job, extensions, warnings.
nlohmann::ordered_json result_head(const Job& job, const Session& session, const std::vector<std::string>& warnings);

// Renders the moment again with every pass's output hashed and says which pass first made a non-finite value.
std::string first_nonfinite_pass(Session& session, double time_s);

// That no two reports ask for stdout and that the folders of their files can be written.
Expected<void> check_reports(const std::string& timings, const std::string& trace, bool json);

// That layers, which PNG and films cannot hold, have an EXR file to go to.
Expected<void> check_layers(const Job& job, bool exr_output);

// "FILE" or "-" for stdout.
Expected<void> write_text_output(const std::string& file, const std::string& text);

}  // namespace candela::cli
