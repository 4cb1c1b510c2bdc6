#include "base/log.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/check.h"

namespace candela::log {
namespace {
std::atomic<Level> lowest{Level::info};
}
void set_level(Level lowest_shown) { lowest = lowest_shown; }
void write(Level level, std::string_view line) {
  if (level < lowest.load(std::memory_order_relaxed)) return;
  const char* prefix = level == Level::error ? "error: " : level == Level::warning ? "warning: " : "";
  // One write a line, so that lines of several threads do not mix.
  const std::string whole = std::string(prefix).append(line).append("\n");
  std::fwrite(whole.data(), 1, whole.size(), stderr);
}
}  // namespace candela::log

namespace candela {
void check_failed(std::string_view expression, std::string_view detail, std::source_location where) {
  std::fprintf(stderr, "candela: internal error: %.*s is false%s%.*s (%s:%u, %s)\n", int(expression.size()),
               expression.data(), detail.empty() ? "" : ": ", int(detail.size()), detail.data(), where.file_name(),
               unsigned(where.line()), where.function_name());
  std::abort();
}
}  // namespace candela
