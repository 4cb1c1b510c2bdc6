#include "frame/job_look.h"

namespace candela {

Expected<Look> look_of(const Job& job, double time_s) {
  return job.look.empty() ? Look{} : read_look(job.look, time_s);
}

std::string left_out_of(const Job& job, const Look& look) {
  if (!look.sun || !(look.sun->angular_radius_deg > 0)) return {};
  return fmt::format("the sun's disc of {} is left out: no pass draws it yet (candela reference does)", job.look);
}

}  // namespace candela
