#pragma once
#include <string>
#include <vector>

#include "scene/pose.h"
#include "scene/survey.h"

namespace candela {

// What the frame would need and no pass draws yet, each by its name for the user; `candela reference` draws it. An
// effect that is built takes its line away here and in README.md.
std::vector<std::string> not_drawn(const SceneFacts& facts, const Pose& pose);

}  // namespace candela
