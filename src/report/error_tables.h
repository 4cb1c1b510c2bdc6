#pragma once
#include <string>

#include "bench/error_analysis.h"
#include "report/error_rows.h"

namespace candela {

// Tables of a sweep of error against time, as HTML. Times are medians with their 95 % confidence intervals.
std::string totals_table(
    const ErrorPlace& place);  // techniques and qualities: total error, of which model, of which sampling
std::string knob_table(const std::vector<KnobStudy>& studies);
std::string error_rows_table(const ErrorPlace& place);  // everything

// "1.23 [1.20, 1.31]".
std::string ms_text(double median, const Interval& ci);

}  // namespace candela
