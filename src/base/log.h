#pragma once
#include <fmt/format.h>

#include <string_view>

// Log lines go to stderr, data to stdout. quiet hides info and notes; warnings and errors always show.
namespace candela::log {
enum class Level { debug, info, warning, error };
void set_level(Level lowest_shown);
// One line: what would end it, or change a terminal, is escaped (base/names.h).
void write(Level level, std::string_view line);
template <class... A>
void debug(fmt::format_string<A...> f, A&&... a) {
  write(Level::debug, fmt::format(f, std::forward<A>(a)...));
}
template <class... A>
void info(fmt::format_string<A...> f, A&&... a) {
  write(Level::info, fmt::format(f, std::forward<A>(a)...));
}
template <class... A>
void warning(fmt::format_string<A...> f, A&&... a) {
  write(Level::warning, fmt::format(f, std::forward<A>(a)...));
}
template <class... A>
void error(fmt::format_string<A...> f, A&&... a) {
  write(Level::error, fmt::format(f, std::forward<A>(a)...));
}
}  // namespace candela::log
