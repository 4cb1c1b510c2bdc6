#pragma once
#include <fmt/format.h>

#include <cstddef>
#include <string_view>

// Of a command that says few lines unless it is asked for more. Where all is wanted (--verbose, --log json) nothing is
// held back.
namespace candela::log {

// From now on lines of the levels info and warning are kept.
void gather();
// Prints what was kept in at most `most` lines, at least 1: all of it, or as much as leaves one to say how many are
// left out. Warnings stay before notes, and later ones, which are of the picture, before earlier ones, of the file. An
// error prints at most three of them before itself. Whatever comes after is printed at once again.
void release(size_t most);
// A line of level info that is never kept.
void write_headline(std::string_view line);
template <class... A>
void headline(fmt::format_string<A...> f, A&&... a) {
  write_headline(fmt::format(f, std::forward<A>(a)...));
}

}  // namespace candela::log
