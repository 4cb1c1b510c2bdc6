#include "base/log.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <string>

#include "base/check.h"
#include "base/log_form.h"
#include "base/names.h"

namespace candela::log {
namespace {

std::atomic<Level> lowest{Level::info};
std::atomic<Form> chosen{Form::text};

// One write a line, so that lines of several threads do not mix.
void put(const std::string& whole) { std::fwrite(whole.data(), 1, whole.size(), stderr); }

struct Kept {
  std::mutex mutex;
  std::deque<std::string> lines;
};
Kept& kept() {
  static Kept all;
  return all;
}
void keep(Level level, std::string_view line) {
  constexpr size_t most = 1000;
  constexpr const char* prefixes[] = {"debug: ", "", "warning: ", "error: "};
  const std::lock_guard hold(kept().mutex);
  kept().lines.push_back(prefixes[size_t(level)] + printable(line));
  if (kept().lines.size() > most) kept().lines.pop_front();
}

// UTC, RFC 3339, milliseconds.
std::string now() {
  using namespace std::chrono;
  const auto at = floor<milliseconds>(system_clock::now());
  const year_month_day date{floor<days>(at)};
  const hh_mm_ss time{at - floor<days>(at)};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", int(date.year()), unsigned(date.month()),
                     unsigned(date.day()), time.hours().count(), time.minutes().count(), time.seconds().count(),
                     time.subseconds().count());
}

void put_object(std::string_view level, std::string_view event, std::string_view text,
                const nlohmann::ordered_json& members) {
  nlohmann::ordered_json line = {{"time", now()}, {"level", level}, {"event", event}, {"text", text}};
  line.update(members);
  // Names of files may be no UTF-8.
  put(line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

// On a terminal, unless the reader wants none (no-color.org).
bool colored() {
  static const bool is = [] {
    const char *none = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
    return isatty(STDERR_FILENO) == 1 && !(none && *none) && !(terminal && std::string_view(terminal) == "dumb");
  }();
  return is;
}

}  // namespace

void set_level(Level lowest_shown) { lowest = lowest_shown; }
void set_form(Form form) { chosen = form; }
Form form() { return chosen; }

std::vector<std::string> recent_lines() {
  const std::lock_guard hold(kept().mutex);
  return {kept().lines.begin(), kept().lines.end()};
}

void write(Level level, std::string_view line) {
  keep(level, line);
  if (level < lowest.load(std::memory_order_relaxed)) return;
  if (form() == Form::json) {
    constexpr const char* names[] = {"debug", "info", "warning", "error"};
    return put_object(names[size_t(level)], "message", line, nlohmann::ordered_json::object());
  }
  std::string prefix = level == Level::error ? "error: " : level == Level::warning ? "warning: " : "";
  if (!prefix.empty() && colored()) prefix = (level == Level::error ? "\x1b[31m" : "\x1b[33m") + prefix + "\x1b[0m";
  put(prefix.append(printable(line)).append("\n"));
}

void event(std::string_view event, std::string_view text, const nlohmann::ordered_json& members) {
  if (form() == Form::json)
    put_object("info", event, text, members);
  else
    put(std::string(text));
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
