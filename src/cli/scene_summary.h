#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "plan/survey_frame.h"

namespace candela::cli {

// Animations, cameras, lights and bounds of a scene at a frame's time, for `candela facts --json`: keys clips, cameras,
// lights and bounds.
void add_summary(nlohmann::ordered_json& json, const Scene& scene, const Job& job, const SurveyedFrame& frame);

// The same and what is drawn, for people.
std::string summary_text(const Scene& scene, const Job& job, const SurveyedFrame& frame);

}  // namespace candela::cli
