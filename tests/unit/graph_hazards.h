#pragma once
#include <string>
#include <vector>

#include "graph/plan.h"

namespace candela::test {

// Every hazard of a plan by brute force over all pairs of accesses to the same memory, by the definitions of Vulkan's
// chapter on synchronization: execution chains, availability, visibility, layout, semaphores between queues. Knows
// nothing of how the barriers and batches were found.
std::vector<std::string> find_hazards(const FramePlan& plan);

}  // namespace candela::test
