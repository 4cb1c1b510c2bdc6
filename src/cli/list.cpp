#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/text.h"
#include "cli/command.h"
#include "gpu/device.h"
#include "job/frame_choices.h"
#include "look/look.h"
#include "session/timings.h"
#include "testscenes/make_scene.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ListOptions {
  std::string quality = "high";
  bool json = false, all = false;
};

Expected<int> done(Expected<void> printed) {
  if (!printed) return std::unexpected(printed.error());
  return 0;
}

using Says = std::string_view (*)(std::string_view name);

// A name and what it is on each line.
Expected<int> list_names(const std::vector<std::string>& names, Says says, bool json) {
  if (json) return done(print_json(names));
  std::vector<std::vector<std::string>> rows;
  for (const std::string& name : names) rows.push_back({name, std::string(says ? says(name) : "")});
  return done(print(table_text(rows)));
}

Expected<int> list_devices_table(const ListOptions& o) {
  const auto devices = gpu::list_devices();
  if (!devices) return std::unexpected(devices.error());
  Json j = Json::array();
  std::vector<std::vector<std::string>> rows = {
      {"INDEX", "TYPE", "NAME", "DRIVER", "CLASS", "UUID", "MEMORY", "USABLE"}};
  for (const gpu::DeviceInfo& d : *devices) {
    Json entry = device_json(d);
    entry["index"] = d.index;
    entry["memory_bytes"] = d.memory_bytes;
    entry["unusable"] = d.unusable;
    j.push_back(entry);
    rows.push_back({fmt::format("{}", d.index), d.type, d.name, d.driver, d.device_class, d.uuid,
                    fmt::format("{:.1f} GiB", double(d.memory_bytes) / double(1u << 30)),
                    d.unusable.empty() ? "yes" : "no: " + d.unusable});
  }
  return done(o.json ? print_json(j) : print(table_text(rows)));
}

// Words in lines of at most 120 columns, each after four blanks.
std::string indented(const std::string& text) {
  constexpr size_t most = 120;
  std::string lines, line;
  for (const std::string& word : split(text, ' ')) {
    if (!line.empty() && 4 + line.size() + 1 + word.size() > most) lines += "    " + std::exchange(line, {}) + "\n";
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + "    " + line + "\n";
}

// A line of values for each knob, and what it does below.
std::string knobs_text(const std::vector<KnobRow>& knobs) {
  std::vector<std::vector<std::string>> rows = {{"KNOB", "VALUE", "UNIT", "TRADES", "RANGE", "LADDER"}};
  for (const KnobRow& k : knobs) {
    const bool choice = k.range.find('|') != std::string::npos;
    rows.push_back({k.pass + "." + k.knob, k.value_now, k.unit, k.kind, choice ? "" : k.range, k.levels});
  }
  const std::vector<std::string> lines = split(table_text(rows), '\n');
  std::string text = lines.front() + "\n";
  for (size_t i = 0; i < knobs.size(); ++i) {
    const KnobRow& k = knobs[i];
    text += lines[i + 1] + "\n" + indented(k.description);
    if (k.range.find('|') != std::string::npos) text += indented("one of " + joined(split(k.range, '|')));
    if (k.sweep.size() > 1) text += indented("swept: " + joined(k.sweep));
  }
  return text;
}

// Knobs that no preset moves are for experts.
std::vector<bool> expert_knobs() {
  std::vector<bool> expert;
  const std::vector<KnobRow> draft = knob_rows("draft");
  for (const KnobRow& k : draft) expert.push_back(!k.value_now.empty());
  for (const char* quality : {"normal", "high", "exact"}) {
    const std::vector<KnobRow> rows = knob_rows(quality);
    for (size_t i = 0; i < rows.size(); ++i) expert[i] = expert[i] && rows[i].value_now == draft[i].value_now;
  }
  return expert;
}

Expected<int> list_knobs(const ListOptions& o) {
  const std::vector<KnobRow> knobs = knob_rows(o.quality);
  const std::vector<bool> expert = expert_knobs();
  if (!o.json) {
    std::vector<KnobRow> shown;
    for (size_t i = 0; i < knobs.size(); ++i)
      if (o.all || !expert[i]) shown.push_back(knobs[i]);
    const size_t hidden = knobs.size() - shown.size();
    return done(
        print(knobs_text(shown) +
              (hidden > 0 ? fmt::format("{} more for experts, which no quality moves (--all)\n", hidden) : "")));
  }
  Json j = Json::array();
  for (size_t i = 0; i < knobs.size(); ++i) {
    const KnobRow& k = knobs[i];
    j.push_back({{"pass", k.pass},
                 {"knob", k.knob},
                 {"value", k.value_now},
                 {"unit", k.unit},
                 {"range", k.range},
                 {"ladder", k.levels},
                 {"kind", k.kind},
                 {"swept", k.sweep},
                 {"passes", k.passes},
                 {"trades", k.description},
                 {"expert", bool(expert[i])}});
  }
  return done(print_json(j));
}

// What a job takes by default comes first: no technique, but the choice of one.
std::vector<std::string> technique_choices() {
  std::vector<std::string> names = technique_names();
  names.emplace(names.begin(), auto_technique);
  return names;
}
std::string_view technique_choice_description(std::string_view name) {
  static const std::string by_default =
      fmt::format("the default, what is quickest: {} on a GPU with 64-bit atomics, elsewhere {}",
                  quickest_technique(false, true).name, quickest_technique(true, false).name);
  return name == auto_technique ? by_default : technique_description(name);
}

std::vector<std::string> generated_scene_names() {
  const auto names = scene_names();
  return {names.begin(), names.end()};
}

void add_names(CLI::App& list, Action& action, const std::shared_ptr<ListOptions>& o, const char* name,
               const char* help, std::vector<std::string> (*names)(), Says says = nullptr) {
  CLI::App* command = list.add_subcommand(name, help);
  command->add_flag("--json", o->json, "As JSON");
  command->callback(
      [o, names, says, &action] { action = [o, names, says] { return list_names(names(), says, o->json); }; });
}

}  // namespace

void add_list(CLI::App& app, Action& action) {
  auto o = std::make_shared<ListOptions>();
  CLI::App* list = app.add_subcommand("list", "Print what there is to choose from");
  list->require_subcommand(1);
  CLI::App* devices = list->add_subcommand("devices", "Vulkan devices and whether they can be used");
  devices->add_flag("--json", o->json, "As JSON");
  devices->callback([o, &action] { action = [o] { return list_devices_table(*o); }; });
  add_names(*list, action, o, "techniques", "Ways to make a frame (--technique)", technique_choices,
            technique_choice_description);
  add_names(*list, action, o, "transparency", "Ways to draw blended surfaces (--transparency)", transparency_names,
            transparency_description);
  add_names(*list, action, o, "passes", "Passes, the keys of timings and knobs", pass_names);
  CLI::App* knobs = list->add_subcommand("knobs", "Knobs of all passes with their values (--set)");
  knobs->add_option("--quality", o->quality, "Values at this preset")->capture_default_str()->type_name("NAME");
  knobs->add_flag("--all", o->all, "Also knobs for experts, which no quality changes");
  knobs->add_flag("--json", o->json, "As JSON, all of them");
  knobs->callback([o, &action] { action = [o] { return list_knobs(*o); }; });
  add_names(*list, action, o, "layers", "EXR layers beside beauty (--layers)", layer_names, layer_description);
  add_names(*list, action, o, "views", "What PNG and video can show (--view)", view_names, layer_description);
  CLI::App* look = list->add_subcommand("look-schema", "The JSON Schema of look files (docs/schemas)");
  look->callback([&action] { action = [] { return done(print(look_schema())); }; });
  add_names(*list, action, o, "scenes", "Scenes that make-scene writes", generated_scene_names, scene_description);
}

}  // namespace candela::cli
