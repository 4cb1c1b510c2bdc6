#pragma once
#include <source_location>
#include <string_view>

namespace candela {
// Prints the broken invariant with its place and aborts. There is no remedy at run time, so it stays on in every
// build.
[[noreturn]] void check_failed(std::string_view expression, std::string_view detail, std::source_location where);
}  // namespace candela

#define CHECK(condition) \
  ((condition) ? void(0) : ::candela::check_failed(#condition, {}, std::source_location::current()))
#define CHECK_MSG(condition, detail) \
  ((condition) ? void(0) : ::candela::check_failed(#condition, (detail), std::source_location::current()))
