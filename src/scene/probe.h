#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/view.h"

// A sphere before the camera that shows what light arrives there, as lighters set up beside what they film: white and
// grey for brightness and colour, chrome for where it comes from.
namespace candela {

enum class Probe { none, white, grey, chrome };
std::vector<std::string> probe_names();          // without none
Probe probe_from_name(const std::string& name);  // none for every other text

// Adds the sphere (albedo 0.9 or 0.18 without gloss, or a white mirror) as a node that is hidden until place_probe().
// none: the scene stays as it is.
void add_probe(Scene& scene, Probe probe);

// Puts the sphere into the middle of the view, a quarter of the picture's height across and half a metre away, or,
// where what is drawn is small, at a tenth of its size; never nearer than the near plane asks for. bounds: world bounds
// of what is drawn without it.
void place_probe(const Scene& scene, Pose& pose, const View& view, const DrawnBounds& bounds);

}  // namespace candela
