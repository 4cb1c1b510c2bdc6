#include "cli/shutter_options.h"

#include "job/picture_camera.h"
#include "passes/post/subframes_knobs.h"

namespace candela::cli {

void add_shutter_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--shutter", o.shutter,
                  "How long each picture is exposed, half before its time and half after it: 180deg of 360 a frame, "
                  "1/48s, or a part of the frame from 0 to 1; without it an instant, or the look's")
      ->type_name("ANGLE");
  command
      .add_option(
          "--fstop", o.f_stop,
          "A lens of that f-stop blurs what is off its plane of focus; 0: a pinhole; without it the look's lens")
      ->check(non_negative_number())
      ->type_name("N");
  command
      .add_option("--focus", o.focus,
                  "Where the plane of focus lies: metres along the view axis, inf, or the name of a node that it "
                  "follows")
      ->type_name("M");
  command.add_option("--sensor", o.sensor_mm, "Height of the sensor, which makes a focal length of the field of view")
      ->check(positive_number())
      ->type_name("MM")
      ->default_str("24");
  command
      .add_option("--subframes", o.subframes,
                  "Frames that a picture with a shutter or a lens is the mean of; as the quality says without it")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command
      .add_option("--iso", o.iso,
                  "Speed of the sensor: f-stop, shutter and it say the exposure, as on a camera; --exposure is added")
      ->check(positive_number())
      ->type_name("SPEED");
}

Expected<void> read_shutter(const JobOptions& o, Job& job) {
  if (!o.shutter.empty()) {
    const auto shutter_s = parse_shutter(o.shutter, job.motion_s);
    if (!shutter_s) return std::unexpected(shutter_s.error());
    job.shutter_s = *shutter_s;
  }
  job.f_stop = o.f_stop, job.sensor_mm = o.sensor_mm, job.iso = o.iso;
  job.focus = o.focus;
  if (o.subframes > 0) job.settings.push_back({std::string(SubframesKnobs::name), "n", std::to_string(o.subframes)});
  return {};
}

}  // namespace candela::cli
