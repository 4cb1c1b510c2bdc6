#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cli/command.h"
#include "frame/plan_frame.h"
#include "frame/timings.h"
#include "gpu/device.h"
#include "testscenes/make_scene.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ListOptions {
  std::string quality = "high";
  bool json = false;
};

Expected<int> done(Expected<void> printed) {
  if (!printed) return std::unexpected(printed.error());
  return 0;
}

Expected<int> list_names(const std::vector<std::string>& names, bool json) {
  if (json) return done(print_json(names));
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return done(print(text));
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

Expected<int> list_knobs(const ListOptions& o) {
  Json j = Json::array();
  std::vector<std::vector<std::string>> rows = {
      {"KNOB", "VALUE", "UNIT", "RANGE", "LADDER", "TRADES", "SWEPT", "WHAT"}};
  for (const KnobRow& k : knob_rows(o.quality)) {
    j.push_back({{"pass", k.pass},
                 {"knob", k.knob},
                 {"value", k.value_now},
                 {"unit", k.unit},
                 {"range", k.range},
                 {"ladder", k.ladder},
                 {"kind", k.kind},
                 {"swept", k.walk},
                 {"passes", k.passes},
                 {"trades", k.trades}});
    rows.push_back(
        {k.pass + "." + k.knob, k.value_now, k.unit, k.range, k.ladder, k.kind, joined(k.walk, " "), k.trades});
  }
  return done(o.json ? print_json(j) : print(table_text(rows)));
}

std::vector<std::string> generated_scenes() {
  const auto names = scene_names();
  return {names.begin(), names.end()};
}

void add_names(CLI::App& list, Action& action, const std::shared_ptr<ListOptions>& o, const char* name,
               const char* help, std::vector<std::string> (*names)()) {
  CLI::App* command = list.add_subcommand(name, help);
  command->add_flag("--json", o->json, "As JSON");
  command->callback([o, names, &action] { action = [o, names] { return list_names(names(), o->json); }; });
}

}  // namespace

void add_list(CLI::App& app, Action& action) {
  auto o = std::make_shared<ListOptions>();
  CLI::App* list = app.add_subcommand("list", "Print what there is to choose from");
  list->require_subcommand(1);
  CLI::App* devices = list->add_subcommand("devices", "Vulkan devices and whether they can be used");
  devices->add_flag("--json", o->json, "As JSON");
  devices->callback([o, &action] { action = [o] { return list_devices_table(*o); }; });
  add_names(*list, action, o, "techniques", "Ways to make a frame (--technique)", technique_names);
  add_names(*list, action, o, "passes", "Passes, the keys of timings and knobs", pass_names);
  CLI::App* knobs = list->add_subcommand("knobs", "Knobs of all passes with their values (--set)");
  knobs->add_option("--quality", o->quality, "Values at this preset")->capture_default_str()->type_name("NAME");
  knobs->add_flag("--json", o->json, "As JSON");
  knobs->callback([o, &action] { action = [o] { return list_knobs(*o); }; });
  add_names(*list, action, o, "layers", "EXR layers beside beauty (--layers)", layer_names);
  add_names(*list, action, o, "scenes", "Scenes that make-scene writes", generated_scenes);
}

}  // namespace candela::cli
