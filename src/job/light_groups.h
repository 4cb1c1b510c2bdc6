#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "job/job.h"
#include "scene/frame_data.h"

namespace candela {

// Layers of the job's groups of lights, and last that of all others; empty without groups.
std::vector<std::string> light_group_layers(const Job& job);
// Names that layers can have, each once. Errors: usage.
Expected<void> check_light_groups(const std::vector<LightGroupRequest>& groups);
// Of each light its group's place among the layers. Lights that are added to the frame later (suns of a sky, stand-ins)
// are of no group. Errors (usage): a name that no node with a light has, and a light of two groups.
Expected<std::vector<uint32_t>> light_group_of(const Job& job, const Scene& scene,
                                               const std::vector<LightItem>& lights);

}  // namespace candela
