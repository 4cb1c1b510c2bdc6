#include "cli/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "base/text.h"

namespace candela::cli {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string single_quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::vector<std::string> names_of(const std::vector<CommandEntry>& commands) {
  std::vector<std::string> names;
  for (const CommandEntry& c : commands) names.push_back(c.name);
  return names;
}

void for_each(const CommandEntry& command, const std::function<void(const CommandEntry&)>& call) {
  call(command);
  for (const CommandEntry& c : command.commands) for_each(c, call);
}

// "render" of "candela render"; "" of the program.
std::string below(const CommandEntry& program, const CommandEntry& command) {
  return command.path == program.path ? "" : command.path.substr(program.path.size() + 1);
}

// --- bash ---

// What completes a value: an array assignment of bash.
std::string bash_values(const OptionEntry& o) {
  if (o.files == OptionEntry::Files::folders) return "kind=folders";
  if (o.files == OptionEntry::Files::files) return "kind=files";
  if (o.choices.empty()) return "kind=none";
  return fmt::format("kind={} words={}", o.list ? "list" : "words", single_quoted(joined(o.choices, " ")));
}

std::string bash_patterns(const std::vector<std::string>& patterns) {
  std::vector<std::string> quoted;
  for (const std::string& p : patterns) quoted.push_back(single_quoted(p));
  return joined(quoted, " | ");
}

// --- zsh ---

std::string zsh_text(const std::string& text) {
  return replaced(replaced(replaced(replaced(text, "\\", "\\\\"), "[", "\\["), "]", "\\]"), ":", "\\:");
}

std::string zsh_action(const OptionEntry& o) {
  if (o.files == OptionEntry::Files::folders) return "_files -/";
  if (o.files == OptionEntry::Files::files) return "_files";
  if (o.choices.empty()) return " ";
  // A setting goes on behind its '='.
  const std::string words = joined(o.choices, " ");
  return o.list || o.choices.front().ends_with('=') ? "_sequence compadd -S '' - " + words : "(" + words + ")";
}

std::string zsh_specs(const CommandEntry& command) {
  std::string text;
  for (const OptionEntry& o : command.options) {
    const std::string value = o.value.empty() ? "" : ":" + zsh_text(o.value) + ":" + zsh_action(o);
    if (o.positional) {
      text += "    " + single_quoted((o.repeats ? "*" : "") + value) + " \\\n";
      continue;
    }
    for (const std::string& name : o.names)
      text += "    " + single_quoted((o.repeats ? "*" : "") + name + "[" + zsh_text(o.help) + "]" + value) + " \\\n";
  }
  return text;
}

std::string zsh_function(const CommandEntry& program, const CommandEntry& command) {
  return "_candela" + (command.path == program.path ? "" : "_" + replaced(below(program, command), " ", "_"));
}

// --- fish ---

// Fish knows \ and ' inside single quotes.
std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish_line(const std::string& condition, const OptionEntry& o) {
  std::string line = "complete -c candela -n " + fish_quoted(condition);
  if (!o.positional)
    for (const std::string& name : o.names)
      line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (o.files == OptionEntry::Files::folders)
    line += " -x -a '(__fish_complete_directories)'";
  else if (o.files == OptionEntry::Files::files)
    line += o.positional ? " -F" : " -r -F";
  else if (!o.choices.empty())
    line += (o.positional ? " -f -a " : " -x -a ") + fish_quoted(joined(o.choices, " "));
  else if (!o.value.empty())
    line += " -x";
  return o.help.empty() ? line + "\n" : line + " -d " + fish_quoted(o.help) + "\n";
}

}  // namespace

std::string bash_completion(const CommandEntry& program) {
  std::vector<std::string> steps;
  std::map<std::string, std::vector<std::string>> values;  // what completes: the options that it completes
  std::string here;
  for_each(program, [&](const CommandEntry& c) {
    const std::string path = below(program, c);
    if (!path.empty()) steps.push_back(path);
    std::vector<std::string> options, words = names_of(c.commands);
    for (const OptionEntry& o : c.options) {
      if (o.positional && c.commands.empty() && !o.choices.empty()) words = o.choices;
      if (o.positional) continue;
      options.insert(options.end(), o.names.begin(), o.names.end());
      if (!o.value.empty())
        for (const std::string& name : o.names) values[bash_values(o)].push_back(path + " " + name);
    }
    here += fmt::format("    {}) options={} {} ;;\n", single_quoted(path), single_quoted(joined(options, " ")),
                        words.empty() ? "kind=files" : "kind=words words=" + single_quoted(joined(words, " ")));
  });
  std::string text = R"(# bash completion for candela; made from its parser.
_candela() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}
  local command='' options='' kind='' words='' head='' i
  # Bash cuts words at =: --option=value are three.
  if [[ $cur == = ]]; then
    cur=''
  elif [[ $prev == = && $COMP_CWORD -gt 1 ]]; then
    prev=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${command:+$command }${COMP_WORDS[i]}" in
)";
  text += "      " + bash_patterns(steps) + ") command+=${command:+ }${COMP_WORDS[i]} ;;\n";
  text += "    esac\n  done\n  case \"$command $prev\" in\n";
  for (const auto& [value, options] : values) text += "    " + bash_patterns(options) + ") " + value + " ;;\n";
  text += "    *) case \"$command\" in\n" + here + R"(    esac
    if [[ $cur == -* ]]; then kind=words words=$options; fi ;;
  esac
  COMPREPLY=()
  case $kind in
    files | folders)
      compopt -o filenames 2>/dev/null
      local name
      while IFS= read -r name; do COMPREPLY+=("$name"); done < <(
        if [[ $kind == files ]]; then compgen -f -- "$cur"; else compgen -d -- "$cur"; fi) ;;
    list)
      if [[ $cur == *,* ]]; then head=${cur%,*}, cur=${cur##*,}; fi
      compopt -o nospace 2>/dev/null
      COMPREPLY=($(compgen -P "$head" -W "$words" -- "$cur")) ;;
    words)
      COMPREPLY=($(compgen -W "$words" -- "$cur"))
      if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]]; then compopt -o nospace 2>/dev/null; fi ;;
  esac
}
complete -F _candela candela
)";
  return text;
}

std::string zsh_completion(const CommandEntry& program) {
  std::string text = "#compdef candela\n# zsh completion for candela; made from its parser.\n";
  for_each(program, [&](const CommandEntry& c) {
    text += "\n" + zsh_function(program, c) + "() {\n";
    if (c.commands.empty()) {
      text += "  _arguments -s \\\n" + zsh_specs(c) + "    && return\n}\n";
      return;
    }
    text += "  local curcontext=$curcontext state line\n  typeset -A opt_args\n  _arguments -s -C \\\n" + zsh_specs(c) +
            "    '1: :->command' '*:: :->rest' && return\n  case $state in\n    command)\n      local -a commands=(\n";
    for (const CommandEntry& inner : c.commands)
      text += "        " + single_quoted(replaced(inner.name, ":", "\\:") + ":" + inner.help) + "\n";
    text += "      )\n      _describe command commands ;;\n    rest)\n      case $words[1] in\n";
    for (const CommandEntry& inner : c.commands)
      text += "        " + inner.name + ") " + zsh_function(program, inner) + " ;;\n";
    text += "      esac ;;\n  esac\n}\n";
  });
  return text + "\nif [[ ${funcstack[1]} == _candela ]]; then _candela \"$@\"; else compdef _candela candela; fi\n";
}

std::string fish_completion(const CommandEntry& program) {
  std::string text = R"(# fish completion for candela; made from its parser.
function __candela_at
    set -l command ''
    for word in (commandline -opc)[2..]
        set -l longer (string trim -- "$command $word")
        if contains -- "$longer" $__candela_commands
            set command $longer
        end
    end
    test "$command" = "$argv"
end
)";
  std::vector<std::string> paths;
  std::string lines;
  for_each(program, [&](const CommandEntry& c) {
    const std::string path = below(program, c);
    if (!path.empty()) paths.push_back(fish_quoted(path));
    const std::string condition = path.empty() ? "__candela_at" : "__candela_at " + path;
    for (const CommandEntry& inner : c.commands)
      lines += fmt::format("complete -c candela -n {} -f -a {} -d {}\n", fish_quoted(condition), inner.name,
                           fish_quoted(inner.help));
    for (const OptionEntry& o : c.options) lines += fish_line(condition, o);
  });
  return text + "set -g __candela_commands " + joined(paths, " ") + "\n" + lines;
}

}  // namespace candela::cli
