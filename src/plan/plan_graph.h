#pragma once
#include "plan/plan_frame.h"

namespace candela {

// The last stage of planning: the graph of the frame, or that of an earlier frame of the same shape
// (PlanContext::graphs), and the values that it is recorded with. Errors: dumps of what the frame does not have.
Expected<void> plan_graph(const AskedFrame& asked, const PlanContext& context, const WantedOutputs& wanted,
                          const std::optional<PictureParts>& parts, PlannedFrame& f);

// Whether images of the frame are asked for beside its outputs.
bool asks_dumps(const Job& job, const WantedOutputs& wanted);

}  // namespace candela
