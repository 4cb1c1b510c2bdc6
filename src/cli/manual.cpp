#include <CLI/CLI.hpp>
#include <filesystem>

#include "base/files.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/command_tree.h"
#include "cli/completion.h"
#include "cli/docs_page.h"
#include "cli/man_page.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;

struct ManualOptions {
  std::string shell, folder;
  std::vector<std::string> command;
  bool docs = false;
};

using Files = std::vector<std::pair<fs::path, std::string>>;

Expected<int> run_completion(const CLI::App& app, const ManualOptions& o) {
  const CommandEntry program = command_tree(app);
  const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  if (std::find(shells.begin(), shells.end(), o.shell) == shells.end())
    return fail(ErrorKind::usage, "SHELL", "{}", unknown_name("shell", o.shell, shells));
  const auto printed = print(o.shell == "bash"  ? bash_completion(program)
                             : o.shell == "zsh" ? zsh_completion(program)
                                                : fish_completion(program));
  if (!printed) return std::unexpected(printed.error());
  return 0;
}

// As they lie below share/ of an installation.
Files manual_files(const CommandEntry& program) {
  Files files = {{"bash-completion/completions/candela", bash_completion(program)},
                 {"zsh/site-functions/_candela", zsh_completion(program)},
                 {"fish/vendor_completions.d/candela.fish", fish_completion(program)},
                 {"man/man1/candela.1", man_page(program, program)}};
  for (const CommandEntry& c : program.commands)
    files.emplace_back("man/man1/" + page_name(c) + ".1", man_page(c, program));
  return files;
}

Expected<int> write_manual(const CLI::App& app, const ManualOptions& o) {
  const CommandEntry program = command_tree(app);
  Files files;
  if (o.docs)
    for (auto& [name, text] : docs_pages(program)) files.emplace_back(name, std::move(text));
  else
    files = manual_files(program);
  for (const auto& [name, text] : files) {
    const fs::path path = fs::path(o.folder) / name;
    std::error_code failed;
    fs::create_directories(path.parent_path(), failed);
    if (failed) return fail(ErrorKind::output, path.parent_path().string(), "{}", failed.message());
    if (auto written = write_file_atomically(path, text); !written) return std::unexpected(written.error());
  }
  return 0;
}

Expected<int> print_help(const CLI::App& app, const ManualOptions& o) {
  const CLI::App* at = &app;
  std::string prefix;
  for (const std::string& word : o.command) {
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* command : at->get_subcommands([](const CLI::App*) { return true; })) {
      if (!command->get_group().empty()) names.push_back(command->get_name());
      if (command->get_name() == word) next = command;
    }
    if (!next) return fail(ErrorKind::usage, "help", "{}", unknown_name("command", word, names));
    prefix += (prefix.empty() ? "" : " ") + at->get_name();
    at = next;
  }
  // CLI11's help() of the program is that of the command that was parsed, here `help` itself.
  const std::string text =
      at == &app ? app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal) : at->help(prefix);
  if (auto printed = print(text); !printed) return std::unexpected(printed.error());
  return 0;
}

}  // namespace

void add_manual(CLI::App& app, Action& action) {
  auto o = std::make_shared<ManualOptions>();
  CLI::App* completion = app.add_subcommand("completion", "Print a script that completes candela's words in a shell");
  completion->add_option("shell", o->shell, "bash, zsh or fish")->type_name("SHELL")->required();
  completion->callback([o, &app, &action] { action = [o, &app] { return run_completion(app, *o); }; });
  CLI::App* help = app.add_subcommand("help", "Print the help of the program or of a command");
  help->add_option("command", o->command, "Name of a command, also of two words (farm slurm)")->type_name("NAME");
  help->callback([o, &app, &action] { action = [o, &app] { return print_help(app, *o); }; });
  // For the build alone, therefore hidden.
  CLI::App* manual = app.add_subcommand("manual", "Write man pages and completion as an installation has them");
  manual->group("");
  manual->add_option("folder", o->folder, "Folder for man/, bash-completion/ and so on")->type_name("DIR")->required();
  manual->add_flag("--docs", o->docs, "The pages of docs/using/commands instead");
  manual->callback([o, &app, &action] { action = [o, &app] { return write_manual(app, *o); }; });
}

}  // namespace candela::cli
