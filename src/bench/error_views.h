#pragma once
#include <map>
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
// too few views for that, by intervals that do not meet. No difference is sure that is less than three times what the
// reference's noise makes of relmse. most_p: as paired_order() has it.
Decision order_of_errors(const BenchRow& a, const BenchRow& b, const std::string& reference, const std::string& metric,
                         double most_p = sure_p);

// What rows of one run say of how its times vary.
TimeNoise time_noise(std::span<const BenchRow* const> rows);
// Which takes less GPU time: by pairs of rounds; where there are too few, by the least samples and the noise of the
// run; of different runs by intervals that do not meet.
Decision order_of_times(const BenchRow& a, const BenchRow& b, const TimeNoise& noise = {}, double most_p = sure_p);

// Rows that are compared with each other: what is sure of each pair, when all pairs are asked.
class ComparedRows {
 public:
  explicit ComparedRows(std::span<const BenchRow* const> rows);
  bool quicker(const BenchRow& a, const BenchRow& b) const;
  bool no_worse(const BenchRow& a, const BenchRow& b, const std::string& reference, const std::string& metric);

 private:
  std::vector<const BenchRow*> rows_;
  TimeNoise noise_;
  double most_time_p_ = sure_p;
  std::map<std::pair<std::string, std::string>, double> most_error_p_;  // by reference and metric
};

// That the row which was measured again and again became slower or quicker, with how much; empty where it did not.
std::string clock_change(std::span<const BenchRow* const> rows);

}  // namespace candela
