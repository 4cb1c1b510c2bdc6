#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace candela::cli {

// The parser as a value, for what is generated from it: man pages and shell completion. Hidden commands and options are
// left out.
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

}  // namespace candela::cli
