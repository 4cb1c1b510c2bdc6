#include <cmath>

#include "cli/job_options.h"
#include "plan/posed_scene.h"

// Which moments of a scene: add_moment_options(), moment_of() and with_all_frames() of job_options.h.
namespace candela::cli {

void add_moment_options(CLI::App& command, MomentOptions& moment) {
  moment.frame_option = command.add_option("--frame", moment.frame, "Frame number; its time is frame/fps")
                            ->transform(whole_number<int64_t>())
                            ->capture_default_str()
                            ->type_name("N");
  moment.time_option =
      command.add_option("--time", moment.time_s, "Time instead of a frame number")->type_name("SECONDS");
  moment.time_option->excludes(moment.frame_option);
}

Expected<Moment> moment_of(const JobOptions& options, const MomentOptions& given) {
  const auto rate = parse_frame_rate(options.fps);
  if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
  if (given.time_option->count() > 0 && given.frame_option->count() > 0)
    return fail(ErrorKind::usage, "--time", "a moment is chosen either by --time or by --frame");
  Moment moment{.rate = *rate};
  if (given.time_option->count() > 0) {
    if (!std::isfinite(given.time_s)) return fail(ErrorKind::usage, "--time", "{} is not a time", given.time_s);
    moment.time_s = given.time_s;
  } else {
    moment.frame = given.frame;
    moment.time_s = rate->seconds(given.frame);
  }
  return moment;
}

Expected<std::string> with_all_frames(const std::string& frames, const Job& job, const std::string& fps) {
  if (frames != "all") return frames;
  const auto rate = parse_frame_rate(fps);
  if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
  const auto scene = load_scene(job);
  if (!scene) return std::unexpected(scene.error());
  const auto choice = choose_animations(*scene, job.animation);
  if (!choice) return std::unexpected(choice.error());
  const double end_s = clips_end_s(*scene, *choice);
  if (!(end_s > 0))
    return fail(ErrorKind::usage, "--frames",
                "all is the length of the animations that play, and none does; write 0-249");
  const double last = std::floor(end_s * double(rate->numerator) / double(rate->denominator) + 1e-6);
  constexpr double most = 9'999'999;
  if (last > most)
    return fail(ErrorKind::usage, "--frames",
                "all would be {:.0f} frames at {} a second; list fewer, for example 0-249", last + 1, fps);
  return fmt::format("0-{}", int64_t(last));
}

}  // namespace candela::cli
