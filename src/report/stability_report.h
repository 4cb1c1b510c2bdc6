#pragma once
#include <string>

#include "report/figures.h"
#include "stability/stability.h"

namespace candela {

// What `bench --suite stability` found as a page: what is wrong first, then its families, pictures of the scenes
// (StabilityOptions::thumbnails) and, folded, every row. program: program_text.
std::string stability_html(const StabilityReport& report, const std::string& program, Figures& figures);

}  // namespace candela
