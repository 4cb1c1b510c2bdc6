#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "graph/plan.h"
#include "job/dump_request.h"
#include "techniques/frame.h"

namespace candela {

// What a frame gives for a request. The one of a view is the last.
struct FrameDump {
  DumpRequest request;
  std::string pass;
  ImageDesc image;
  int resource = -1;  // the buffer in the plan, as Dump leaves it
};

// Where each request stands in a frame: of a builder that holds the whole frame, and its plan. Errors (usage): a pass
// or an image that the plan does not have, with those nearest in name; one that nothing reads and that is thus not
// made; a mip or layer outside.
Expected<std::vector<FrameDump>> place_dumps(const std::vector<DumpRequest>& requests, const GraphBuilder& builder,
                                             const FramePlan& plan);

// Adds the dumps of the pass that was added last; sets their resources.
void add_dumps(Frame& frame, const std::string& pass, std::vector<FrameDump>& dumps);

}  // namespace candela
