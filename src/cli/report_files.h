#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "report/figures.h"

namespace candela::cli {

// That the folder of --report can be written, before the first sample: an hour of measuring must not end there. Nothing
// without a folder.
Expected<void> prepare_report(const std::string& folder);

// index.html, figures/ with each figure and picture of the page, and the files named. A warning where gnuplot is not
// there. Nothing without a folder.
Expected<void> write_report(const std::string& folder, const std::vector<std::pair<std::string, std::string>>& files,
                            const std::function<std::string(Figures&)>& page);

// "candela 0.1.0, commit gabcdef": this program.
std::string this_program();

}  // namespace candela::cli
