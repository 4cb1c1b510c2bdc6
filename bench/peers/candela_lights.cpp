#include <CLI/CLI.hpp>

#include "frame_server.h"
#include "image/io.h"
#include "render/outputs.h"
#include "session/session.h"

// candela's side of the comparison: the session that `candela sequence` uses, one frame a request. The frame is the one
// that a PNG is made of: tone curve "none", sRGB, 8 bits, without dither, which is what the peers deliver.
int main(int argc, char** argv) {
  using namespace candela;
  CLI::App app("Renders frames of a scene when asked to on standard input");
  Job job;
  std::string size = "1280x720";
  RunSettings settings;
  app.add_option("scene", job.scene)->required();
  app.add_option("--size", size);
  app.add_option("--samples", job.samples);
  app.add_option("--technique", job.technique);
  app.add_option("--device", settings.device);
  app.add_option("--shader-dir", settings.shader_folder, "Shaders from a folder, to measure a change of one");
  std::vector<std::string> knobs;
  app.add_option("--look", job.look, "Look file; with the effects of quality high");
  app.add_option("--sky", job.sky);
  app.add_option("--quality", job.quality);
  app.add_option("--set", knobs, "PASS.KNOB=VALUE");
  app.add_flag("--passes", settings.timed, "Time each pass, which submits each alone on a CPU device");
  CLI11_PARSE(app, argc, argv);
  const auto failed = [](const Error& error) {
    std::fprintf(stderr, "%s\n", error.text().c_str());
    return int(error.kind);
  };
  const auto pixels = parse_size(size);
  if (!pixels) return failed(pixels.error());
  std::tie(job.width_px, job.height_px) = *pixels;
  if (job.samples == 0) job.samples = 4;
  if (job.look.empty()) job.effects = "none";  // Filament draws none here
  for (const std::string& knob : knobs) {
    const auto setting = parse_knob_setting(knob);
    if (!setting) return failed(setting.error());
    job.settings.push_back(*setting);
  }
  job.tonemap = "none";
  job.dither = false;
  if (job.sky.empty()) job.background = "0,0,0";
  const auto session = Session::open(job, {.linear = false, .display = true}, settings);
  if (!session) return failed(session.error());
  const gpu::DeviceInfo& device = (*session)->device().info();
  std::optional<FrameResult> last;
  peers::FrameServer server{.about = {{"program", "candela"},
                                      {"version", CANDELA_VERSION},
                                      {"device", device.name},
                                      {"driver", device.driver},
                                      {"device_class", device.device_class}},
                            .frame = [&](double time_s) -> Expected<peers::Json> {
                              last.reset();
                              auto frame = (*session)->render(time_s);
                              if (!frame) return std::unexpected(frame.error());
                              peers::Json answer;
                              for (const auto& [stage, ms] : frame->timings.cpu_ms) answer["cpu_ms"][stage] = ms;
                              for (const gpu::PassTime& pass : frame->timings.gpu_ms) {
                                peers::Json& sum = answer["pass_ms"][pass.name];
                                sum = (sum.is_null() ? 0.0 : sum.get<double>()) + pass.gpu_ms;
                              }
                              last = std::move(*frame);
                              return answer;
                            },
                            .save = [&](const std::string& file) -> Expected<void> {
                              if (!last) return fail(ErrorKind::usage, file, "no frame was rendered yet");
                              return write_png(file, display_image(*last, job));
                            }};
  return server.run();
}
