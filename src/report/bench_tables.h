#pragma once
#include <string>
#include <vector>

#include "bench/run_suite.h"
#include "bench/scaling.h"

// The tables of a bench report, as HTML; every text in them is escaped.
namespace candela {

// "1024 lights, clustered": what tells the rows of one axis apart.
std::string short_label(const BenchRow& row);

std::string summary_table(const std::vector<const BenchRow*>& rows);
std::string passes_table(const std::vector<const BenchRow*>& rows);
std::string memory_table(const std::vector<const BenchRow*>& rows);
std::string fits_table(const std::vector<Scaling>& all);
std::string remarks_list(const std::vector<const BenchRow*>& rows);  // what frames said of themselves; may be empty
std::string left_out_list(const BenchRun& run);                      // and what failed; empty when there is nothing

}  // namespace candela
