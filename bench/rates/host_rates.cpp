// The host's part of frames on one thread, as JSON: of the first frame and of later ones, milliseconds of processor
// time until the frame is with the device, and of its stages by the clock. Each number is the least and the median of
// the later frames. The device renders in between and does not count.
//   host_rates SCENE FRAMES [DEVICE [TECHNIQUE [EFFECTS [PASS.KNOB=VALUE]...]]]
#include <tbb/global_control.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/statistics.h"
#include "session/session.h"

using namespace candela;
using Json = nlohmann::ordered_json;

namespace {

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

int refused(const Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return int(error.kind);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return refused({ErrorKind::usage, "host_rates SCENE FRAMES [DEVICE [TECHNIQUE [EFFECTS ...]]]", ""});
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Job job;
  job.scene = argv[1];
  job.width_px = 160, job.height_px = 90;
  job.technique = argc > 4 ? argv[4] : "visibility";
  job.effects = argc > 5 ? argv[5] : "none";
  for (int i = 6; i < argc; ++i) {
    const auto setting = parse_knob_setting(argv[i]);
    if (!setting) return refused(setting.error());
    job.settings.push_back(*setting);
  }
  RunSettings settings;
  settings.device = argc > 3 ? argv[3] : "";
  auto session = Session::open(job, {}, settings);
  if (!session) return refused(session.error());
  constexpr const char* stages[] = {"animate", "light_grid", "sun_shadows", "lamp_shadows",
                                    "fog",     "trees",      "plan",        "upload"};
  std::vector<double> begin_ms;
  std::vector<std::vector<double>> stage_ms(std::size(stages));
  for (int i = 0; i < std::max(std::atoi(argv[2]), 2); ++i) {
    const double start = thread_ms();
    const auto ticket = (*session)->begin(i / 24.0);
    begin_ms.push_back(thread_ms() - start);
    if (!ticket) return refused(ticket.error());
    const auto frame = (*session)->finish(*ticket);
    if (!frame) return refused(frame.error());
    for (size_t s = 0; s < std::size(stages); ++s) stage_ms[s].push_back(frame->timings.total(stages[s]));
  }
  const auto later = [](const std::vector<double>& ms) {
    const std::vector<double> rest(ms.begin() + 1, ms.end());
    return Json{{"min", std::ranges::min(rest)}, {"median", median(rest)}, {"count", rest.size()}};
  };
  Json first{{"processor_ms", begin_ms[0]}}, rest{{"processor_ms", later(begin_ms)}};
  for (size_t s = 0; s < std::size(stages); ++s) {
    first[std::string(stages[s]) + "_ms"] = stage_ms[s][0];
    rest[std::string(stages[s]) + "_ms"] = later(stage_ms[s]);
  }
  const Json out = {{"device", (*session)->device().info().name},
                    {"scene", job.scene},
                    {"technique", job.technique},
                    {"effects", job.effects},
                    {"first", first},
                    {"later", rest}};
  std::printf("%s\n", out.dump(1).c_str());
  return 0;
}
