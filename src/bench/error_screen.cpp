#include "bench/error_screen.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "metrics/compare.h"
#include "render/outputs.h"

namespace candela {
namespace {

double relmse_of(const FloatImage& truth, const FloatImage& image) {
  const Comparison c = compare(truth, image, {.encoding = Encoding::linear, .perceptual = false});
  const auto found = c.metrics.find("relmse");
  return found == c.metrics.end() || !std::isfinite(found->second) ? INFINITY : found->second;
}

}  // namespace

bool is_number_text(const std::string& value) {
  return value.find_first_not_of("0123456789.eE+-") == std::string::npos;
}

Job with_setting(Job job, const KnobSetting& setting) {
  std::erase_if(job.settings, [&](const KnobSetting& s) { return s.pass == setting.pass && s.knob == setting.knob; });
  job.settings.push_back(setting);
  return job;
}

std::vector<std::string> knob_steps(const KnobRow& knob) {
  std::vector<std::string> values;
  const auto add = [&](const std::string& value) {
    if (value != knob.value_now && std::ranges::find(values, value) == values.end()) values.push_back(value);
  };
  if (!is_number_text(knob.value_now)) {
    for (const std::string& value : knob.sweep) add(value);
    return values;
  }
  const double now = std::strtod(knob.value_now.c_str(), nullptr);
  // The nearest on either side, whichever way the sweep runs, and the exact end.
  const std::string *below = nullptr, *above = nullptr;
  for (const std::string& value : knob.sweep) {
    const double v = std::strtod(value.c_str(), nullptr);
    if (v < now && (!below || v > std::strtod(below->c_str(), nullptr))) below = &value;
    if (v > now && (!above || v < std::strtod(above->c_str(), nullptr))) above = &value;
  }
  for (const std::string* value : {below, above})
    if (value) add(*value);
  if (!knob.sweep.empty()) add(knob.sweep.back());
  return values;
}

Job divided_size(Job job, int divisor) {
  job.width_px = std::max(1, job.width_px / divisor), job.height_px = std::max(1, job.height_px / divisor);
  return job;
}

Expected<SmallPicture> picture_in(Session& session, const Job& job, double time_s, int frames) {
  if (auto set = session.set_settings(job); !set) return std::unexpected(set.error());
  SmallPicture picture{.ms = INFINITY};
  for (int i = 0; i <= frames; ++i) {
    const auto frame = session.render(time_s);
    if (!frame) return std::unexpected(frame.error());
    if (i > 0 || frames == 0) picture.ms = std::min(picture.ms, frame->timings.frame_gpu_ms);
    if (i < frames) continue;
    NonFinite nonfinite;
    picture.image = linear_image(*frame, job, session, std::nullopt, FrameRate{}, nonfinite);
  }
  return picture;
}

Expected<Screen> screen_knobs(Session& session, const ScreenOptions& o, const std::function<bool()>& over) {
  const Job base = divided_size(o.base, o.divisor);
  const auto own = picture_in(session, base, o.time_s, o.frames);
  if (!own) return std::unexpected(own.error());
  Screen screen{.ms = own->ms, .relmse = relmse_of(*o.truth, own->image)};
  const auto own_work = session.work(o.time_s);
  if (!own_work) return std::unexpected(own_work.error());
  std::set<Hash128> own_works;
  std::set<Hash128>& works = o.known ? *o.known : own_works;
  works.insert(own_work->hash);
  // What trades error first: it is what the screen is for.
  std::vector<KnobRow> knobs = knob_rows(base.quality);
  std::erase_if(knobs, [&](const KnobRow& knob) {
    return knob.kind == "look" || (knob.kind == "time" && !o.times) ||
           (!o.knobs.empty() && !o.knobs.contains(knob.pass + "." + knob.knob));
  });
  std::ranges::stable_sort(knobs, {}, [](const KnobRow& knob) { return knob.kind == "error" ? 0 : 1; });
  for (KnobRow& knob : knobs) {
    for (const KnobSetting& s : base.settings)
      if (s.pass == knob.pass && s.knob == knob.knob) knob.value_now = s.value;
    const std::set<std::string> sweep(knob.sweep.begin(), knob.sweep.end());
    const bool whole = o.whole.contains(knob.pass + "." + knob.knob);
    for (const std::string& value : whole ? std::vector(sweep.begin(), sweep.end()) : knob_steps(knob)) {
      if (value == knob.value_now) continue;
      if (over()) {
        ++screen.left;
        continue;
      }
      const Job job = with_setting(base, {knob.pass, knob.knob, value});
      if (!check_job(job) || !session.set_settings(job)) continue;
      const auto work = session.work(o.time_s);
      if (!work || !works.insert(work->hash).second) continue;
      const auto picture = picture_in(session, job, o.time_s, o.frames);
      ++screen.tried;
      if (!picture) continue;
      const ScreenedStep step{job.settings.back(), picture->ms, relmse_of(*o.truth, picture->image)};
      log::debug("screen {}.{}={}: {:.3g} ms ({:.3g}), relmse {:.3g} ({:.3g})", knob.pass, knob.knob, value, step.ms,
                 screen.ms, step.relmse, screen.relmse);
      screen.steps.push_back(step);
    }
  }
  constexpr double least = 1e-12;
  const auto carries = [&](const ScreenedStep& s) {
    return std::abs(std::log(std::max(s.relmse, least) / std::max(screen.relmse, least)));
  };
  std::ranges::stable_sort(screen.steps,
                           [&](const ScreenedStep& a, const ScreenedStep& b) { return carries(a) > carries(b); });
  return screen;
}

}  // namespace candela
