#include "bench/stillness.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>

#include "base/clock.h"
#include "base/log.h"
#include "bench/edges.h"
#include "bench/error_truth.h"
#include "bench/scene_store.h"
#include "bench/suite.h"
#include "metrics/planes.h"
#include "render/outputs.h"
#include "session/session.h"
#include "testscenes/make_scene.h"

namespace candela {
namespace {

constexpr const char* picture_layer = "picture";
// Fractions of light, and the terms that they are of.
struct Fraction {
  const char* layer;
  std::vector<const char*> terms;
};
const std::vector<Fraction>& fractions() {
  static const std::vector<Fraction> all = {
      {"shadow_sun", {"direct_sun"}}, {"shadow_local", {"direct_point", "direct_spot"}}, {"occlusion", {}}};
  return all;
}
// Less light than this part of the picture's mean is nearly none, however much of it arrives: on the rim of what faces
// a light each triangle begins to be lit at once.
constexpr double least_light = 0.05;

// The picture as it is shown, without a tone curve, which renderers share: so that a dark corner counts as the eye
// sees it.
float shown(const FloatImage& image, size_t pixel, float exposure) {
  static constexpr float luminance[3] = {0.2126f, 0.7152f, 0.0722f};
  float y = 0;
  for (size_t c = 0; c < 3; ++c)
    if (const Channel* channel = image.find(std::string(1, "RGB"[c]))) y += luminance[c] * channel->f[pixel];
  return srgb_from_linear(std::clamp(y * exposure, 0.0f, 1.0f));
}

// Empty where the image has no such layer.
std::vector<float> values(const FloatImage& image, const std::string& layer, float exposure) {
  const size_t pixels = size_t(image.width) * size_t(image.height);
  if (layer == picture_layer) {
    std::vector<float> all(pixels);
    for (size_t i = 0; i < pixels; ++i) all[i] = shown(image, i, exposure);
    return all;
  }
  const Channel* channel = image.find(layer + ".Y");
  return channel ? channel->f : std::vector<float>();
}

using Film = std::vector<std::vector<float>>;  // of a layer, by frame

double root_mean_square(double sum, uint64_t count) { return count > 0 ? std::sqrt(sum / double(count)) : 0; }

double second_differences(const Film& film, const std::vector<size_t>& quiet) {
  double sum = 0;
  for (size_t t = 1; t + 1 < film.size(); ++t)
    for (const size_t i : quiet) {
      const double d = double(film[t - 1][i]) - 2 * double(film[t][i]) + double(film[t + 1][i]);
      sum += d * d;
    }
  return root_mean_square(sum, quiet.size() * (film.size() - 2));
}

double differences(const Film& a, const Film& b, const std::vector<size_t>& quiet) {
  double sum = 0;
  for (size_t t = 0; t < a.size(); ++t)
    for (const size_t i : quiet) sum += std::pow(double(a[t][i]) - double(b[t][i]), 2);
  return root_mean_square(sum, quiet.size() * a.size());
}

std::vector<CameraRequest> moving_camera(const StillnessPlace& place, const StillnessOptions& options) {
  const glm::dvec3 ahead = place.target - place.eye;
  const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0)));
  const double pixel_m =
      2 * std::tan(glm::radians(place.yfov_deg) / 2) * glm::length(ahead) / double(options.height_px);
  std::vector<CameraRequest> cameras;
  for (int t = 0; t < options.frames; ++t) {
    const glm::dvec3 moved = right * (pixel_m * options.step_px * t);
    CameraRequest& camera = cameras.emplace_back();
    camera.eye = place.eye + moved, camera.target = place.target + moved, camera.yfov_deg = place.yfov_deg;
  }
  return cameras;
}

// What a place's frames are held against.
struct StillTruth {
  std::vector<FloatImage> frames;
  FloatImage again;  // the first frame, from other samples
  std::vector<size_t> quiet;
  std::map<std::string, std::vector<size_t>> lit;  // those of them where a fraction is of some light
};

// Of the terms together.
std::vector<double> light_of(const FloatImage& image, const std::vector<const char*>& terms) {
  std::vector<double> light(size_t(image.width) * size_t(image.height));
  for (const char* term : terms)
    for (const char c : {'R', 'G', 'B'})
      if (const Channel* channel = image.find(std::string(term) + "." + c))
        for (size_t i = 0; i < light.size(); ++i) light[i] += double(channel->f[i]);
  return light;
}

void keep_lit(std::vector<size_t>& pixels, const FloatImage& unshadowed, const Fraction& fraction) {
  const std::vector<double> light = light_of(unshadowed, fraction.terms);
  const double mean = std::accumulate(light.begin(), light.end(), 0.0) / double(light.size());
  std::erase_if(pixels, [&](size_t i) { return !(light[i] > least_light * mean); });
}

// Where the surface bends away or ends within three pixels: over a plane the inverse of depth is linear in the picture.
// Depth is a mean over the pixel.
bool bends(const FloatImage& image, int x, int y) {
  const Channel* depth = image.find("depth.Z");
  CHECK(depth);
  const auto inverse = [&](int i, int j) {
    return 1 / double(depth->f[size_t(std::clamp(j, 0, image.height - 1)) * size_t(image.width) +
                               size_t(std::clamp(i, 0, image.width - 1))]);
  };
  constexpr double most = 0.03;
  const double here = inverse(x, y);
  return std::abs(inverse(x - 1, y) + inverse(x + 1, y) - 2 * here) > most * here ||
         std::abs(inverse(x, y - 1) + inverse(x, y + 1) - 2 * here) > most * here;
}

Expected<StillTruth> traced(const Job& job, const std::vector<CameraRequest>& cameras, const StillnessOptions& options,
                            const std::function<bool()>& stop) {
  std::vector<TruthView> views;  // each frame from samples of its own
  for (const CameraRequest& camera : cameras) views.push_back({.camera = camera, .seed = views.size() + 1});
  views.push_back({.camera = cameras.front(), .seed = views.size() + 1});
  StillTruth truth;
  for (std::vector<Truth>& of_view : traced_truths(job, views, {"direct"}, {.spp = options.spp}, stop)) {
    if (!of_view.front().failed.empty()) return fail(ErrorKind::input, job.scene, "{}", of_view.front().failed);
    truth.frames.push_back(std::move(of_view.front().divided));
  }
  truth.again = std::move(truth.frames.back());
  truth.frames.pop_back();
  const std::vector<Edges> edges(truth.frames.begin(), truth.frames.end());
  const auto moves = [&](int x, int y) {
    for (size_t t = 0; t < edges.size(); ++t)
      if (edges[t].at(x, y) || bends(truth.frames[t], x, y)) return true;
    return false;
  };
  for (int y = 0; y < job.height_px; ++y)
    for (int x = 0; x < job.width_px; ++x) {
      const size_t i = size_t(y) * size_t(job.width_px) + size_t(x);
      if (!moves(x, y)) truth.quiet.push_back(i);
    }
  const std::vector<TruthView> ends = {{.camera = cameras.front()}, {.camera = cameras.back()}};
  const auto open = traced_truths(job, ends, {open_reference_name}, {.spp = 4}, stop);
  for (const Fraction& fraction : fractions()) {
    std::vector<size_t>& lit = truth.lit[fraction.layer] = truth.quiet;
    for (const std::vector<Truth>& of_view : open)
      if (!fraction.terms.empty()) keep_lit(lit, of_view.front().divided, fraction);
  }
  return truth;
}

class StillnessRun {
 public:
  StillnessRun(const StillnessOptions& options, const RunSettings& settings, const std::function<bool()>& stop)
      : options_(options), settings_(settings), stop_(stop) {}
  Expected<StillnessReport> run();

 private:
  Expected<void> measure(const StillnessPlace& place, Job job);
  Expected<void> measure_quality(const StillnessPlace& place, const Job& job, const std::vector<CameraRequest>& cameras,
                                 const StillTruth& truth);

  const StillnessOptions& options_;
  RunSettings settings_;
  const std::function<bool()>& stop_;
  SceneStore store_;
  StillnessReport report_;
};

Expected<void> StillnessRun::measure_quality(const StillnessPlace& place, const Job& job,
                                             const std::vector<CameraRequest>& cameras, const StillTruth& truth) {
  const auto session = Session::open(job, {.linear = true, .display = false}, settings_);
  if (!session) return std::unexpected(session.error());
  const gpu::DeviceInfo& device = (*session)->device().info();
  report_.device = device.name, report_.driver = device.driver;
  std::vector<FloatImage> frames;
  float exposure = 1;
  for (const CameraRequest& camera : cameras) {
    (*session)->set_camera(camera);
    const auto frame = (*session)->render(0);
    if (!frame) return std::unexpected(frame.error());
    NonFinite nonfinite;
    frames.push_back(linear_image(*frame, job, **session, std::nullopt, FrameRate{}, nonfinite));
    exposure = float(frame->pre_exposure);
  }
  std::vector<std::string> names;
  for (const Fraction& fraction : fractions()) names.emplace_back(fraction.layer);
  names.emplace_back(picture_layer);
  for (const std::string& name : names) {
    Film film, of_truth;
    for (const FloatImage& frame : frames) film.push_back(values(frame, name, exposure));
    for (const FloatImage& frame : truth.frames) of_truth.push_back(values(frame, name, exposure));
    const std::vector<size_t>& quiet = name == picture_layer ? truth.quiet : truth.lit.at(name);
    if (film.front().empty() || of_truth.front().empty() || quiet.empty()) continue;
    StillnessRow& row = report_.rows.emplace_back(
        StillnessRow{.scene = place.scene, .what = place.what, .quality = job.quality, .layer = name});
    row.pixels = quiet.size();
    row.second = second_differences(film, quiet);
    row.error = differences(film, of_truth, quiet);
    // Two pictures of one frame differ by twice the variance of one, a second difference has six times it.
    const double apart = differences({of_truth.front()}, {values(truth.again, name, exposure)}, quiet);
    row.truth_noise = std::sqrt(3.0) * apart;
    const double all = second_differences(of_truth, quiet);
    row.truth_second = std::sqrt(std::max(all * all - row.truth_noise * row.truth_noise, 0.0));
  }
  return {};
}

Expected<void> StillnessRun::measure(const StillnessPlace& place, Job job) {
  const std::vector<CameraRequest> cameras = moving_camera(place, options_);
  job.camera = cameras.front();
  const auto truth = traced(job, cameras, options_, stop_);
  if (!truth) return std::unexpected(truth.error());
  for (const std::string& quality : options_.qualities) {
    if (stop_ && stop_()) return {};
    job.quality = quality;
    if (auto measured = measure_quality(place, job, cameras, *truth); !measured)
      return std::unexpected(measured.error());
  }
  return {};
}

Expected<StillnessReport> StillnessRun::run() {
  const double start_us = process_clock_us();
  for (const StillnessPlace& place : options_.places) {
    if (stop_ && stop_()) break;
    const auto file = store_.generated(place.scene, 1, 0);
    if (!file) return std::unexpected(file.error());
    Job job;
    job.scene = *file;
    job.sky = scene_has_sky(place.scene) ? sky_beside(*file).string() : "";
    job.technique = options_.technique, job.settings = options_.settings;
    job.width_px = options_.width_px, job.height_px = options_.height_px;
    for (const Fraction& fraction : fractions()) job.layers.emplace_back(fraction.layer);
    job.exr_float = true;
    if (auto measured = measure(place, job); !measured)
      return std::unexpected(Error{measured.error().kind, measured.error().text(), place.scene});
  }
  report_.stopped = stop_ && stop_();
  report_.wall_s = (process_clock_us() - start_us) / 1e6;
  return std::move(report_);
}

}  // namespace

std::vector<StillnessPlace> stillness_places() {
  return {
      {"near-world", "a ball on a floor, a sun and a lamp", {0.5, 1.75, 4.5}, {-1.1, 0, -0.4}, 14},
      {"animated", "tiles under lanterns", {0, 2.5, 8.4}, {2.2, 0, 3.2}, 14},
      {"stained", "posts and coloured sheets, a sun and a lamp", {0.3, 1.7, 4.2}, {0, 0, 0}, 18},
      {"cave", "rock under three lamps", {0.5, -0.6, 1.2}, {0.6, -1.2, -5}, 14},
      {"street-dusk", "a pavement under street lamps", {1.15, 1.5, 5.7}, {7.2, 0.4, -7}, 10},
      {"street-dusk", "a car on a wet road", {1.15, 1.5, 5.7}, {-4.2, 0.8, -10}, 10},
  };
}

Expected<StillnessReport> measure_stillness(const StillnessOptions& options, const RunSettings& settings,
                                            const std::function<bool()>& stop) {
  return StillnessRun(options, settings, stop).run();
}

}  // namespace candela
