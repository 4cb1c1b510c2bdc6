#pragma once
#include <string>

#include "bench/error_analysis.h"
#include "report/error_rows.h"

namespace candela {

// Where the errors of a place's techniques lie, against each reference: at edges, and off edges in which term of beauty
// (bench/error_parts.h). HTML; empty where no error was divided.
std::string parts_table(const ErrorPlace& place);

}  // namespace candela
