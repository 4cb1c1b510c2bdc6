#include "cli/result.h"

#include "base/file_uses.h"
#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "base/log_gather.h"
#include "cli/command.h"
#include "cli/scene_notes.h"
#include "job/job_look.h"
#include "render/frame_names.h"
#include "session/timings.h"

namespace candela::cli {

void log_device(const gpu::DeviceInfo& device) {
  log::headline("device {}: {} ({})", device.index, device.name, device.driver);
}

void note_fall_to_cpu(const gpu::DeviceInfo& device, const JobOptions& o, bool on_farm) {
  if (!device.is_cpu || !o.device.empty() || o.allow_cpu) return;
  const std::string line = fmt::format(
      "no GPU that can be used was found: frames are drawn on the CPU by {} (--device gpu refuses that, --allow-cpu "
      "accepts it)",
      device.name);
  on_farm ? log::warning("{}", line) : log::info("{}", line);
}

void log_look(const Job& job, const Look& look) {
  if (const std::string line = look_line(job, look); !line.empty()) log::info("look {}", line);
}

nlohmann::ordered_json look_json(const Job& job, const Look& look) {
  if (job.look.empty()) return nullptr;
  const bool beside = std::filesystem::path(job.look) == look_beside(job.scene);
  return {{"file", job.look}, {"beside_scene", beside}, {"switched_on", switched_on(look)}};
}

nlohmann::ordered_json result_head(const Job& job, const Session& session, const std::vector<std::string>& warnings) {
  nlohmann::ordered_json j;
  j["version"] = CANDELA_VERSION;
  j["device"] = device_json(session.device().info());
  j["driver"] = session.device().info().driver;
  j["job"] = own_json(job_json(job));
  const auto look = look_of(job);
  j["look"] = look ? look_json(job, *look) : nlohmann::ordered_json();
  j["scene_content"] = session.scene_content().hex();
  j["extensions"] = extensions_json(session.scene());
  j["warnings"] = session.scene().warnings;
  for (const std::string& warning : warnings) j["warnings"].push_back(warning);
  return j;
}

std::string first_nonfinite_pass(Session& session, double time_s) {
  const auto again = session.render(time_s, true);
  if (!again) return "; which pass made the first could not be found: " + again.error().message;
  for (const gpu::PassHash& hash : again->hashes)
    if (hash.nonfinite > 0)
      return fmt::format("; the first pass that made one is {} ({} values in {})", hash.pass, hash.nonfinite,
                         hash.resource);
  return "; no pass left one in an image of its own";
}

Expected<void> check_reports(const std::string& timings, const std::string& trace, bool json) {
  if (timings == "-" && json)
    return fail(ErrorKind::usage, "--timings", "- and --json both ask for stdout; --json holds the timings");
  if (trace == "-" && json) return fail(ErrorKind::usage, "--trace", "- and --json both ask for stdout");
  if (timings == "-" && trace == "-") return fail(ErrorKind::usage, "--trace", "- and --timings - both ask for stdout");
  for (const std::string& file : {timings, trace})
    if (!file.empty() && file != "-")
      if (auto ready = prepare_output(file); !ready) return ready;
  return {};
}

Expected<void> check_layers(const Job& job, bool exr_output) {
  if (!job.layers.empty() && !exr_output) return fail(ErrorKind::usage, "--layers", "layers need an EXR output");
  return {};
}

Expected<void> write_text_output(const std::string& file, const std::string& text) {
  if (auto fine = check_output(file); !fine) return fine;
  return file == "-" ? print(text) : write_file_atomically(file, text);
}

}  // namespace candela::cli
