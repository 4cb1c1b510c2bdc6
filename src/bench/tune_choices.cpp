#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/sampling.h"
#include "bench/tune.h"

// What follows from a report's trials: settled times, the front, the cheapest and the most exact.
namespace candela {
namespace {

// What errors may differ by and still cannot be told apart.
double indistinct(const TuneReport& report, double error) { return std::max(3 * report.noise, 0.01 * error); }

}  // namespace

std::string settle_times(std::vector<TuneTrial>& trials, std::span<const double> clock_ms) {
  // At each moment by three samples: one may be an outlier.
  std::vector<double> smooth;
  for (size_t i = 0; i < clock_ms.size(); ++i) {
    const size_t first = i > 0 ? i - 1 : 0, last = std::min(i + 2, clock_ms.size());
    smooth.push_back(median(clock_ms.subspan(first, last - first)));
  }
  const double middle = median(smooth);
  constexpr double change = 1.25;
  const bool changed =
      smooth.size() >= 3 && *std::ranges::max_element(smooth) > change * *std::ranges::min_element(smooth);
  std::vector<std::vector<double>> settled;
  for (const TuneTrial& t : trials) {
    std::vector<double>& ms = settled.emplace_back(t.gpu_ms);
    for (size_t i = 0; changed && i < ms.size() && i < t.moments.size(); ++i)
      ms[i] *= middle / smooth[std::min(t.moments[i], smooth.size() - 1)];
  }
  const TimeNoise noise = noise_of({settled.begin(), settled.end()});
  for (size_t i = 0; i < trials.size(); ++i)
    if (!settled[i].empty()) trials[i].median_ms = median(settled[i]), trials[i].ms = time_interval(settled[i], noise);
  if (!changed) return {};
  return fmt::format(
      "one setting, measured again and again, took from {:.3g} to {:.3g} ms: clocks or other load changed; all times "
      "are "
      "as they would be where it takes {:.3g} ms",
      *std::ranges::min_element(smooth), *std::ranges::max_element(smooth), middle);
}

std::vector<const TuneTrial*> tune_front(const TuneReport& report) {
  std::vector<const TuneTrial*> order, front;
  for (const TuneTrial& t : report.trials)
    if (t.usable()) order.push_back(&t);
  std::stable_sort(order.begin(), order.end(), [](const TuneTrial* a, const TuneTrial* b) {
    return std::pair(a->median_ms, a->relmse) < std::pair(b->median_ms, b->relmse);
  });
  for (const TuneTrial* t : order)
    if (front.empty() || t->relmse < front.back()->relmse) front.push_back(t);
  return front;
}

std::string quicker_reference(const TuneReport& report) {
  if (!(report.reference_ms > 0) || !(report.noise > 0)) return "";
  for (const TuneTrial* t : tune_front(report)) {
    const double spp =
        std::max(std::ceil(double(report.reference_spp) * report.noise / std::max(t->relmse, 1e-12)), 1.0);
    if (spp * report.reference_ms < t->ms.low)
      return fmt::format(
          "the reference '{}' is the quicker truth from {:.3g} ms on: {} samples a pixel have no larger error than {} "
          "and take {:.3g} ms (candela reference --spp {})",
          report.reference, t->median_ms, spp, t->options, spp * report.reference_ms, spp);
  }
  return "";
}

std::vector<TuneChoice> cheapest_within(const TuneReport& report, std::span<const double> errors) {
  std::vector<TuneChoice> choices;
  for (const double error : errors) {
    TuneChoice choice{error};
    for (const TuneTrial* t : tune_front(report))
      if (t->relmse <= error && !choice.trial) choice.trial = t;
    choices.push_back(choice);
  }
  return choices;
}

const TuneTrial* least_error(const TuneReport& report) {
  const auto front = tune_front(report);
  return front.empty() ? nullptr : front.back();
}

std::vector<TuneChoice> most_exact_within(const TuneReport& report, std::span<const double> ms) {
  std::vector<TuneChoice> choices;
  for (const double most : ms) {
    TuneChoice choice{most};
    for (const TuneTrial* t : tune_front(report))
      if (t->ms.high <= most) choice.trial = t;
    if (choice.trial) {
      const double bound = choice.trial->relmse + indistinct(report, choice.trial->relmse);
      for (const TuneTrial* t : tune_front(report))
        if (t->relmse <= bound && t->median_ms < choice.trial->median_ms) choice.trial = t;
    }
    choices.push_back(choice);
  }
  return choices;
}

}  // namespace candela
