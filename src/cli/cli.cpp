#include "cli/cli.h"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>

#include "base/file_uses.h"
#include "base/log.h"
#include "base/process.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/file_options.h"
#include "cli/help.h"
#include "cli/version.h"
#include "farm/quote.h"
#include "gpu/driver_files.h"
#include "render/current_error.h"

namespace candela::cli {
namespace {

struct VersionOptions {
  bool version = false, json = false;
};

// brief: of what most calls need alone (-h).
void build_parser(CLI::App& app, VersionOptions& o, Action& action, bool brief) {
  app.require_subcommand(0, 1);
  CLI::Option* version = app.add_flag("--version", o.version, "Print the version and exit");
  app.add_flag("--json", o.json, "With --version: what was built in, as JSON")->needs(version);
  app.set_help_all_flag("--help-all", "Print the help of every command");
  add_commands(app, action);
  complete_help(app, brief);
}

// The command that was chosen: `check` of `golden check`.
const CLI::App& leaf_of(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : leaf_of(*chosen.front());
}

std::string command_of(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? "candela" : "candela " + chosen.front()->get_name();
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App* a) { return !a->get_group().empty(); }))
    names.push_back(sub->get_name());
  return names;
}

// The first word that is no option, after `skipped` others.
std::string word_of(int argc, char** argv, int skipped) {
  for (int i = 1; i < argc; ++i)
    if (argv[i][0] != '-' && skipped-- == 0) return argv[i];
  return {};
}

// "Could not convert: --time = abc"
std::string not_a_number(const CLI::App& command, std::string_view what) {
  constexpr std::string_view head = "Could not convert: ", equals = " = ";
  const size_t split = what.find(equals);
  if (!what.starts_with(head) || split == std::string_view::npos) return std::string(what);
  const std::string name(what.substr(head.size(), split - head.size()));
  const CLI::Option* option = command.get_option_no_throw(name);
  const std::string type = option ? option->get_type_name() : "";
  return fmt::format("{}: '{}' is not a number{}; write for example {} 2", name, what.substr(split + equals.size()),
                     type.empty() || type == "FLOAT" || type == "INT" ? "" : fmt::format(" ({})", type), name);
}

// CLI11's own messages name neither what is allowed nor what was nearly right.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const auto chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::vector<std::string> names = subcommand_names(command);
  if (!names.empty() && command.get_subcommands().empty()) {
    const std::string word = word_of(argc, argv, chosen.empty() ? 0 : 1);
    if (!word.empty()) return unknown_name("command", word, names);
    if (!chosen.empty()) return fmt::format("{} needs one of: {}", command.get_name(), joined(names));
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
    for (std::string extra : app.remaining(true)) {
      if (!extra.starts_with('-')) return fmt::format("there is one '{}' too many on the command line", extra);
      extra = extra.substr(0, extra.find('='));
      const std::string near = nearest_name(extra, option_names(command));
      return fmt::format("unknown option '{}'{}", extra, near.empty() ? "" : fmt::format("; did you mean '{}'?", near));
    }
  }
  if (dynamic_cast<const CLI::ConversionError*>(&error)) return not_a_number(leaf_of(app), error.what());
  return error.what();
}

int parse_failed(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (error.get_exit_code() == 0) return app.exit(error);  // help and version go to stdout
  log::error("{}", usage_message(app, error, argc, argv));
  log::write(log::Level::error, fmt::format("see {} --help", command_of(app)));
  return int(ErrorKind::usage);
}

constexpr const char* less_memory =
    "A smaller --size, fewer --samples and --layers, a lower --quality or --in-flight take less memory; limits may be "
    "set by ulimit, a container or the batch system";

int failed(const CLI::App& app, const Error& error) {
  log::error("{}", error.text());
  if (error.kind == ErrorKind::usage) log::info("see {} --help", command_of(app));
  if (error.kind == ErrorKind::out_of_memory) log::info("{}", less_memory);
  return int(error.kind);
}

// Of exceptions that no handler can reach: thrown in threads of libraries, or through code that lets none pass.
[[noreturn]] void end_by_exception() {
  if (!std::current_exception()) std::abort();
  const Error error = current_error();
  log::error("{}", error.text());
  if (error.kind == ErrorKind::out_of_memory) log::info("{}", less_memory);
  std::_Exit(int(error.kind));
}

int parse_and_run(CLI::App& app, int argc, char** argv) {
  forget_file_uses();
  Action action;
  VersionOptions version;
  const bool brief = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "-h"; });
  build_parser(app, version, action, brief);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parse_failed(app, error, argc, argv);
  }
  if (version.version) action = [&version] { return print_version(version.json); };
  if (!action) {
    log::error("no command given");
    std::fputs(app.help().c_str(), stderr);
    return int(ErrorKind::usage);
  }
  const Expected<void> files = check_file_options(leaf_of(app));
  const Expected<int> result = files ? action() : std::unexpected(files.error());
  return result ? *result : failed(app, result.error());
}

}  // namespace

void add_commands(CLI::App& app, Action& action) {
  add_render(app, action);
  add_watch(app, action);
  add_sequence(app, action);
  add_farm(app, action);
  add_reference(app, action);
  add_plan(app, action);
  add_facts(app, action);
  add_compare(app, action);
  add_film(app, action);
  add_sheet(app, action);
  add_golden(app, action);
  add_bench(app, action);
  add_tune(app, action);
  add_make_scene(app, action);
  add_list(app, action);
  add_manual(app, action);
}

namespace {
std::string& started_with() {
  static std::string line;
  return line;
}
}  // namespace
const std::string& command_line() { return started_with(); }

namespace {
int run_all(int argc, char** argv) {
  CLI::App app("Renders frames of glTF scenes without a window, and says what each pass cost.", "candela");
  try {
    return parse_and_run(app, argc, argv);
  } catch (...) {
    return failed(app, current_error());
  }
}
}  // namespace

int run(int argc, char** argv) {
  started_with() = shell_quoted(std::vector<std::string>(argv, argv + argc));
  if (!prepare_process()) return int(ErrorKind::output);
  std::set_terminate(end_by_exception);
  gpu::leave_out_drivers();
  return on_a_large_stack([&] { return run_all(argc, argv); });
}

}  // namespace candela::cli
