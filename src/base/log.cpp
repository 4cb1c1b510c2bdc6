#include "base/log.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/log_form.h"
#include "base/log_gather.h"
#include "base/names.h"

namespace candela::log {
namespace {

std::atomic<Level> lowest{Level::info};
std::atomic<Form> chosen{Form::text};

struct Kept {
  Level level;
  std::string line;
};
std::mutex kept_mutex;
std::atomic<bool> gathering{false};
std::vector<Kept> kept;
constexpr size_t before_an_error = 3;

// One write a line, so that lines of several threads do not mix.
void put(const std::string& whole) { std::fwrite(whole.data(), 1, whole.size(), stderr); }

// The last lines, for recent_lines().
struct Recent {
  std::mutex mutex;
  std::deque<std::string> lines;
};
Recent& recent() {
  static Recent all;
  return all;
}
void remember(Level level, std::string_view line) {
  constexpr size_t most = 1000;
  constexpr const char* prefixes[] = {"debug: ", "", "warning: ", "error: "};
  const std::lock_guard hold(recent().mutex);
  recent().lines.push_back(prefixes[size_t(level)] + printable(line));
  if (recent().lines.size() > most) recent().lines.pop_front();
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

void print(Level level, std::string_view line) {
  if (form() == Form::json) {
    constexpr const char* names[] = {"debug", "info", "warning", "error"};
    return put_object(names[size_t(level)], "message", line, nlohmann::ordered_json::object());
  }
  std::string prefix = level == Level::error ? "error: " : level == Level::warning ? "warning: " : "";
  if (!prefix.empty() && colored()) prefix = (level == Level::error ? "\x1b[31m" : "\x1b[33m") + prefix + "\x1b[0m";
  put(prefix.append(printable(line)).append("\n"));
}

// Which of the lines to print, `count` at most: the last warnings, then the first notes.
std::vector<bool> most_telling(const std::vector<Kept>& lines, size_t count) {
  std::vector<bool> told(lines.size(), false);
  for (size_t i = lines.size(); i-- > 0 && count > 0;)
    if (lines[i].level == Level::warning) told[i] = true, --count;
  for (size_t i = 0; i < lines.size() && count > 0; ++i)
    if (lines[i].level != Level::warning) told[i] = true, --count;
  return told;
}

}  // namespace

void set_level(Level lowest_shown) { lowest = lowest_shown; }
void set_form(Form form) { chosen = form; }
Form form() { return chosen; }

std::vector<std::string> recent_lines() {
  const std::lock_guard hold(recent().mutex);
  return {recent().lines.begin(), recent().lines.end()};
}

void gather() { gathering = lowest.load() > Level::debug && form() == Form::text; }

void write(Level level, std::string_view line) {
  remember(level, line);
  if (level < lowest.load(std::memory_order_relaxed)) return;
  if (gathering.load(std::memory_order_relaxed)) {
    if (level < Level::error) {
      const std::lock_guard lock(kept_mutex);
      kept.push_back({level, std::string(line)});
      return;
    }
    release(before_an_error);
  }
  print(level, line);
}

void write_headline(std::string_view line) {
  if (Level::info >= lowest.load()) print(Level::info, line);
}

void release(size_t most) {
  std::vector<Kept> lines;
  {
    const std::lock_guard lock(kept_mutex);
    gathering = false;
    lines = std::exchange(kept, {});
  }
  const std::vector<bool> told = most_telling(lines, lines.size() <= most ? most : most - 1);
  size_t left_out = 0, warnings = 0;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (told[i]) {
      print(lines[i].level, lines[i].line);
      continue;
    }
    ++left_out, warnings += lines[i].level == Level::warning;
  }
  if (left_out == 0) return;
  const std::string of_them = warnings == 0 ? "" : fmt::format(", {} of them warnings", warnings);
  print(warnings > 0 ? Level::warning : Level::info,
        fmt::format("{} more line{}{} (--verbose)", left_out, left_out == 1 ? "" : "s", of_them));
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
