#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace candela::cli {

// The parser as a value, for what is generated from it: man pages, pages of docs/using/commands and shell completion.
// Hidden commands and options are left out.
struct OptionEntry {
  std::vector<std::string> names;  // "-o", "--output"; of a positional one name without dashes
  std::string value;               // what follows it: FILE, N; empty of flags
  std::string range;               // "0 to 8", or empty
  std::string default_value, help, group;
  bool positional = false, repeats = false;
  enum class Files : uint8_t { none, files, folders } files = Files::none;
  std::vector<std::string> choices;  // values that completion offers
  bool list = false;                 // several of them, separated by commas
};

struct CommandEntry {
  std::string path;  // "candela golden check"
  std::string name;  // "check"
  std::string help, footer;
  std::vector<OptionEntry> options;  // positionals first
  std::vector<CommandEntry> commands;
};

CommandEntry command_tree(const CLI::App& app);

// Names of the groups that a command's options stand in, in the order of their first option.
std::vector<std::string> option_groups(const CommandEntry& command);

// What stands at the end of a command's help, in its parts; lines end with a line feed. A footer without exit codes is
// followed by the program's, which has them.
struct FooterParts {
  std::string notes, examples, codes, environment;
};
FooterParts footer_parts(const CommandEntry& command, const CommandEntry& program);

// "candela-golden": the page of a command, and its file without an ending.
std::string page_name(const CommandEntry& command);

}  // namespace candela::cli
