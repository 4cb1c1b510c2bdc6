#pragma once
#include <span>
#include <string>
#include <string_view>

// Words for files that other programs read, so that each arrives as it is whatever it holds.
namespace candela {

// One word for sh and bash: plain where it can be, else in single quotes.
std::string shell_quoted(std::string_view word);
std::string shell_quoted(std::span<const std::string> words);  // with blanks between
// The words of a command, an option with its value a line.
std::string argument_lines(std::span<const std::string> words, std::string_view indent, std::string_view end);
// A literal of Python.
std::string python_quoted(std::string_view text);
// A shell word, and any shell text, inside a recipe of make, which takes dollars for itself. make has no way to hold a
// line break.
std::string recipe_quoted(std::string_view word);
std::string recipe_text(std::string_view text);
// For a comment: one line, without what a terminal would obey.
std::string comment_text(std::string_view text);
// For names of jobs and nodes: letters, digits and ._- alone; others become _.
std::string plain_name(std::string_view text);

}  // namespace candela
