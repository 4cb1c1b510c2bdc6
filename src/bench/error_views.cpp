#include "bench/error_views.h"

#include <numbers>

#include "bench/sampling.h"
#include "frame/posed_scene.h"
#include "math/bounds.h"
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

Order apart(const Interval& a, const Interval& b) {
  if (a.high < b.low) return Order::less;
  if (b.high < a.low) return Order::greater;
  return a.low == a.high && b.low == b.high ? Order::equal : Order::unclear;
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

Order order_of_errors(const BenchRow& a, const BenchRow& b, const std::string& reference, const std::string& metric) {
  const PictureError *of_a = error_in(a, reference), *of_b = error_in(b, reference);
  if (!of_a || !of_b) return Order::unclear;
  const std::vector<double> in_a = values_of(*of_a, metric), in_b = values_of(*of_b, metric);
  if (a.run != b.run || in_a.size() != in_b.size() || in_a.empty())
    return apart(error_interval(*of_a, metric), error_interval(*of_b, metric));
  // The same picture has the same error, in however few views.
  if (in_a == in_b) return Order::equal;
  if (in_a.size() < least_pairs) return apart(error_interval(*of_a, metric), error_interval(*of_b, metric));
  return paired_order(in_a, in_b).order;
}

Order order_of_times(const BenchRow& a, const BenchRow& b) {
  if (a.run == b.run) return paired_order(a.gpu.ms, b.gpu.ms).order;
  return apart(median_interval(a.gpu.ms), median_interval(b.gpu.ms));
}

}  // namespace candela
