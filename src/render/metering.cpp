#include "render/metering.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/reference_frame.h"
#include "render/traced_frames.h"

namespace candela {
namespace {

void add_luminances(const reference::Film& film, std::vector<double>& out) {
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec4 p = film.mean(i);
    const double light = glm::dot(glm::dvec3(p), glm::dvec3(0.2126, 0.7152, 0.0722));
    if (p.w > 0.5 && std::isfinite(light)) out.push_back(light / p.w);
  }
}

double below(std::vector<double>& values, double fraction) {
  const size_t at = std::min(values.size() - 1, size_t(fraction * double(values.size())));
  std::nth_element(values.begin(), values.begin() + long(at), values.end());
  return values[at];
}

}  // namespace

Expected<double> metered_ev(const Job& job) {
  constexpr int longest_px = 64, times = 5;
  Job small = job;
  small.region.reset();
  const double scale = double(longest_px) / std::max(job.width_px, job.height_px);
  if (scale < 1) {
    small.width_px = std::max(1, int(std::lround(job.width_px * scale)));
    small.height_px = std::max(1, int(std::lround(job.height_px * scale)));
  }
  small.technique = Job().technique, small.transparency = Job().transparency;
  small.layers.clear(), small.settings.clear(), small.view = "beauty", small.samples = 0;
  const auto loaded = load_reference(small, reference::Mode::direct);
  if (!loaded) return std::unexpected(loaded.error());
  const auto choice = choose_animations((*loaded)->scene, job.animation);
  if (!choice) return std::unexpected(choice.error());
  const double end_s = clips_end_s((*loaded)->scene, *choice);
  TraceRequest request;
  request.settings.sampler.spp = 4;
  request.stop.spp = 4;
  std::vector<double> luminances;
  for (int i = 0; i < (end_s > 0 ? times : 1); ++i) {
    const double time_s = end_s * i / (times - 1);
    const auto frame = pose_reference(*loaded, small, time_s, request.accel, request.settings.mode);
    if (!frame) return std::unexpected(frame.error());
    reference::Film film = begin_film(small, **frame, request, {}).film;
    const reference::Integrator integrator(*(*frame)->world, request.settings, film.width(), film.height());
    reference::refine(film, integrator, request.stop, [](const reference::Progress&) { return true; });
    add_luminances(film, luminances);
  }
  if (luminances.empty()) return 0;
  const double middle = below(luminances, 0.5), bright = below(luminances, 0.99);
  if (!(bright > 0)) return 0;
  const double widest = std::log2(2 / bright);
  return std::clamp(middle > 0 ? std::min(std::log2(0.18 / middle), widest) : widest, -100.0, 100.0);
}

}  // namespace candela
