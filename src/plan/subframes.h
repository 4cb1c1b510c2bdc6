#pragma once
#include <span>
#include <vector>

#include "job/picture_camera.h"
#include "passes/post/subframes_knobs.h"
#include "passes/shared/frame_request.h"

namespace candela {

struct PlanContext;

// One of the frames that a picture with a shutter or a lens is the mean of.
struct Subframe {
  SubframePart::Role role = SubframePart::Role::subframe;
  uint32_t index = 0, count = 1;
  double time_s = 0;               // of the open shutter
  double picture_s = 0;            // of the picture, whose exposure all of them have
  glm::dvec2 offset_px{0};         // of samples against the middles of pixels, right and down, within half a pixel
  glm::dvec2 lens{0};              // a point of the unit disc: right and up
  std::optional<LensLook> camera;  // absent: a pinhole
};

// From when to when the shutter of a picture is open, seconds: half before its time and half after it, without what
// lies before or behind a cut of the camera, and not before the film begins. cuts_s: ascending; the picture of a cut's
// own time belongs to what follows.
std::pair<double, double> open_shutter(double picture_s, double shutter_s, std::span<const double> cuts_s);

// Whether an open shutter is one frame's, which is blurred along its motion.
bool gathers(const PictureCamera& camera, const SubframesKnobs& knobs);

// When the camera jumps: keys of interpolation STEP, and two at one time, in what plays, of the camera's field of view
// or of a node that carries it; jumps of a path on which such a node goes, or a node that it looks at. Ascending.
std::vector<double> camera_cuts(const Scene& scene, const Job& job);

// The frames of a picture at a time and, as the last, the one that takes their mean; empty: the picture is one frame.
// Their moments divide the open shutter evenly; places in the pixel and points of the lens are those of Roberts' R
// sequence in four dimensions ("The Unreasonable Effectiveness of Quasirandom Sequences", 2018), shifted by a hash of
// picture and seed.
Expected<std::vector<Subframe>> subframes_of(const Job& job, const PlanContext& context, double time_s);

}  // namespace candela
