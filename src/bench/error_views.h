#pragma once
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/statistics.h"
#include "bench/row.h"
#include "bench/suite.h"
#include "scene/scene.h"

namespace candela {

// A sweep of error against time renders each setting in all views of its place: one picture says little about a scene.

// `count` views of the job's camera, the first its own. Where the camera moves: moments spread evenly over the
// animation, from time_s on. Where it stands: turned about its place, in a ring of half its field of view to the sides
// and a quarter up and down, so that nothing new comes between eye and scene. Where the scene has no camera: around
// what is framed. An orthographic camera that stands has one view. Errors: those of make_view().
Expected<std::vector<BenchView>> views_around(const Scene& scene, const Job& job, double time_s, int count);

// Of several views: means, but the root of the mean square for rmse, the largest max, and the sum of differing pixels.
// The views stay beside.
PictureError error_over(std::vector<PictureError> views);

// Where the error over all such views lies with 95 % confidence. Noise of the reference only adds to a squared error,
// so relmse reaches down by the noise floor too; of a single view nothing but its noise is known.
Interval error_interval(const PictureError& error, const std::string& metric);

// Which of two rows of the same run has less error: by pairs of views, which share reference and noise; where there are
// too few views for that, by intervals that do not meet.
Order order_of_errors(const BenchRow& a, const BenchRow& b, const std::string& reference, const std::string& metric);
// Which takes less GPU time: by pairs of rounds; of different runs by intervals that do not meet.
Order order_of_times(const BenchRow& a, const BenchRow& b);

}  // namespace candela
