#pragma once
#include "scene/frame_data.h"
#include "scene/scene.h"

namespace candela {

// Where lights without a range end, so that what they lose matters to no surface.
struct LightEnd {
  float floor_lux = 0;  // a light ends where it gives less; 0: nowhere
  double lost = 0;      // of the light at a point, at most, over the points that were looked at
  bool held = false;    // the lists would grow too long: `lost` is more than was asked for
  double spacing = 0;   // not 0: lights end with stand-ins (stand_ins.h), and `lost` is what those leave wrong
  int layers = 1;       // of them
};

// The largest end at which no point loses more than the fraction `most_lost` of the larger of the light there and a
// hundredth of a white surface's under the exposure. A light's range is a window over all that it reaches (KHR
// lights_punctual): where it gives c, an end at E takes c min(1, (E/c)^2) of it. Points lie on what is drawn, by
// the items' bounds, the same at every frame in which nothing moves; both of their sides count, shadows do not.
// usual_lux: the end whose lists may grow by a half, or to 3.2 / most_lost lights a point; where that is not enough,
// three times as many, shared between the lights themselves and stand-ins that give the rest. Sums over at most four
// million pairs of points and lights: of more lights some stand for all.
LightEnd choose_light_end(const Scene& scene, const FrameData& data, double most_lost, double exposure_ev,
                          double usual_lux);
// Gives lights without a range that end, and appends the stand-ins. Returns how many lights end.
size_t apply_light_end(std::vector<LightItem>& lights, const LightEnd& end);

}  // namespace candela
