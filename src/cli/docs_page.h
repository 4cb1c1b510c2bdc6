#pragma once
#include <string>
#include <utility>
#include <vector>

#include "cli/command_tree.h"

namespace candela::cli {

// The pages of docs/using/commands in Markdown: file names and texts, a page a command, one for each command inside
// another, and README.md, which lists them. The same at each build: no version, no date, nothing of the machine.
std::vector<std::pair<std::string, std::string>> docs_pages(const CommandEntry& program);

}  // namespace candela::cli
