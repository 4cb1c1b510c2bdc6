#include "cli/shutter_options.h"

#include "job/picture_camera.h"
#include "passes/post/subframes_knobs.h"

namespace candela::cli {

void add_shutter_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--shutter", o.shutter,
                  "Exposure time of each frame, centred on the frame's time: 180deg (of 360 for a whole frame), 1/48s, "
                  "or a part of the frame from 0 to 1; by default the look's, else an instant")
      ->type_name("ANGLE");
  command
      .add_option("--fstop", o.f_stop,
                  "f-stop of the lens, which blurs what is out of focus; 0: a pinhole; by default the look's lens, "
                  "else a pinhole")
      ->check(non_negative_number())
      ->type_name("N");
  command
      .add_option("--focus", o.focus,
                  "Distance of the plane of focus: metres along the view axis, inf, or the name of a node to follow")
      ->type_name("M");
  command
      .add_option("--sensor", o.sensor_mm,
                  "Height of the sensor; together with the field of view it gives the focal length")
      ->check(positive_number())
      ->type_name("MM")
      ->default_str("24");
  command
      .add_option("--subframes", o.subframes,
                  "How many frames are averaged for a picture with a shutter or a lens; by default the quality decides")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command
      .add_option("--iso", o.iso,
                  "Speed of the sensor: it sets the exposure together with --fstop and --shutter, as on a camera; "
                  "--exposure is added")
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
