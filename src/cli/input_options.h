#pragma once

namespace CLI {
class App;
}

namespace candela::cli {

// --allow-path and --decode-budget-mb of commands that load scenes: they set the rules of base/input.h.
void add_input_options(CLI::App& command);
// The second alone, of commands that read pictures.
void add_decode_budget(CLI::App& command);

}  // namespace candela::cli
