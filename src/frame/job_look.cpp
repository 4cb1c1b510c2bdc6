#include "frame/job_look.h"

namespace candela {

Expected<Look> look_of(const Job& job, double time_s) {
  return job.look.empty() ? Look{} : read_look(job.look, time_s);
}

std::string left_out_of(const Job& job, const Look& look) {
  const bool disc = look.sun && look.sun->angular_radius_deg > 0;
  if (!look.fog && !disc) return {};
  return fmt::format("the {} of {} {} left out: no pass draws {} yet (candela reference does)",
                     look.fog && disc ? "fog and the sun's disc"
                     : look.fog       ? "fog"
                                      : "sun's disc",
                     job.look, look.fog && disc ? "are" : "is", look.fog && disc ? "them" : "it");
}

}  // namespace candela
