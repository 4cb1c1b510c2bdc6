#pragma once
#include <string>

#include "bench/tune.h"
#include "report/figures.h"

namespace candela {

// What `tune` found as a page: the settings for each error and time that were asked for, with options to copy, and all
// trials as error against time. errors, times: the levels of the choices. program: program_text.
std::string tune_html(const TuneReport& report, const Job& job, const std::string& scene,
                      const std::vector<TuneChoice>& errors, const std::vector<TuneChoice>& times,
                      const std::string& program, Figures& figures);

}  // namespace candela
