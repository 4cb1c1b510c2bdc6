#include "bench/row.h"

#include <algorithm>

#include "base/statistics.h"

namespace candela {
namespace {

const BenchRow* find(const std::vector<BenchRow>& rows, const std::string& key) {
  for (const BenchRow& row : rows)
    if (row_key(row) == key) return &row;
  return nullptr;
}

bool measured(const BenchRow& row) { return !row.frame.ms.empty(); }

// A CPU device is the processor: its name alone does not tell two machines apart.
std::string place_of(const BenchRow& row) {
  return row.device_type == "cpu" ? fmt::format("{} on {} ({} cores)", row.device, row.machine, row.cores) : row.device;
}

Expected<void> check_places(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after) {
  for (const BenchRow& old_row : before)
    for (const BenchRow& new_row : after)
      if (measured(old_row) && measured(new_row) && place_of(old_row) != place_of(new_row))
        return fail(ErrorKind::input, "--compare",
                    "the old rows were measured with {}, the new ones with {}: times of different devices say nothing "
                    "about each other; measure both on one",
                    place_of(old_row), place_of(new_row));
  return {};
}

const Series* find_pass(const BenchRow& row, const std::string& name) {
  for (const Series& pass : row.passes)
    if (pass.name == name) return &pass;
  return nullptr;
}

void judge_row(const BenchRow& before, const BenchRow& after, const NoiseRules& rules, RowComparison& result) {
  const std::string title = row_title(after);
  result.changes.push_back({title, "frame", judge(before.frame.ms, after.frame.ms, rules)});
  result.changes.push_back({title, "gpu", judge(before.gpu.ms, after.gpu.ms, rules)});
  // A pass of some microseconds jitters by multiples of itself: what is below a fiftieth of the frame is not a finding.
  const double negligible_ms = 0.02 * median(before.frame.ms);
  for (const Series& pass : after.passes) {
    const Series* old_pass = find_pass(before, pass.name);
    if (!old_pass) continue;
    Judgement j = judge(old_pass->ms, pass.ms, rules);
    j.bound = std::max(j.bound, negligible_ms);
    if (j.verdict != Verdict::unclear && std::abs(j.new_median - j.old_median) <= j.bound) j.verdict = Verdict::same;
    result.changes.push_back({title, pass.name, j});
  }
  if (after.picture.differing > before.picture.differing)
    result.worse_pictures.push_back(fmt::format("{}: {} pixels differ from {}, before {}", title,
                                                after.picture.differing, after.picture.reference,
                                                before.picture.differing));
}

}  // namespace

std::string row_look(const BenchRow& row) {
  std::string text;
  if (!row.sky.empty()) text += ", sky " + row.sky;
  if (!row.look.empty()) text += ", look " + row.look;
  if (row.effects != "auto") text += ", effects " + row.effects;
  if (row.transparency != "sorted") text += ", transparency " + row.transparency;
  return text;
}

Series& series(std::vector<Series>& all, const std::string& name) {
  for (Series& s : all)
    if (s.name == name) return s;
  return all.emplace_back(Series{name, {}});
}

std::string row_key(const BenchRow& row) {
  return fmt::format("{}|{}|{}|{}|{}|{}|{}|{}|{}|{}|{}|{}x{}|{}|{}|{}|{}", row.scene, row.sky, row.look, row.seed,
                     row.lights_wanted, row.camera, row.technique, row.settings, row.quality, row.effects,
                     row.transparency, row.width_px, row.height_px, row.samples, row.output, row.time_s, row.views);
}

std::string row_way(const BenchRow& row) {
  return row.settings.empty() ? row.technique : row.technique + " " + row.settings;
}

std::string row_title(const BenchRow& row) {
  std::string title = row.scene;
  const int64_t lights = row.lights_wanted >= 0 ? row.lights_wanted : row.lights;
  if (lights >= 0) title += fmt::format(", {} light{}", lights, lights == 1 ? "" : "s");
  if (!row.camera.empty()) title += ", camera " + row.camera;
  title += fmt::format(", {}, {}x{}, {} sample{}", row_way(row), row.width_px, row.height_px, row.samples,
                       row.samples == 1 ? "" : "s");
  title += row_look(row);
  if (row.quality != "high") title += ", " + row.quality;
  if (row.output != "exr") title += ", " + row.output;
  if (row.time_s != 0) title += fmt::format(", at {} s", row.time_s);
  return title;
}

std::string row_setting(const BenchRow& row) {
  std::string axis = fmt::format("{}, {}x{}, {} sample{}", row.scene, row.width_px, row.height_px, row.samples,
                                 row.samples == 1 ? "" : "s");
  if (!row.camera.empty()) axis += ", camera " + row.camera;
  axis += row_look(row);
  if (row.quality != "high") axis += ", " + row.quality;
  if (row.output != "exr") axis += ", " + row.output;
  if (row.time_s != 0) axis += fmt::format(", at {} s", row.time_s);
  return axis;
}

std::string row_device(const BenchRow& row) { return place_of(row) + (row.driver.empty() ? "" : ", " + row.driver); }

std::string row_axis(const BenchRow& row) { return row_setting(row) + ", " + row_device(row); }

bool RowComparison::slower() const {
  return std::any_of(changes.begin(), changes.end(),
                     [](const RowChange& c) { return c.judgement.verdict == Verdict::slower; });
}

Expected<RowComparison> compare_rows(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after,
                                     const NoiseRules& rules) {
  if (auto same = check_places(before, after); !same) return std::unexpected(same.error());
  RowComparison result;
  for (const BenchRow& row : after) {
    const BenchRow* old_row = find(before, row_key(row));
    if (!old_row) {
      result.only_new.push_back(row_title(row));
      continue;
    }
    if (!measured(row) || !measured(*old_row))
      result.not_comparable.push_back(row_title(row) + ": " +
                                      (measured(row) ? "was not measured before" : "is not measured now"));
    else if (row.scene_content != old_row->scene_content)
      result.not_comparable.push_back(row_title(row) + ": the scene's files have changed");
    else
      judge_row(*old_row, row, rules, result);
  }
  for (const BenchRow& row : before)
    if (!find(after, row_key(row))) result.only_old.push_back(row_title(row));
  std::vector<std::pair<const BenchRow*, const BenchRow*>> both;
  for (const BenchRow& row : after)
    if (const BenchRow* old_row = find(before, row_key(row));
        old_row && measured(row) && measured(*old_row) && row.scene_content == old_row->scene_content)
      both.emplace_back(old_row, &row);
  for (const auto& [old_row, row] : both)
    result.frames.push_back({row_title(*row), median(row->frame.ms) / median(old_row->frame.ms),
                             ratio_interval(old_row->frame.ms, row->frame.ms, both.size())});
  return result;
}

}  // namespace candela
