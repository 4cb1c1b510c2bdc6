#pragma once

namespace CLI {
class App;
}

namespace candela::cli {

// What the help of all commands has in common, once all options are added: options stand in groups, each command ends
// with examples, and CANDELA_NAME in the environment gives --name.
// brief: of each command only what most calls need (-h); else everything (--help).
void complete_help(CLI::App& app, bool brief = false);

}  // namespace candela::cli
