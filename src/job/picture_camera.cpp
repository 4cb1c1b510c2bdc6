#include "job/picture_camera.h"

#include <charconv>
#include <cmath>

#include "base/text.h"

namespace candela {
namespace {

bool wants(const Job& job, std::string_view effect) {
  if (job.effects == "auto" || job.effects == "none") return job.effects == "auto";
  const std::vector<std::string> names = split(job.effects, ',');
  return std::ranges::find(names, effect) != names.end();
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

Expected<PictureCamera> picture_camera(const Job& job, const Look& look) {
  PictureCamera camera;
  if (job.shutter_s)
    camera.shutter_s = *job.shutter_s;
  else if (look.shutter && wants(job, "shutter"))
    camera.shutter_s = look.shutter->angle_deg / 360 * job.motion_s;
  if (look.lens && wants(job, "lens")) camera.lens = look.lens;
  if (job.f_stop && *job.f_stop == 0) camera.lens.reset();
  if (job.f_stop && *job.f_stop > 0) {
    if (!camera.lens) camera.lens = look.lens.value_or(LensLook{});
    camera.lens->f_stop = *job.f_stop;
  }
  if (camera.lens && !job.focus.empty()) {
    const std::optional<double> metres =
        job.focus == "inf" ? std::numeric_limits<double>::infinity() : number_of(job.focus);
    camera.lens->focus_m = metres.value_or(0);
    camera.lens->focus_node = metres ? "" : job.focus;
    if (metres && !(*metres > 0))
      return fail(ErrorKind::usage, "--focus", "{} m is not in front of the camera; give a distance above 0",
                  job.focus);
  }
  if (camera.lens && job.sensor_mm) camera.lens->sensor_mm = *job.sensor_mm;
  if (camera.lens && camera.lens->focus_m == 0 && camera.lens->focus_node.empty())
    return fail(ErrorKind::usage, "--focus",
                "a lens (--fstop) needs a plane of focus: metres along the view axis, inf, or the name of a node");
  if (job.iso) {
    const double f_stop = job.f_stop.value_or(camera.lens ? camera.lens->f_stop : 0);
    if (!(f_stop > 0)) return fail(ErrorKind::usage, "--iso", "needs an f-stop for the exposure (--fstop)");
    if (!(camera.shutter_s > 0)) return fail(ErrorKind::usage, "--iso", "needs an open shutter (--shutter)");
  }
  return camera;
}

double camera_exposure_ev(double f_stop, double shutter_s, double iso) {
  return -std::log2(1.2 * f_stop * f_stop / shutter_s * 100 / iso);
}

Expected<double> parse_shutter(const std::string& text, double frame_s) {
  const auto wrong = [&] {
    return fail(ErrorKind::usage, "--shutter",
                "'{}' is not an exposure time; write 180deg (360deg is a whole frame), 1/48s, 0.02s, or a part of the "
                "frame from 0 to 1",
                text);
  };
  const auto without = [&](std::string_view ending) {
    return std::string_view(text).substr(0, text.size() - ending.size());
  };
  std::optional<double> frames;
  if (text.ends_with("deg")) {
    frames = number_of(without("deg"));
    if (frames) *frames /= 360;
  } else if (text.ends_with("s")) {
    const std::string_view seconds = without("s");
    const size_t slash = seconds.find('/');
    frames = number_of(seconds.substr(0, slash));
    if (frames && slash != std::string_view::npos) {
      const std::optional<double> parts = number_of(seconds.substr(slash + 1));
      if (!parts || !(*parts > 0)) return wrong();
      *frames /= *parts;
    }
    if (frames) *frames /= frame_s;
  } else {
    frames = number_of(text);
  }
  if (!frames || !(*frames >= 0)) return wrong();
  // What is as long as a frame but for rounding is as long.
  if (*frames > 1 + 1e-9)
    return fail(ErrorKind::usage, "--shutter", "'{}' is open longer than a frame of {:.6g} s (--fps)", text, frame_s);
  return std::min(*frames, 1.0) * frame_s;
}

}  // namespace candela
