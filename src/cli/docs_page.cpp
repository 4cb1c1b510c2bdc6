#include "cli/docs_page.h"

#include "base/text.h"

namespace candela::cli {
namespace {

constexpr const char* made_by = "<!-- Written by ./run docs from the program's own options. -->\n";

// Text in a cell of a table. Words between < and > would be taken for HTML.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

// In a code span of a table a bar still ends the cell.
std::string code(const std::string& text) {
  std::string out = "`";
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c);
  return out + "`";
}

std::string sentence(std::string text) {
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

std::string synopsis(const CommandEntry& command) {
  std::string line = command.path;
  if (!command.commands.empty()) line += " COMMAND";
  line += " [OPTIONS]";
  for (const OptionEntry& o : command.options)
    if (o.positional) line += " [" + o.value + (o.repeats ? " ...]" : "]");
  return "    " + line + "\n";
}

std::string option_row(const OptionEntry& o) {
  std::string names = o.positional ? (o.value.empty() ? o.names.front() : o.value) : joined(o.names, ", ");
  if (!o.positional && !o.value.empty()) names += " " + o.value;
  if (o.repeats) names += " ...";
  std::string says = cell(sentence(o.help));
  if (!o.range.empty()) says += " " + cell(o.range) + ".";
  if (!o.default_value.empty()) says += " Default: " + code(o.default_value) + ".";
  return "| " + code(names) + " | " + says + " |\n";
}

std::string options_text(const CommandEntry& command) {
  std::string text;
  for (const std::string& group : option_groups(command)) {
    text += "\n## " + group + "\n\n| option | |\n| --- | --- |\n";
    for (const OptionEntry& o : command.options)
      if (o.group == group) text += option_row(o);
  }
  return text;
}

std::string file_of(const CommandEntry& command) { return page_name(command) + ".md"; }

std::string commands_text(const std::vector<CommandEntry>& commands) {
  std::string text = "\n| command | |\n| --- | --- |\n";
  for (const CommandEntry& c : commands)
    text += "| [" + c.path + "](" + file_of(c) + ") | " + cell(sentence(c.help)) + " |\n";
  return text;
}

// Examples keep their lines; exit codes and the environment are the same of all commands and stand in the list.
std::string page(const CommandEntry& command, const CommandEntry& above, const CommandEntry& program) {
  const FooterParts parts = footer_parts(command, program);
  std::string text = made_by + ("# " + command.path + "\n\n") + sentence(command.help) + "\n\n" + synopsis(command);
  if (!parts.notes.empty()) text += "\n" + parts.notes;
  if (!parts.examples.empty()) {
    text += "\nExamples:\n\n";
    for (const std::string& line : split(parts.examples, '\n'))
      if (!line.empty()) text += "    " + line.substr(line.find_first_not_of(' ')) + "\n";
  }
  if (!command.commands.empty()) text += commands_text(command.commands);
  text += options_text(command) + "\nSee also: ";
  if (above.path != program.path) text += "[" + above.path + "](" + file_of(above) + "), ";
  return text + "[all commands](README.md), with exit codes and variables of the environment\n";
}

void add_pages(const CommandEntry& above, const CommandEntry& program,
               std::vector<std::pair<std::string, std::string>>& pages) {
  for (const CommandEntry& c : above.commands) {
    pages.emplace_back(file_of(c), page(c, above, program));
    add_pages(c, program, pages);
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> docs_pages(const CommandEntry& program) {
  const FooterParts parts = footer_parts(program, program);
  std::string list = made_by + std::string("# Commands\n\n") + sentence(program.help) + "\n" +
                     commands_text(program.commands) + options_text(program);
  list += "\n## Exit codes\n\n" + parts.codes + "\n## Environment\n\n" + parts.environment;
  std::vector<std::pair<std::string, std::string>> pages = {{"README.md", list}};
  add_pages(program, program, pages);
  return pages;
}

}  // namespace candela::cli
