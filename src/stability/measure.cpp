#include "stability/measure.h"

#include <cstring>

#include <tbb/parallel_for.h>

#include "base/check.h"
#include "job/job_look.h"
#include "job/picture_window.h"
#include "reference/display.h"
#include "reference/film.h"
#include "reference/integrator.h"
#include "render/reference_frame.h"

namespace candela {
namespace {

glm::dvec4 pixel_of(const Beauty& beauty, double pre_exposure, size_t i) {
  float v[4];
  std::memcpy(v, beauty.bytes.data() + i * sizeof v, sizeof v);
  // As an EXR file gets it: the exposure taken out in double, then rounded.
  return {v[0] / pre_exposure, v[1] / pre_exposure, v[2] / pre_exposure, v[3]};
}
size_t pixels_of(const Beauty& beauty) {
  CHECK(beauty.pixel_bytes == 16);
  return beauty.bytes.size() / 16;
}
// What 32-bit numbers make of a surface's place relative to the camera, as a part of its distance: the corners' and
// three products' roundings, 2^-24 each.
constexpr double position_error = 0x1p-22;

double largest(glm::dvec4 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

double median_light(const TruePicture& truth) {
  std::vector<double> lit;
  for (const glm::dvec4& v : truth.centre)
    if (const double l = largest(v); l > 0 && std::isfinite(l)) lit.push_back(l);
  if (lit.empty()) return 0;
  std::nth_element(lit.begin(), lit.begin() + long(lit.size() / 2), lit.end());
  return lit[lit.size() / 2];
}

}  // namespace

Expected<TruePicture> traced_picture(const Job& job, double time_s, double reach_px, int blocked_samples) {
  const auto frame = open_reference(job, time_s, {});
  if (!frame) return std::unexpected(frame.error());
  reference::TraceSettings settings;
  if (blocked_samples == 0) settings.visibility = false, settings.ambient = reference::Ambient::occlusion;
  const int samples = std::max(blocked_samples, 1);
  const PictureWindow window = picture_window(job);
  const PixelRect& part = window.part;
  const auto integrator_of = [&](double lifted) {
    settings.lifted = lifted;
    return reference::Integrator(*(*frame)->world, settings, window.width_px, window.height_px);
  };
  const reference::Integrator integrator = integrator_of(0), above = integrator_of(position_error),
                              below = integrator_of(-position_error);
  TruePicture truth{part.width, part.height, {}, {}, {}};
  const size_t across = size_t(part.width), count = across * size_t(part.height);
  truth.centre.resize(count), truth.low.resize(count), truth.high.resize(count);
  tbb::parallel_for(size_t(0), count, [&](size_t i) {
    const glm::dvec2 centre(part.x + double(i % across) + 0.5, part.y + double(i / across) + 0.5);
    const auto value_at = [samples](const reference::Integrator& of, glm::dvec2 place) {
      glm::dvec4 sum(0);
      for (int n = 0; n < samples; ++n) {
        const reference::PixelSample sample = of.sample_at(place, uint64_t(n));
        sum += glm::dvec4(sample.radiance, sample.alpha);
      }
      return sum / double(samples);
    };
    const glm::dvec4 value = value_at(integrator, centre);
    truth.centre[i] = truth.low[i] = truth.high[i] = value;
    const auto include = [&](glm::dvec4 v) {
      truth.low[i] = glm::min(truth.low[i], v), truth.high[i] = glm::max(truth.high[i], v);
    };
    include(value_at(above, centre)), include(value_at(below, centre));
    // A straight edge that passes the centre within reach parts it from at least one of the places about it.
    for (const glm::dvec2 way : {glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1), glm::dvec2(-1, 1)}) {
      const glm::dvec4 there = value_at(integrator, centre + reach_px * way),
                       back = value_at(integrator, centre - reach_px * way);
      include(there), include(back);
      // Beyond an edge lies something else; the surface itself goes on as it does on the other side.
      const glm::dvec4 step = glm::min(glm::abs(there - value), glm::abs(back - value));
      include(value - step), include(value + step);
    }
  });
  return truth;
}

Expected<uint64_t> nonfinite_paths(const Job& job, double time_s) {
  const auto frame = open_reference(job, time_s, {}, reference::Mode::path);
  if (!frame) return std::unexpected(frame.error());
  reference::TraceSettings settings;
  settings.mode = reference::Mode::path;
  reference::Film film(job.width_px, job.height_px);
  constexpr int samples = 4;
  film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), samples,
           [](double) { return true; });
  uint64_t count = 0;
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::vec4 mean(film.mean(i));  // as files hold it
    count += !(std::isfinite(mean.x) && std::isfinite(mean.y) && std::isfinite(mean.z) && std::isfinite(mean.w));
  }
  return count;
}

TruePicture picture_truth(const Beauty& beauty, double pre_exposure) {
  TruePicture truth{beauty.width_px, beauty.height_px, {}, {}, {}};
  for (size_t i = 0; i < pixels_of(beauty); ++i) truth.centre.push_back(pixel_of(beauty, pre_exposure, i));
  truth.low = truth.high = truth.centre;
  return truth;
}

TruthError picture_error(const Beauty& beauty, double pre_exposure, const TruePicture& truth, double bound,
                         double least_light) {
  CHECK(beauty.width_px == truth.width_px && beauty.height_px == truth.height_px);
  TruthError error;
  const double floor = std::max(0.01 * median_light(truth), least_light);
  double sum = 0, true_sum = 0, within = 0, low_sum = 0, high_sum = 0;
  for (size_t i = 0; i < truth.centre.size(); ++i) {
    const glm::dvec4 v = pixel_of(beauty, pre_exposure, i);
    double worst = 0;
    for (int c = 0; c < 4; ++c) {
      const double low = truth.low[i][c], high = truth.high[i][c];
      const double away = std::max({low - v[c], v[c] - high, 0.0});
      const double least = c == 3 ? 1.0 : floor;
      const double against = std::max({std::abs(low), std::abs(high), least});
      // Where the truth is nowhere but 0, any light is infinitely wrong.
      const double relative = !std::isfinite(v[c]) ? std::numeric_limits<double>::infinity()
                              : away == 0          ? 0
                                                   : away / against;
      worst = std::max(worst, relative);
    }
    for (int c = 0; c < 3; ++c) {
      sum += v[c], true_sum += truth.centre[i][c];
      if (worst <= bound) within += v[c], low_sum += truth.low[i][c], high_sum += truth.high[i][c];
    }
    if (worst > bound) ++error.beyond;
    if (worst > error.max_relative) {
      error.max_relative = worst;
      error.worst_x = int(i % size_t(truth.width_px)), error.worst_y = int(i / size_t(truth.width_px));
    }
  }
  const auto part = [&](double away) {
    return away == 0 ? 0 : true_sum > 0 ? away / true_sum : std::numeric_limits<double>::infinity();
  };
  error.energy = part(sum - true_sum);
  error.energy_beyond = within > high_sum ? part(within - high_sum) : within < low_sum ? part(within - low_sum) : 0;
  return error;
}

PixelCounts count_pixels(const Beauty& beauty, double pre_exposure) {
  PixelCounts counts;
  for (size_t i = 0; i < pixels_of(beauty); ++i) {
    const glm::dvec4 v = pixel_of(beauty, pre_exposure, i);
    if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w)) &&
        counts.nonfinite++ == 0)
      counts.first_x = int(i % size_t(beauty.width_px)), counts.first_y = int(i / size_t(beauty.width_px));
    for (int c = 0; c < 3; ++c) counts.beyond_half += std::isfinite(v[c]) && std::abs(v[c]) > 65504;
    counts.black = counts.black && v.x == 0 && v.y == 0 && v.z == 0;
    counts.most = std::max({counts.most, v.x, v.y, v.z});
  }
  return counts;
}

EffectCounts count_effects(const Beauty* bare, double bare_pre_exposure, const Beauty& drawn, double pre_exposure,
                           double most) {
  EffectCounts counts;
  for (size_t i = 0; i < pixels_of(drawn); ++i) {
    const glm::dvec4 with = pixel_of(drawn, pre_exposure, i);
    const glm::dvec4 allowed =
        glm::min(bare ? pixel_of(*bare, bare_pre_exposure, i) : glm::dvec4(most), glm::dvec4(most));
    bool finite = true, negative = false, brighter = false;
    for (int c = 0; c < 4; ++c) finite = finite && std::isfinite(with[c]);
    for (int c = 0; c < 3; ++c) {
      negative = negative || with[c] < 0;
      brighter = brighter || with[c] > allowed[c] * (1 + 1e-4) + 1e-30;
    }
    counts.nonfinite += !finite, counts.negative += negative, counts.brighter += brighter;
    if ((!finite || negative || brighter) && counts.first_x < 0)
      counts.first_x = int(i % size_t(drawn.width_px)), counts.first_y = int(i / size_t(drawn.width_px));
  }
  return counts;
}

void LayerCounts::add(const FloatImage& layer) {
  for (const Channel& channel : layer.channels) {
    nonfinite += uint64_t(std::ranges::count_if(channel.f, [](float v) { return !std::isfinite(v); }));
    const std::string_view name = channel.name;  // "crypto_object00.G": the coverage by the id in R
    if (!name.starts_with("crypto_") || !(name.ends_with(".G") || name.ends_with(".A"))) continue;
    std::vector<float>& sums = coverage[channel.name.substr(0, name.size() - 4)];
    sums.resize(channel.f.size());
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += channel.f[i];
  }
}

uint64_t LayerCounts::overcovered() const {
  uint64_t pixels = 0;
  for (const auto& [layer, sums] : coverage)
    pixels += uint64_t(std::ranges::count_if(sums, [](float sum) { return !(sum <= 1.00001f); }));
  return pixels;
}

double display_error(const DisplayImage& display, const Beauty& beauty, double pre_exposure, const Job& job) {
  CHECK(display.bits == 16);
  const DisplayLook look = display_look(job, {});
  const double exposure = std::exp2(double(look.exposure_ev));
  double worst = 0;
  for (size_t i = 0; i < pixels_of(beauty); ++i) {
    const glm::dvec4 v = pixel_of(beauty, pre_exposure, i);
    const double alpha = std::clamp(v.w, 0.0, 1.0);
    const glm::dvec3 exposed = glm::max(glm::dvec3(v), 0.0) * exposure / (alpha > 0 ? alpha : 1);
    const glm::dvec3 shown = reference::display_encoded(reference::tone_mapped(look.curve, exposed), look.curve);
    for (int c = 0; c < 3; ++c) {
      uint16_t code;
      std::memcpy(&code, display.pixels.data() + (i * size_t(display.channels) + size_t(c)) * 2, 2);
      const double away = std::abs(code / 65535.0 - shown[c]);
      worst = std::isnan(away) ? std::numeric_limits<double>::infinity() : std::max(worst, away);
    }
  }
  return worst;
}

}  // namespace candela
