#pragma once
#include <string>

#include "cli/command_tree.h"

namespace candela::cli {

// In roff with the man macros. Commands inside `command` (golden check) are parts of its page; the commands of the
// program itself have pages of their own. The same text at each build: no date.
std::string man_page(const CommandEntry& command, const CommandEntry& program);

}  // namespace candela::cli
