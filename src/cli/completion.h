#pragma once
#include <string>

#include "cli/command_tree.h"

namespace candela::cli {

// Scripts that complete candela's commands, options and values. They call nothing: all names are inside.
std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);
std::string fish_completion(const CommandEntry& program);

}  // namespace candela::cli
