#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/error.h"

namespace CLI {
class App;
}

namespace candela::cli {

// What the chosen command does once all options are read: 0, 1 for a comparison that failed, or an error. Signals that
// ended a run give 128 + the signal's number.
using Action = std::function<Expected<int>()>;

// Each adds its subcommand, with all its options, to the parser, and sets `action` when that command is chosen.
void add_render(CLI::App& app, Action& action);
void add_watch(CLI::App& app, Action& action);
void add_sequence(CLI::App& app, Action& action);
void add_farm(CLI::App& app, Action& action);
void add_reference(CLI::App& app, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_facts(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_tune(CLI::App& app, Action& action);
void add_sheet(CLI::App& app, Action& action);
void add_film(CLI::App& app, Action& action);
void add_golden(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_make_scene(CLI::App& app, Action& action);
void add_list(CLI::App& app, Action& action);
void add_manual(CLI::App& app, Action& action);
void add_commands(CLI::App& app, Action& action);  // all of them

// The line that the process was started with, as a shell takes it.
const std::string& command_line();

// The only ways to stdout. An error when it cannot be written (a full disk behind a redirection).
Expected<void> print(const std::string& text);
Expected<void> print_json(const nlohmann::ordered_json& json);

// Rows under a header line, columns padded to their widest cell.
std::string table_text(const std::vector<std::vector<std::string>>& rows);

}  // namespace candela::cli
