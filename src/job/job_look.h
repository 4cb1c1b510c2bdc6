#pragma once
#include "job/job.h"
#include "look/look.h"

namespace candela {

// The job's look file at a time; an empty look where the job names none.
Expected<Look> look_of(const Job& job, double time_s = 0);

// Takes the look's exposure away where f-stop, shutter and ISO speed say it.
void expose_by_camera(const Job& job, Look& look);

// How a picture becomes display values: what the command line says, else the look, else 0 stops and agx. With an ISO
// speed the exposure is the camera's (picture_camera.h), and the job's is added to it.
struct DisplayLook {
  float exposure_ev = 0;
  std::string curve = "agx";
  double agx_min_ev = agx_lowest_ev, agx_max_ev = agx_highest_ev;
};
DisplayLook display_look(const Job& job, const Look& look);

// "street.look.json (beside the scene): fog, bloom"; empty without a look.
std::string look_line(const Job& job, const Look& look);

// What a frame of the GPU leaves out of it, as a line of warning; empty: nothing.
std::string left_out_of(const Job& job, const Look& look);

}  // namespace candela
