#include "frame/job_look.h"

namespace candela {

Expected<Look> look_of(const Job& job) { return job.look.empty() ? Look{} : read_look(job.look); }

std::string left_out_of(const Job& job, const Look& look) {
  if (!look.fog) return {};
  return fmt::format("the fog of {} is left out: no pass draws it yet (candela reference does)", job.look);
}

}  // namespace candela
