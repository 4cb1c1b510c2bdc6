#pragma once
#include <optional>
#include <string>

#include "look/look.h"
#include "sky/job_sky.h"

namespace candela {

// A job's look as a session reads it, and what of it decides before there are frames.
struct LookRead {
  std::optional<LookFile> file;  // absent: the job names none
  Look at_begin;                 // at 0 s
  std::string motion;            // paths and instances as they are asked for
  std::string skies;             // which skies there are, with their files' contents
  Hash128 content;               // of the scene's files, the sky's and the look
};
Expected<LookRead> read_look_files(const Job& job);                            // all but the last two
Expected<void> hash_look(const Job& job, const Scene& scene, LookRead& look);  // these
// Its warnings are logged.
Expected<JobSky> read_sky(const Job& job, const LookRead& look, const Scene& scene);

}  // namespace candela
