#pragma once
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "frame/session.h"
#include "image/image.h"

namespace candela {

// Which knobs carry the error of a setting, found in small pictures: each knob one step towards the exact end and one
// towards draft, or every other value of a choice, all else as it is.
struct ScreenedStep {
  KnobSetting setting;
  double ms = 0, relmse = 0;  // of the small picture with it
  bool scales = true;         // false: its unit is pixels, which a small picture has fewer of
};
struct Screen {
  double ms = 0, relmse = 0;        // of the setting itself
  std::vector<ScreenedStep> steps;  // those that changed the work; what carries most error first
  int tried = 0, left = 0;          // settings rendered; not reached, for the time was over
};
struct ScreenOptions {
  Job base;                 // at its full size
  double time_s = 0;
  int divisor = 4;          // of width and height
  const FloatImage* truth;  // of the small size
  std::set<std::string> passes;  // knobs of these alone; empty: of all
  int frames = 2;                // timed, of each
};
// session: of the base's scene; its settings are changed. Errors: those of the base's own picture.
Expected<Screen> screen_knobs(Session& session, const ScreenOptions& options, const std::function<bool()>& over);

// A job's size divided, as the small pictures have it.
Job divided_size(Job job, int divisor);
// The linear picture and its GPU time (the least of `frames`, after one that nobody times).
struct SmallPicture {
  FloatImage image;
  double ms = 0;
};
Expected<SmallPicture> picture_in(Session& session, const Job& job, double time_s, int frames);

}  // namespace candela
