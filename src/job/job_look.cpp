#include "job/job_look.h"

#include "base/text.h"
#include "job/frame_knobs.h"
#include "job/picture_camera.h"
#include "passes/shadows/sun_knobs.h"

namespace candela {

Expected<Look> look_of(const Job& job, double time_s) {
  return job.look.empty() ? Look{} : read_look(job.look, time_s);
}

void expose_by_camera(const Job& job, Look& look) {
  if (job.iso) look.exposure = {};
}

DisplayLook display_look(const Job& job, const Look& look) {
  const ToneMapping& tone = look.tone_mapping;
  DisplayLook out{.agx_min_ev = tone.agx_min_ev, .agx_max_ev = tone.agx_max_ev};
  out.exposure_ev = job.exposure_ev.value_or(float(look.exposure.ev.value_or(0)));
  if (job.iso)
    if (const auto camera = picture_camera(job, look); camera && camera->shutter_s > 0) {
      const double f_stop = camera->lens ? camera->lens->f_stop : job.f_stop.value_or(1);
      out.exposure_ev = float(camera_exposure_ev(f_stop, camera->shutter_s, *job.iso)) + job.exposure_ev.value_or(0);
    }
  if (!job.tonemap.empty() || !tone.curve.empty()) out.curve = job.tonemap.empty() ? tone.curve : job.tonemap;
  return out;
}

std::string look_line(const Job& job, const Look& look) {
  if (job.look.empty()) return {};
  const std::vector<std::string> names = switched_on(look);
  const bool beside = std::filesystem::path(job.look) == look_beside(job.scene);
  return fmt::format("{}{}: {}", job.look, beside ? " (beside the scene)" : "",
                     names.empty() ? "switches nothing on" : joined(names));
}

std::string left_out_of(const Job& job, const Look& look) {
  if (!look.sun || !(look.sun->angular_radius_deg > 0)) return {};
  const auto knobs = frame_knobs(job);
  if (!knobs) return {};
  const SunKnobs& suns = knobs->get<SunKnobs>();
  if (sends_rays(SunMode(suns.mode)) || suns.soft == SunKnobs::pcss) return {};
  return fmt::format("the sun's disc of {} is left out: sun.soft is hard", job.look);
}

}  // namespace candela
