#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "base/files.h"
#include "look/look.h"
#include "look/look_rows.h"

// Look files: their text read, and their values at a time.
namespace candela {

using namespace look_rows;

struct LookFile::Parsed {
  Json tree;  // with the first values of what changes
  std::vector<TimedValue> values;
  std::string place;
  std::vector<double> key_times() const;
};

std::vector<double> LookFile::Parsed::key_times() const {
  std::vector<double> times;
  for (const TimedValue& value : values) times.insert(times.end(), value.time_s.begin(), value.time_s.end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

namespace {

Expected<std::shared_ptr<const LookFile::Parsed>> parse_look(std::string_view text, const std::string& place) {
  auto j = read_json(text, place);
  if (!j) return std::unexpected(j.error());
  if (!j->is_object()) return wrong(place, "a look is a JSON object");
  for (const auto& [key, what] :
       {std::pair("probes", "probes are"), {"paths", "paths are"}, {"instances", "instances are"}})
    if (j->contains(key))
      if (auto fixed = check_fixed((*j)[key], fmt::format("{}: /{}", place, key), what); !fixed)
        return std::unexpected(fixed.error());
  auto parsed = std::make_shared<LookFile::Parsed>();
  if (auto taken = take_timed_values(*j, place + ": ", {}, parsed->values); !taken)
    return std::unexpected(taken.error());
  parsed->tree = std::move(*j);
  parsed->place = place + ": ";
  return parsed;
}

// tree: a copy of the look's, which becomes that of the time.
Expected<Look> look_at(const LookFile::Parsed& parsed, Json& tree, double time_s) {
  for (const TimedValue& value : parsed.values) value.set(tree, time_s);
  Look look;
  if (auto read = read_rows(tree, parsed.place, look_table(), look); !read) return std::unexpected(read.error());
  return look;
}

// The first error at the time of a key.
Expected<void> check_at_keys(const LookFile::Parsed& parsed) {
  const std::vector<double> times = parsed.key_times();
  std::atomic<size_t> first = times.size();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, times.size(), 1024), [&](const tbb::blocked_range<size_t>& range) {
    Json tree = parsed.tree;
    for (size_t i = range.begin(); i != range.end() && i < first; ++i) {
      if (look_at(parsed, tree, times[i])) continue;
      for (size_t known = first; i < known && !first.compare_exchange_weak(known, i);) {
      }
      return;
    }
  });
  if (first == times.size()) return {};
  Json tree = parsed.tree;
  const Error error = look_at(parsed, tree, times[first]).error();
  return fail(ErrorKind::input, error.place, "at {} s: {}", times[first], error.message);
}

}  // namespace

Expected<Look> LookFile::at(double time_s) const {
  Json tree = parsed_->tree;
  return look_at(*parsed_, tree, time_s);
}

Expected<Look> look_from_json(const std::string& text, const std::string& place, double time_s) {
  const auto parsed = parse_look(text, place);
  if (!parsed) return std::unexpected(parsed.error());
  return LookFile(*parsed).at(time_s);
}

Expected<LookFile> read_look_file(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  const auto parsed = parse_look({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file.string());
  if (!parsed) return std::unexpected(parsed.error());
  const LookFile look(*parsed);
  if (auto first = look.at(0); !first) return std::unexpected(first.error());
  if (auto fine = check_at_keys(**parsed); !fine) return std::unexpected(fine.error());
  return look;
}

Expected<Look> read_look(const std::filesystem::path& file, double time_s) {
  const auto read = read_look_file(file);
  if (!read) return std::unexpected(read.error());
  return read->at(time_s);
}

Expected<Look> read_look_motion(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  Look look;
  if (!has("\"paths\"") && !has("\"instances\"")) return look;
  const auto parsed = parse_look(text, file.string());
  if (!parsed) return std::unexpected(parsed.error());
  Json motion = Json::object();
  for (const char* key : {"paths", "instances"})
    if ((*parsed)->tree.contains(key)) motion[key] = (*parsed)->tree[key];
  if (auto read = read_rows(motion, (*parsed)->place, look_table(), look); !read) return std::unexpected(read.error());
  return look;
}

std::filesystem::path look_beside(const std::filesystem::path& scene) {
  std::filesystem::path file = scene;
  file.replace_extension(".look.json");
  std::error_code failed;
  return std::filesystem::is_regular_file(file, failed) ? file : std::filesystem::path();
}

}  // namespace candela
