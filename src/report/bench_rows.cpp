#include "report/bench_rows.h"

#include "base/json.h"
#include "base/statistics.h"
#include "bench/error_analysis.h"
#include "report/error_rows.h"
#include "report/markup.h"

namespace candela {
namespace {

using Json = nlohmann::ordered_json;

// To the nanosecond: more digits are noise that makes files long.
double rounded(double ms) { return std::round(ms * 1e6) / 1e6; }

Json series_json(const Series& s) {
  const Summary sum = summary(s.ms);
  const Interval ci = median_interval(s.ms);
  Json samples = Json::array();
  for (const double ms : s.ms) samples.push_back(rounded(ms));
  return {{"median", rounded(sum.median)}, {"mad", rounded(sum.mad)}, {"ci95", {rounded(ci.low), rounded(ci.high)}},
          {"min", rounded(sum.min)},       {"count", sum.count},      {"samples", std::move(samples)}};
}

Json named_series_json(const std::vector<Series>& all) {
  Json j = Json::object();
  for (const Series& s : all) j[s.name] = series_json(s);
  return j;
}

Json picture_json(const PictureCheck& picture) {
  Json j = Json::object();
  if (!picture.reference.empty())
    j = {{"reference", picture.reference}, {"differing", picture.differing}, {"max_difference", nullptr}};
  if (!picture.reference.empty() && std::isfinite(picture.max_difference)) j["max_difference"] = picture.max_difference;
  if (!picture.note.empty()) j["note"] = picture.note;
  return j;
}

Json row_json(const BenchRow& row) {
  Json j;
  j["suite"] = row.suite;
  j["scene"] = row.scene;
  j["scene_content"] = row.scene_content;
  j["seed"] = row.seed;
  j["lights_wanted"] = row.lights_wanted;
  j["lights"] = row.lights;
  j["camera"] = row.camera;
  j["technique"] = row.technique;
  j["settings"] = row.settings;
  j["quality"] = row.quality;
  if (!row.sky.empty()) j["sky"] = row.sky;
  if (!row.look.empty()) j["look"] = row.look;
  j["effects"] = row.effects;
  if (row.transparency != BenchRow().transparency) j["transparency"] = row.transparency;
  j["size"] = {row.width_px, row.height_px};
  j["samples"] = row.samples;
  j["time_s"] = row.time_s;
  if (row.views != 1) j["views"] = row.views;
  j["output"] = row.output;
  j["device"] = {{"name", row.device}, {"driver", row.driver}, {"class", row.device_class}, {"type", row.device_type}};
  j["machine"] = {{"processor", row.machine}, {"cores", row.cores}};
  j["version"] = row.version;
  if (!row.source.empty()) j["source"] = row.source;
  j["plan_hash"] = row.plan_hash;
  j["knob_hash"] = row.knob_hash;
  j["job"] = row.job.empty() ? Json() : own_json(row.job);
  if (row.run != 0) j["run"] = row.run;
  if (!row.rounds.empty()) j["rounds"] = row.rounds;
  if (!row.truth.empty()) j["truth"] = row.truth;
  if (!row.same_work.empty()) j["same_work"] = same_work_json(row.same_work);
  j["remarks"] = row.remarks;
  if (!row.left_out.empty()) j["left_out"] = row.left_out;
  if (!row.error.empty()) j["error"] = {{"message", row.error}, {"kind", row.error_kind}};
  j["warm_up_frames"] = row.warm_up_frames;
  j["runs_capped"] = row.runs_capped;
  j["budget_hit"] = row.budget_hit;
  j["reopened"] = row.reopened;
  j["frame_ms"] = series_json(row.frame);
  j["gpu_ms"] = series_json(row.gpu);
  j["passes_ms"] = named_series_json(row.passes);
  j["cpu_ms"] = named_series_json(row.cpu);
  j["opening_ms"] = Json::object();
  for (const auto& [stage, ms] : row.opening_ms) j["opening_ms"][stage] = rounded(ms);
  j["memory"] = Json::object();
  for (const auto& [name, bytes] : row.memory) j["memory"][name] = bytes;
  if (!row.trees.empty()) j["trees"] = Json::object();
  for (const auto& [name, count] : row.trees) j["trees"][name] = count;
  j["picture"] = picture_json(row.picture);
  if (!row.errors.empty()) j["errors"] = errors_json(row.errors);
  if (!row.knobs.empty()) j["knobs"] = knobs_json(row.knobs);
  j["light_lists"] = nullptr;
  if (row.lists)
    j["light_lists"] = {{"mean", row.lists->mean},
                        {"p95", row.lists->p95},
                        {"max", row.lists->max},
                        {"waste_share", row.lists->waste_fraction},
                        {"missed", row.lists->missed}};
  if (!row.lists_note.empty()) j["light_lists_note"] = row.lists_note;
  return j;
}

Series series_from(const std::string& name, const Json& j) {
  return {name, j.at("samples").get<std::vector<double>>()};
}

std::vector<Series> named_series_from(const Json& j) {
  std::vector<Series> all;
  for (const auto& [name, value] : j.items()) all.push_back(series_from(name, value));
  return all;
}

void read_picture(const Json& j, PictureCheck& picture) {
  picture.reference = j.value("reference", "");
  picture.note = j.value("note", "");
  picture.differing = j.value("differing", uint64_t(0));
  // Infinity, where only one of two values is finite, is null in JSON.
  if (j.contains("max_difference"))
    picture.max_difference =
        j["max_difference"].is_null() ? std::numeric_limits<double>::infinity() : j["max_difference"].get<double>();
}

// Throws nlohmann's exceptions, which the caller makes an Error.
BenchRow row_from(const Json& j) {
  BenchRow row;
  row.suite = j.at("suite");
  row.scene = j.at("scene");
  row.scene_content = j.at("scene_content");
  row.seed = j.at("seed");
  row.lights_wanted = j.at("lights_wanted");
  row.lights = j.at("lights");
  row.camera = j.at("camera");
  row.technique = j.at("technique");
  row.settings = j.at("settings");
  row.quality = j.at("quality");
  row.sky = j.value("sky", ""), row.look = j.value("look", ""), row.effects = j.value("effects", "auto");
  row.transparency = j.value("transparency", row.transparency);
  row.width_px = j.at("size").at(0);
  row.height_px = j.at("size").at(1);
  row.samples = j.at("samples");
  row.time_s = j.at("time_s");
  row.output = j.at("output");
  const Json &device = j.at("device"), &machine = j.at("machine");
  row.device = device.at("name"), row.driver = device.at("driver");
  row.device_class = device.at("class"), row.device_type = device.at("type");
  row.machine = machine.at("processor"), row.cores = machine.at("cores");
  row.version = j.at("version"), row.source = j.value("source", "");
  row.thumbnail = from_base64(j.value("thumbnail", ""));
  row.plan_hash = j.at("plan_hash"), row.knob_hash = j.at("knob_hash");
  row.job = j.at("job").dump();
  row.remarks = j.at("remarks").get<std::vector<std::string>>();
  row.views = j.value("views", 1), row.run = j.value("run", 0);
  row.rounds = j.value("rounds", std::vector<int>{});
  row.truth = j.value("truth", std::string());
  if (j.contains("same_work")) row.same_work = same_work_from(j["same_work"]);
  row.left_out = j.value("left_out", "");
  if (j.contains("error")) row.error = j["error"].at("message"), row.error_kind = j["error"].at("kind");
  row.warm_up_frames = j.at("warm_up_frames");
  row.runs_capped = j.at("runs_capped"), row.budget_hit = j.at("budget_hit"), row.reopened = j.at("reopened");
  row.frame = series_from("frame", j.at("frame_ms"));
  row.gpu = series_from("gpu", j.at("gpu_ms"));
  row.passes = named_series_from(j.at("passes_ms"));
  row.cpu = named_series_from(j.at("cpu_ms"));
  for (const auto& [stage, ms] : j.at("opening_ms").items()) row.opening_ms.emplace_back(stage, ms.get<double>());
  for (const auto& [name, bytes] : j.at("memory").items()) row.memory.emplace_back(name, bytes.get<uint64_t>());
  if (j.contains("trees"))
    for (const auto& [name, count] : j["trees"].items()) row.trees.emplace_back(name, count.get<uint64_t>());
  read_picture(j.at("picture"), row.picture);
  if (j.contains("errors")) row.errors = errors_from(j["errors"]);
  if (j.contains("knobs")) row.knobs = knobs_from(j["knobs"]);
  if (const Json& lists = j.at("light_lists"); !lists.is_null())
    row.lists =
        LightLists{lists.at("mean"), lists.at("p95"), lists.at("max"), lists.at("waste_share"), lists.at("missed")};
  row.lists_note = j.value("light_lists_note", "");
  return row;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> names_of(const BenchRun& run, std::vector<Series> BenchRow::*member) {
  std::vector<std::string> names;
  for (const BenchRow& row : run.rows)
    for (const Series& s : row.*member)
      if (std::find(names.begin(), names.end(), s.name) == names.end()) names.push_back(s.name);
  return names;
}

void add_summary(std::vector<std::string>& cells, const std::vector<double>& samples) {
  const Summary s = summary(samples);
  const Interval ci = median_interval(samples);
  for (const double value : {s.median, s.mad, ci.low, ci.high, s.min})
    cells.push_back(s.count > 0 ? fmt::format("{}", rounded(value)) : "");
}

void add_medians(std::vector<std::string>& cells, const std::vector<std::string>& names,
                 const std::vector<Series>& all) {
  for (const std::string& name : names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == name; });
    cells.push_back(found == all.end() ? "" : fmt::format("{}", rounded(summary(found->ms).median)));
  }
}

constexpr const char* memory_columns[] = {"scene_bytes", "frame_bytes", "readback_bytes", "device_peak_bytes"};

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (size_t i = 0; i < cells.size(); ++i) line += (i ? "," : "") + csv_cell(cells[i]);
  return line + "\r\n";
}

}  // namespace

std::vector<const BenchRow*> rows_of_scene_pictures(const BenchRun& run) {
  std::vector<const BenchRow*> chosen;
  for (const BenchRow& row : run.rows) {
    if (row.thumbnail.empty()) continue;
    const auto same = std::find_if(chosen.begin(), chosen.end(),
                                   [&](const BenchRow* other) { return row_setting(*other) == row_setting(row); });
    if (same == chosen.end())
      chosen.push_back(&row);
    else if ((*same)->lights < row.lights)
      *same = &row;
  }
  return chosen;
}

Json bench_json(const BenchRun& run) {
  Json j = {{"candela_bench", 1},
            {"wall_s", rounded(run.wall_s)},
            {"opening_s", rounded(run.opening_s)},
            {"notes", run.notes},
            {"rows", Json::array()}};
  const auto pictured = rows_of_scene_pictures(run);
  for (const BenchRow& row : run.rows) {
    j["rows"].push_back(row_json(row));
    if (std::find(pictured.begin(), pictured.end(), &row) != pictured.end())
      j["rows"].back()["thumbnail"] = base64(row.thumbnail);
  }
  if (Json findings = error_findings_json(run); !findings.is_null()) {
    j["error_findings"] = std::move(findings);
    j["unswept_knobs"] = unswept_knobs(run.rows);
  }
  return j;
}

Expected<BenchRun> read_bench_rows(const std::filesystem::path& file) {
  const auto read = read_json_file(file);
  if (!read) return std::unexpected(read.error());
  const Json& j = *read;
  if (!j.is_object() || j.value("candela_bench", Json()) != 1 || !j.contains("rows") || !j["rows"].is_array())
    return fail(ErrorKind::input, file.string(), "is not a file of `candela bench --json`");
  BenchRun run;
  for (size_t i = 0; i < j["rows"].size(); ++i) {
    try {
      run.rows.push_back(row_from(j["rows"][i]));
    } catch (const Json::exception& error) {
      return fail(ErrorKind::input, fmt::format("{}: /rows/{}", file.string(), i), "{}", error.what());
    }
  }
  if (j.contains("notes") && j["notes"].is_array())
    for (const Json& note : j["notes"])
      if (note.is_string()) run.notes.push_back(note);
  if (j.contains("wall_s") && j["wall_s"].is_number()) run.wall_s = j["wall_s"];
  if (j.contains("opening_s") && j["opening_s"].is_number()) run.opening_s = j["opening_s"];
  return run;
}

std::string bench_csv(const BenchRun& run) {
  const std::vector<std::string> passes = names_of(run, &BenchRow::passes), stages = names_of(run, &BenchRow::cpu);
  std::vector<std::string> head = {"suite",
                                   "scene",
                                   "seed",
                                   "lights_wanted",
                                   "lights",
                                   "camera",
                                   "technique",
                                   "settings",
                                   "quality",
                                   "effects",
                                   "transparency",
                                   "sky",
                                   "look",
                                   "width_px",
                                   "height_px",
                                   "samples",
                                   "time_s",
                                   "output",
                                   "device",
                                   "driver",
                                   "version",
                                   "plan_hash",
                                   "knob_hash",
                                   "runs",
                                   "runs_capped",
                                   "budget_hit",
                                   "frame_ms",
                                   "frame_mad_ms",
                                   "frame_ci95_low_ms",
                                   "frame_ci95_high_ms",
                                   "frame_min_ms",
                                   "gpu_ms",
                                   "gpu_mad_ms",
                                   "gpu_ci95_low_ms",
                                   "gpu_ci95_high_ms",
                                   "gpu_min_ms"};
  for (const std::string& pass : passes) head.push_back("gpu." + pass + "_ms");
  for (const std::string& stage : stages) head.push_back("cpu." + stage + "_ms");
  for (const char* column : memory_columns) head.emplace_back(column);
  for (const char* column : {"reference", "differing", "max_difference", "lights_mean", "lights_p95", "lights_max",
                             "waste_share", "missed", "left_out", "error"})
    head.emplace_back(column);
  const std::vector<std::string> errors = error_columns(run);
  head.insert(head.end(), errors.begin(), errors.end());
  std::string text = csv_line(head);
  for (const BenchRow& row : run.rows) {
    const auto number = [](auto value) { return fmt::format("{}", value); };
    const auto unless_unknown = [](int64_t value) { return value < 0 ? std::string() : fmt::format("{}", value); };
    std::vector<std::string> cells = {row.suite,
                                      row.scene,
                                      number(row.seed),
                                      unless_unknown(row.lights_wanted),
                                      unless_unknown(row.lights),
                                      row.camera,
                                      row.technique,
                                      row.settings,
                                      row.quality,
                                      row.effects,
                                      row.transparency,
                                      row.sky,
                                      row.look,
                                      number(row.width_px),
                                      number(row.height_px),
                                      number(row.samples),
                                      number(row.time_s),
                                      row.output,
                                      row.device,
                                      row.driver,
                                      row.version,
                                      row.plan_hash,
                                      row.knob_hash,
                                      number(row.frame.ms.size()),
                                      number(int(row.runs_capped)),
                                      number(int(row.budget_hit))};
    add_summary(cells, row.frame.ms);
    add_summary(cells, row.gpu.ms);
    add_medians(cells, passes, row.passes);
    add_medians(cells, stages, row.cpu);
    for (const char* column : memory_columns)
      cells.push_back(row.memory.empty() ? std::string() : number(memory_of(row, column)));
    const bool compared = !row.picture.reference.empty();
    cells.push_back(row.picture.reference);
    cells.push_back(compared ? number(row.picture.differing) : "");
    cells.push_back(compared ? number(row.picture.max_difference) : "");
    const LightLists lists = row.lists.value_or(LightLists{});
    for (const double value : {lists.mean, lists.p95, lists.max, lists.waste_fraction, lists.missed})
      cells.push_back(row.lists ? number(value) : "");
    cells.push_back(row.left_out);
    cells.push_back(row.error);
    for (std::string& cell : error_cells(row, errors)) cells.push_back(std::move(cell));
    text += csv_line(cells);
  }
  return text;
}

Json comparison_json(const RowComparison& comparison) {
  static constexpr const char* verdicts[] = {"same", "slower", "faster", "unclear"};
  Json changes = Json::array();
  for (const RowChange& c : comparison.changes)
    changes.push_back({{"configuration", c.title},
                       {"quantity", c.quantity},
                       {"verdict", verdicts[int(c.judgement.verdict)]},
                       {"old_median_ms", rounded(c.judgement.old_median)},
                       {"new_median_ms", rounded(c.judgement.new_median)},
                       {"noise_ms", rounded(c.judgement.bound)},
                       {"ratio", c.judgement.ratio()}});
  Json frames = Json::array();
  for (const auto& [title, middle, ratio] : comparison.frames)
    frames.push_back({{"configuration", title},
                      {"ratio", middle},
                      {"ratio_ci95", {ratio.low, std::isfinite(ratio.high) ? Json(ratio.high) : Json()}}});
  return {{"changes", std::move(changes)},
          {"frames", std::move(frames)},
          {"worse_pictures", comparison.worse_pictures},
          {"only_old", comparison.only_old},
          {"only_new", comparison.only_new},
          {"not_comparable", comparison.not_comparable},
          {"slower", comparison.slower()}};
}

}  // namespace candela
