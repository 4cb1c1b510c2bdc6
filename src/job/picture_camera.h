#pragma once
#include <optional>

#include "job/job.h"
#include "look/look.h"

namespace candela {

// Shutter and lens of a picture: what the command line says, else the look, as far as --effects leaves it.
struct PictureCamera {
  double shutter_s = 0;          // 0: an instant
  std::optional<LensLook> lens;  // absent: a pinhole
  explicit operator bool() const { return shutter_s > 0 || lens; }
};
// Errors (usage): a lens without focus, a speed without shutter or f-stop.
Expected<PictureCamera> picture_camera(const Job& job, const Look& look);

// Stops by which radiance is multiplied so that 1 is what saturates a sensor of that speed behind a lens that lets 65 %
// through: 1 / (1.2 N^2 / t * 100 / S), with N the f-stop, t the shutter in seconds and S the ISO speed (ISO 12232;
// Lagarde and de Rousiers, "Moving Frostbite to Physically Based Rendering", 2014, 5.1).
double camera_exposure_ev(double f_stop, double shutter_s, double iso);

// "180deg" of 360 a frame, "1/48s" or "0.02s", or a part of the frame from 0 to 1. Error (usage): nothing of these, or
// longer than a frame.
Expected<double> parse_shutter(const std::string& text, double frame_s);

}  // namespace candela
