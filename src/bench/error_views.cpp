#include "bench/error_views.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "bench/sampling.h"
#include "math/bounds.h"
#include "plan/posed_scene.h"
#include "scene/frame_data.h"
#include "scene/view.h"

namespace candela {
namespace {

struct Seen {
  View view;
  DAabb bounds;
};
Expected<Seen> see(const Scene& scene, const Job& job, double time_s) {
  auto posed = pose_scene(scene, job, time_s);
  if (!posed) return std::unexpected(posed.error());
  return Seen{std::move(posed->view), world_bounds(scene, posed->pose)};
}

// Last key of what plays.
double animation_end_s(const Scene& scene, const Job& job) {
  const auto chosen = choose_animations(scene, job.animation);
  return chosen ? clips_end_s(scene, *chosen) : 0;
}

bool same_place(const View& a, const View& b) {
  return a.position == b.position && a.view_from_relative == b.view_from_relative;
}

BenchView looking(glm::dvec3 eye, glm::dvec3 target, const View& base, double time_s) {
  BenchView view{.time_s = time_s};
  view.camera.eye = eye, view.camera.target = target;
  view.camera.yfov_deg = 2 * std::atan(base.tan_y) * 180 / std::numbers::pi;
  return view;
}

const PictureError* error_in(const BenchRow& row, const std::string& reference) {
  for (const PictureError& error : row.errors)
    if (error.reference == reference) return &error;
  return nullptr;
}

std::vector<double> values_of(const PictureError& error, const std::string& metric) {
  std::vector<double> values;
  const auto add = [&](const std::map<std::string, double>& metrics) {
    if (const auto found = metrics.find(metric); found != metrics.end()) values.push_back(found->second);
  };
  for (const ViewError& view : error.views) add(view.metrics);
  if (error.views.empty()) add(error.metrics);
  return values;
}

// By 95 % intervals that do not meet, which equals do in far fewer than one of 20 cases.
Decision apart(const Interval& a, const Interval& b) {
  if (a.high < b.low) return {Order::less, 0};
  if (b.high < a.low) return {Order::greater, 0};
  return {a.low == a.high && b.low == b.high ? Order::equal : Order::unclear, 1};
}

}  // namespace

Expected<std::vector<BenchView>> views_around(const Scene& scene, const Job& job, double time_s, int count) {
  const auto base = see(scene, job, time_s);
  if (!base) return std::unexpected(base.error());
  std::vector<BenchView> views = {{job.camera, time_s}}, moments = views;
  const double end_s = animation_end_s(scene, job);
  bool moves = false;
  for (int i = 1; i < count && end_s > 0; ++i) {
    moments.push_back({job.camera, std::fmod(time_s + end_s * i / count, end_s)});
    const auto then = see(scene, job, moments.back().time_s);
    if (!then) return std::unexpected(then.error());
    moves = moves || !same_place(base->view, then->view);
  }
  const View& view = base->view;
  if (moves && !job.camera.eye && view.name != "framed bounds") return moments;
  if (!view.perspective) return views;
  const glm::dvec3 eye = view.position;
  // Rows of a rotation are the axes of what it turns to.
  const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));
  for (int i = 1; i < count; ++i) {
    if (view.name == "framed bounds") {
      const glm::dvec3 centre =
          job.camera.target.value_or(base->bounds.empty() ? glm::dvec3(0) : base->bounds.centre());
      const double turn = 2 * std::numbers::pi * i / count;
      const glm::dvec3 from = eye - centre;
      const glm::dvec3 turned(from.x * std::cos(turn) + from.z * std::sin(turn), from.y,
                              from.z * std::cos(turn) - from.x * std::sin(turn));
      views.push_back(looking(centre + turned, centre, view, time_s));
    } else {
      const double turn = 2 * std::numbers::pi * (i - 1) / (count - 1);
      const double right = 0.5 * view.tan_x * std::cos(turn), up = 0.25 * view.tan_y * std::sin(turn);
      views.push_back(looking(eye, eye + axes * glm::dvec3(right, up, -1), view, time_s));
    }
  }
  return views;
}

PictureError error_over(std::vector<PictureError> views) {
  PictureError all = views.front();
  if (views.size() == 1) return all;
  all.metrics.clear(), all.noise.reset();
  NoiseFloor noise;
  size_t noisy = 0;
  for (PictureError& view : views) {
    if (view.metrics.empty()) {
      all.note = view.note.empty() ? "a view was not compared" : view.note;
      all.metrics.clear(), all.views.clear();
      return all;
    }
    for (const auto& [name, value] : view.metrics) {
      double& into = all.metrics[name];
      into = name == "max" ? std::max(into, value) : into + (name == "rmse" ? value * value : value);
    }
    if (view.noise) {
      ++noisy;
      noise.rmse += view.noise->rmse * view.noise->rmse, noise.relmse += view.noise->relmse;
      noise.relmse_sd += view.noise->relmse_sd * view.noise->relmse_sd;
    }
    all.spp = std::min(all.spp, view.spp);
    all.views.push_back({std::move(view.metrics), view.noise});
  }
  const double n = double(views.size());
  for (auto& [name, value] : all.metrics)
    if (name == "rmse")
      value = std::sqrt(value / n);
    else if (name != "max" && name != "differing")
      value /= n;
  if (noisy == views.size())
    all.noise = NoiseFloor{std::sqrt(noise.rmse / n), noise.relmse / n, std::sqrt(noise.relmse_sd) / n};
  return all;
}

Interval error_interval(const PictureError& error, const std::string& metric) {
  const auto value = error.metrics.find(metric);
  if (value == error.metrics.end()) return {};
  // Of max and differing, which are no means, there is no interval over views.
  const bool mean = metric != "max" && metric != "differing" && metric != "rmse";
  Interval interval = mean ? mean_interval(values_of(error, metric)) : Interval{value->second, value->second};
  if (metric == "relmse" && error.noise) {
    constexpr double z = 1.95996;
    // The spread over views holds the noise already, of which it may know less.
    const double noise = z * error.noise->relmse_sd;
    interval.low = std::min(interval.low, value->second - noise) - error.noise->relmse;
    interval.high = std::max(interval.high, value->second + noise);
  }
  return {std::max(interval.low, std::min(0.0, value->second)), interval.high};
}

Decision order_of_errors(const BenchRow& a, const BenchRow& b, const std::string& reference, const std::string& metric,
                         double most_p) {
  const PictureError *of_a = error_in(a, reference), *of_b = error_in(b, reference);
  if (!of_a || !of_b) return {};
  const std::vector<double> in_a = values_of(*of_a, metric), in_b = values_of(*of_b, metric);
  // The same picture has the same error, in however few views.
  if (a.run == b.run && !in_a.empty() && in_a == in_b) return {Order::equal, 1};
  if (metric == "relmse" && of_a->noise && of_a->metrics.contains(metric) && of_b->metrics.contains(metric) &&
      std::abs(of_a->metrics.at(metric) - of_b->metrics.at(metric)) < 3 * of_a->noise->relmse)
    return {};
  if (a.run != b.run || in_a.size() != in_b.size() || in_a.size() < least_pairs)
    return apart(error_interval(*of_a, metric), error_interval(*of_b, metric));
  return paired_order(in_a, in_b, most_p);
}

namespace {

std::vector<int> rounds_of(const BenchRow& row) {
  std::vector<int> rounds = row.rounds;
  for (size_t i = rounds.size(); i < row.gpu.ms.size(); ++i) rounds.push_back(int(i) + 1);
  return rounds;
}

// Medians of a row's samples by round.
std::map<int, double> by_round(const BenchRow& row) {
  std::map<int, std::vector<double>> samples;
  const std::vector<int> rounds = rounds_of(row);
  for (size_t i = 0; i < row.gpu.ms.size(); ++i) samples[rounds[i]].push_back(row.gpu.ms[i]);
  std::map<int, double> medians;
  for (const auto& [round, ms] : samples) medians[round] = median(ms);
  return medians;
}

// The row that was measured again beside others: at the most moments. Null: none was.
const BenchRow* clock_row(std::span<const BenchRow* const> rows) {
  const BenchRow* clock = nullptr;
  size_t most = 1;
  for (const BenchRow* row : rows) {
    std::set<int> moments;
    for (const int round : row->rounds)
      if (round < 0) moments.insert(round);
    if (moments.size() > most) clock = row, most = moments.size();
  }
  return clock;
}

}  // namespace

TimeNoise time_noise(std::span<const BenchRow* const> rows) {
  std::vector<std::span<const double>> samples;
  for (const BenchRow* row : rows) samples.emplace_back(row->gpu.ms);
  TimeNoise noise = noise_of(samples);
  if (const BenchRow* clock = clock_row(rows)) {
    std::vector<double> logs;
    for (const auto& [round, ms] : by_round(*clock))
      if (ms > 0) logs.push_back(std::log(ms));
    if (logs.size() >= 4) noise.moments = 1.4826 * mad(logs), noise.degrees = double(logs.size() - 1);
  }
  return noise;
}

Decision order_of_times(const BenchRow& a, const BenchRow& b, const TimeNoise& noise, double most_p) {
  if (a.run != b.run) return apart(time_interval(a.gpu.ms, noise), time_interval(b.gpu.ms, noise));
  std::vector<double> of_a, of_b;
  const std::map<int, double> in_b = by_round(b);
  for (const auto& [round, ms] : by_round(a))
    if (const auto found = in_b.find(round); found != in_b.end()) of_a.push_back(ms), of_b.push_back(found->second);
  if (of_a.size() >= least_pairs) return paired_order(of_a, of_b, most_p);
  return order_of_samples(a.gpu.ms, b.gpu.ms, noise, most_p);
}

namespace {

template <class P>
double most_p_of_pairs(const std::vector<const BenchRow*>& rows, P&& p_of) {
  std::vector<double> all;
  for (size_t i = 0; i < rows.size(); ++i)
    for (size_t j = 0; j < i; ++j) all.push_back(p_of(*rows[i], *rows[j]));
  return most_sure_p(std::move(all));
}

}  // namespace

ComparedRows::ComparedRows(std::span<const BenchRow* const> rows) : noise_(time_noise(rows)) {
  for (const BenchRow* row : rows)
    if (!row->gpu.ms.empty()) rows_.push_back(row);
  most_time_p_ =
      most_p_of_pairs(rows_, [&](const BenchRow& a, const BenchRow& b) { return order_of_times(a, b, noise_).p; });
}

bool ComparedRows::quicker(const BenchRow& a, const BenchRow& b) const {
  return order_of_times(a, b, noise_, most_time_p_).order == Order::less;
}

bool ComparedRows::no_worse(const BenchRow& a, const BenchRow& b, const std::string& reference,
                            const std::string& metric) {
  const auto [level, made] = most_error_p_.try_emplace({reference, metric});
  if (made)
    level->second = most_p_of_pairs(
        rows_, [&](const BenchRow& c, const BenchRow& d) { return order_of_errors(c, d, reference, metric).p; });
  const Order order = order_of_errors(a, b, reference, metric, level->second).order;
  return order == Order::less || order == Order::equal;
}

std::string clock_change(std::span<const BenchRow* const> rows) {
  const BenchRow* clock = clock_row(rows);
  if (!clock) return {};
  // In the order in which they were taken.
  const std::vector<double>& ms = clock->gpu.ms;
  const size_t third = ms.size() / 3;
  if (third < 3) return {};
  const auto first = std::span(ms).first(third), last = std::span(ms).last(third);
  const double ratio = median(last) / median(first);
  const double within = 1.4826 * std::max(mad(first) / median(first), mad(last) / median(last));
  if (!(std::abs(ratio - 1) > std::max(0.05, 3 * within * std::sqrt(2 / double(third))))) return {};
  return fmt::format(
      "{} took {:.0f} % {} at the end of the run than at its start ({:.3g} ms, {:.3g} ms): clocks or other load "
      "changed; rows are compared by what was measured side by side",
      row_way(*clock), std::abs(ratio - 1) * 100, ratio > 1 ? "longer" : "less", median(last), median(first));
}

}  // namespace candela
