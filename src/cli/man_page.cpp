#include "cli/man_page.h"

#include <fmt/format.h>

#include "base/text.h"

namespace candela::cli {
namespace {

constexpr const char* environment = R"(.TP
.B CANDELA_CACHE_DIR
Folder of what is kept between runs: compiled shaders and filtered skies. Without it candela below
.BR XDG_CACHE_HOME ,
else below .cache in the home folder. It may be deleted at any time.
.TP
.BR VK_DRIVER_FILES ", " VK_ICD_FILENAMES
Read by the Vulkan loader: which drivers there are.
)";

// A line that begins with . or ' would be a request; a bare - would be set as a hyphen, which cannot be copied.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string option_text(const OptionEntry& o) {
  std::string text = ".TP\n";
  if (o.positional) {
    text += italic(o.value.empty() ? o.names.front() : o.value);
  } else {
    std::vector<std::string> names;
    for (const std::string& name : o.names) names.push_back(bold(name));
    text += joined(names);
    if (!o.value.empty()) text += " " + italic(o.value);
  }
  if (o.repeats) text += " ...";
  std::string help = o.help;
  if (!help.empty() && help.back() != '.') help += '.';
  text += "\n" + roff(help);
  if (!o.range.empty()) text += roff(fmt::format(" {}.", o.range));
  if (!o.default_value.empty()) text += " Default: " + bold(o.default_value) + ".";
  return text + "\n";
}

// Options by their groups; the first group needs no heading of its own.
std::string options_text(const CommandEntry& command, const char* heading) {
  const std::vector<std::string> groups = option_groups(command);
  std::string text;
  for (const std::string& group : groups) {
    text += group == groups.front() ? std::string(heading) : ".SS " + roff(group) + "\n";
    for (const OptionEntry& o : command.options)
      if (o.group == group) text += option_text(o);
  }
  return text;
}

std::string roff_synopsis(const CommandEntry& command) {
  std::string line = bold(command.path);
  if (!command.commands.empty()) line += " " + italic("COMMAND");
  line += " [" + italic("OPTIONS") + "]";
  for (const OptionEntry& o : command.options)
    if (o.positional) line += " [" + italic(o.value) + (o.repeats ? " ...]" : "]");
  return line + "\n";
}

std::string footer_text(const CommandEntry& command, const CommandEntry& program) {
  const FooterParts parts = footer_parts(command, program);
  std::string text;
  if (!parts.notes.empty()) text += ".SH NOTES\n" + roff(parts.notes);
  if (!parts.examples.empty()) text += ".SH EXAMPLES\n.nf\n" + roff(parts.examples) + ".fi\n";
  if (!parts.codes.empty()) text += ".SH EXIT STATUS\n" + roff(parts.codes);
  if (!parts.environment.empty()) text += ".SH ENVIRONMENT\n" + roff(parts.environment);
  return text;
}

}  // namespace

std::string man_page(const CommandEntry& command, const CommandEntry& program) {
  const bool whole = command.path == program.path;
  std::string help = command.help;
  if (!help.empty() && help.back() == '.') help.pop_back();
  std::string text =
      fmt::format(".TH {} 1 \"\" \"candela {}\" \"candela\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}", page_name(command),
                  CANDELA_VERSION, roff(page_name(command)), roff(help), roff_synopsis(command));
  if (!command.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const CommandEntry& c : command.commands)
      text += ".TP\n" + (whole ? "\\fB" + roff(page_name(c)) + "\\fR(1)" : bold(c.name)) + "\n" + roff(c.help) + ".\n";
  }
  text += options_text(command, ".SH OPTIONS\n");
  if (!whole)
    for (const CommandEntry& c : command.commands)
      text += options_text(c, (".SH OPTIONS OF " + roff(c.path) + "\n").c_str());
  text += footer_text(command, program);
  if (whole && text.find(".SH ENVIRONMENT\n") == std::string::npos) text += ".SH ENVIRONMENT\n";
  if (whole) text += environment;
  text += ".SH SEE ALSO\n";
  std::vector<std::string> others;
  if (!whole) others.push_back("\\fBcandela\\fR(1)");
  for (const CommandEntry& c : program.commands)
    if (c.path != command.path) others.push_back(bold(page_name(c)) + "(1)");
  return text + joined(others, ",\n") + "\n";
}

}  // namespace candela::cli
