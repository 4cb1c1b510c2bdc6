#include "bench/error_judge.h"

#include <algorithm>

#include "bench/error_views.h"
#include "bench/measured.h"
#include "bench/picture.h"
#include "metrics/compare.h"
#include "metrics/flip.h"
#include "metrics/heatmap.h"

namespace candela {
namespace {

constexpr int strip_px = 960;
constexpr size_t most_kept_bytes = size_t(1) << 30;  // of pictures that wait for an exact one

std::vector<std::byte> strip_of(const FloatImage& truth, const FloatImage& image, const Comparison& c) {
  if (c.flip_map.empty()) return {};
  return thumbnail_png(side_by_side(display_planes(truth, Encoding::linear), display_planes(image, Encoding::linear),
                                    c.flip_map, c.width, c.height),
                       strip_px);
}

size_t bytes_of(const std::vector<FloatImage>& images) {
  size_t bytes = 0;
  for (const FloatImage& image : images)
    bytes += size_t(image.width) * size_t(image.height) * image.channels.size() * sizeof(float);
  return bytes;
}

// Exposures of the place, so that hdr-flip means the same in all of its rows.
std::optional<ExposureRange> exposures_of(const std::vector<Truth>& truths, const std::string& claimed) {
  for (const Truth& truth : truths)
    if (truth.failed.empty() && truth.name == claimed) {
      const auto plane = [&](const char* name) { return truth.image.find(name)->f; };
      return automatic_exposures({plane("R"), plane("G"), plane("B")});
    }
  return {};
}

}  // namespace

ErrorJudge::ErrorJudge(std::vector<std::vector<Truth>> truths, std::string claimed,
                       const std::optional<ExposureRange>& exposures, bool hdr_flip)
    : truths_(std::move(truths)),
      claimed_(std::move(claimed)),
      exposures_(exposures || truths_.empty() ? exposures : exposures_of(truths_.front(), claimed_)),
      hdr_flip_(hdr_flip) {}

void ErrorJudge::see(const SweepRow& planned, BenchRow& row, std::vector<FloatImage> images) {
  const bool whole = planned.suite == "whole", is_exact = whole && row.quality == "exact";
  row.truth = claimed_;
  row.knobs = planned.knobs;
  row.same_work = planned.same_work;
  row.lists_note = "not counted in sweeps of errors";
  seen_.push_back({&row, std::move(images), whole});
  Seen& seen = seen_.back();
  if (is_exact || seen_.size() == 1)  // within a budget there may be no exact one
    row.thumbnail = thumbnail_png(as_display(display_planes(seen.images.front(), Encoding::linear),
                                             seen.images.front().width, seen.images.front().height),
                                  thumbnail_px);
  if (is_exact) take_exact(row.technique, seen.images);
  for (const SameWork& same : row.same_work)
    if (same.suite == "whole" && same.quality == "exact") take_exact(same.technique, seen.images);
  row.errors.insert(row.errors.begin(), of_exact(row.technique, seen));
  for (SameWork& same : row.same_work)
    if (same.technique != row.technique) same.exact = of_exact(same.technique, seen);
  for (size_t t = 0; !truths_.empty() && t < truths_.front().size(); ++t) {
    std::vector<PictureError> views;
    for (size_t view = 0; view < seen.images.size(); ++view) views.push_back(compared(truths_[view][t], view, seen));
    row.errors.push_back(error_over(std::move(views)));
  }
  if (exact_.contains(row.technique)) seen.images.clear();
  forget_beyond_limit();
}

void ErrorJudge::see_same(const SweepRow& planned, BenchRow& row) {
  const Job& job = planned.configuration.job;
  SameWork& same = row.same_work.emplace_back(
      SameWork{planned.suite, job.technique, job.quality, settings_text(job), job_json(job), planned.knobs, {}});
  const auto seen = std::ranges::find(seen_, &row, &Seen::row);
  if (seen == seen_.end() || seen->images.empty()) return;
  if (same.suite == "whole" && same.quality == "exact" && !exact_.contains(same.technique))
    take_exact(same.technique, seen->images);
  if (same.technique != row.technique) same.exact = of_exact(same.technique, *seen);
}

// Those that were seen before it are compared with it, and need not be kept any longer.
void ErrorJudge::take_exact(const std::string& technique, const std::vector<FloatImage>& images) {
  exact_[technique] = images;
  for (Seen& seen : seen_) {
    if (seen.images.empty() || seen.row->technique != technique || seen.row->errors.empty()) continue;
    seen.row->errors.front() = of_exact(technique, seen);
    if (&seen.images != &images) seen.images.clear();
  }
}

void ErrorJudge::forget_beyond_limit() {
  size_t bytes = 0;
  for (const Seen& seen : seen_) bytes += bytes_of(seen.images);
  for (Seen& seen : seen_) {
    if (bytes <= most_kept_bytes) return;
    bytes -= bytes_of(seen.images);
    seen.images.clear();
  }
}

PictureError ErrorJudge::of_exact(const std::string& technique, const Seen& seen) const {
  const auto own = exact_.find(technique);
  std::vector<PictureError> views;
  for (size_t view = 0; view < seen.images.size(); ++view)
    views.push_back(compared(own == exact_.end()
                                 ? Truth{.name = exact_reference, .failed = "quality exact was not rendered"}
                                 : Truth{.name = exact_reference, .image = own->second[view]},
                             view, seen));
  return error_over(std::move(views));
}

PictureError ErrorJudge::compared(const Truth& truth, size_t view, const Seen& seen) const {
  PictureError error{.reference = truth.name, .note = truth.failed, .spp = truth.spp};
  if (hdr_flip_) error.exposures = exposures_;
  if (!truth.failed.empty()) return error;
  const FloatImage& image = seen.images[view];
  CompareOptions options{.encoding = Encoding::linear};
  if (hdr_flip_) options.hdr_flip = HdrFlipChoice{exposures_};
  const Comparison c = compare(truth.image, image, options);
  error.metrics = c.metrics;
  error.noise = c.noise;
  error.note = c.refusal;
  // Errors of a knob are seen against the exact picture, those of a whole technique against what it claims to draw.
  // Where there is nothing to see there is no strip.
  const auto differing = c.metrics.find("differing");
  const bool differs = differing != c.metrics.end() && differing->second > 0;
  if (view == 0 && differs && truth.name == (seen.whole ? claimed_ : exact_reference))
    seen.row->strip = strip_of(truth.image, image, c);
  return error;
}

}  // namespace candela
