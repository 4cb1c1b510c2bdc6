#include "cli/render_steps.h"

#include <filesystem>

#include "base/files.h"
#include "base/log.h"
#include "cli/result.h"
#include "job/frame_choices.h"
#include "plan/step_dumps.h"
#include "render/step_pictures.h"
#include "report/steps_page.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
constexpr const char* steps_page_name = "index.html";

bool has_pass(const FramePlan& plan, std::string_view name) {
  return std::ranges::any_of(plan.passes, [&](const PlanPass& pass) { return pass.name == name; });
}

// Buffers are seen in layers of what they hold: lists of lights in counts, keys of triangles in ids and depths.
struct SeenBy {
  std::vector<const char*> passes;  // the first that the frame has is shown with them
  const char* pass;                 // that makes the layers
  std::vector<const char*> layers;
};
const SeenBy seen_by[] = {{{"light_fill", "light_assign"}, "light_heat", {"heatmap_lights", "heatmap_waste"}},
                          {{"rasterize", "trace_keys"}, "layers", {"object_id", "depth"}}};

const char* shown_pass(const SeenBy& seen, const FramePlan& plan) {
  for (const char* pass : seen.passes)
    if (has_pass(plan, pass)) return pass;
  return nullptr;
}

// The job that was rendered, with those layers.
Job looked_at(Job job, const FrameResult& timed) {
  job.technique = timed.request.technique, job.transparency = timed.request.transparency;
  for (const SeenBy& seen : seen_by)
    for (const char* layer : seen.layers)
      if (shown_pass(seen, *timed.plan) && std::ranges::find(job.layers, layer) == job.layers.end())
        job.layers.emplace_back(layer);
  return job;
}

}  // namespace

Expected<void> check_steps(const std::string& folder, const Job& job) {
  if (job.region)
    return fail(ErrorKind::usage, "--steps", "looks at whole images of a frame, of which --region leaves parts empty");
  std::error_code failed;
  if (fs::exists(fs::path(folder) / steps_page_name, failed))
    return fail(ErrorKind::usage, "--steps", "'{}' holds a page already; name another folder", folder);
  fs::create_directories(folder, failed);
  if (failed) return fail(ErrorKind::output, "--steps", "'{}': {}", folder, failed.message());
  return {};
}

Expected<void> write_steps(const std::string& folder, const Job& job, const RunSettings& settings,
                           const FrameResult& timed, const std::string& device) {
  WantedOutputs wanted;
  wanted.display = true;
  wanted.dumps = {DumpRequest{std::string(every_image), 0, 0, "--steps"}};
  RunSettings untimed = settings;
  untimed.timed = untimed.overlap = false;
  const Job again = looked_at(job, timed);
  auto session = Session::open(again, wanted, untimed);
  if (!session) return std::unexpected(session.error());
  const auto frame = (*session)->render(timed.time_s);
  if (!frame) return std::unexpected(frame.error());
  auto pictures = write_step_pictures(*frame, again, folder);
  if (!pictures) return std::unexpected(pictures.error());
  for (const SeenBy& seen : seen_by)
    if (const char* shown = shown_pass(seen, *timed.plan); shown && !has_pass(*timed.plan, seen.pass))
      for (StepPicture& picture : *pictures)
        if (picture.pass == seen.pass) picture.pass = shown;
  StepsPage page{.title = fmt::format("The steps of {}", fs::path(job.scene).filename().string()),
                 .facts = {},
                 .plan = *timed.plan,
                 .times = timed.timings.gpu_ms,
                 .frame_ms = timed.timings.frame_gpu_ms,
                 .pictures = std::move(*pictures)};
  page.facts = {
      {"picture", fmt::format("{}x{} at {:.4g} s, {}", timed.width_px, timed.height_px, timed.time_s, timed.view.name)},
      {"technique", fmt::format("{}, quality {}", timed.request.technique, job.quality)},
      {"device", device},
      {"frame", fmt::format("{:.4g} ms on the device, {} passes, {} left out", timed.timings.frame_gpu_ms,
                            timed.plan->passes.size(), timed.plan->left_out.size())},
      {"memory", fmt::format("{:.1f} MiB of images and buffers that the frame makes",
                             double(transient_bytes(*timed.plan)) / 1048576)},
      {"pictures", "of a second run of the same frame whose images are read back; times are of the first"},
      {"plan", timed.plan_hash.hex()}};
  return write_text_output((fs::path(folder) / steps_page_name).string(), steps_page_html(page));
}

}  // namespace candela::cli
