#pragma once
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "image/image.h"
#include "job/frame_choices.h"
#include "session/session.h"

namespace candela {

// Which knobs carry the error of a setting, found in small pictures: each knob one step towards the exact end and one
// towards draft, or every other value of a choice, all else as it is.
struct ScreenedStep {
  KnobSetting setting;
  double ms = 0, relmse = 0;  // of the small picture with it
};
struct Screen {
  double ms = 0, relmse = 0;        // of the setting itself
  std::vector<ScreenedStep> steps;  // those that changed the work; what carries most error first
  int tried = 0, left = 0;          // settings rendered; not reached, for the time was over
};
struct ScreenOptions {
  Job base;  // at its full size
  double time_s = 0;
  int divisor = 4;                     // of width and height
  const FloatImage* truth;             // of the small size
  std::set<std::string> knobs;         // these alone ("occlusion.rays"); empty: all
  std::set<std::string> whole;         // knobs whose whole sweep is tried, of these
  bool times = true;                   // knobs that change nothing but time, too
  std::set<Hash128>* known = nullptr;  // works that need not be rendered again, and are added to; null: the base's own
  int frames = 0;                      // timed, of each, after one that is not; 0: that one
};
// session: of the base's scene; its settings are changed. Errors: those of the base's own picture.
Expected<Screen> screen_knobs(Session& session, const ScreenOptions& options, const std::function<bool()>& over);

// Values beside the knob's own: neighbours in its sweep and its exact end; of a choice all others.
std::vector<std::string> knob_steps(const KnobRow& knob);

bool is_number_text(const std::string& value);          // of a knob: no name of a choice
Job with_setting(Job job, const KnobSetting& setting);  // in the place of another of the same knob
// A job's size divided, as the small pictures have it.
Job divided_size(Job job, int divisor);
// The linear picture and its GPU time: the least of `frames`, after one that is not timed; of 0 that one's.
struct SmallPicture {
  FloatImage image;
  double ms = 0;
};
Expected<SmallPicture> picture_in(Session& session, const Job& job, double time_s, int frames);

}  // namespace candela
