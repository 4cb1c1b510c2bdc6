#include "cli/command_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "base/text.h"
#include "job/choose_transparency.h"
#include "job/frame_choices.h"
#include "render/film_format.h"
#include "render/reference_frame.h"
#include "scene/cut_outs.h"
#include "scene/probe.h"
#include "scene/up_axis.h"
#include "testscenes/make_scene.h"

namespace candela::cli {
namespace {

using Names = std::vector<std::string>;

Names generated_scenes() {
  const auto names = scene_names();
  return {names.begin(), names.end()};
}

Names with(Names names, const Names& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

// Each is a setting that one word more would finish.
Names knob_settings() {
  Names names;
  for (const KnobRow& k : knob_rows("high")) names.push_back(k.pass + "." + k.knob + "=");
  return names;
}

// With --technique reference.
bool makes_films(const std::string& command) {
  const Names names = {"sequence", "slurm", "opencue", "make", "shell"};
  return std::find(names.begin(), names.end(), command) != names.end();
}

// What the parser cannot tell by itself: options whose values have names.
Names choices_of(const std::string& command, const std::string& option) {
  if (option == "--technique" && makes_films(command))
    return with(technique_names(), {std::string(auto_technique), traced_technique});
  if (option == "--technique") return with(technique_names(), {std::string(auto_technique)});
  if (option == "--techniques") return with(technique_names(), {std::string(auto_technique)});
  if (option == "--transparency") return with(transparency_names(), {std::string(auto_transparency)});
  if (option == "--sides") return {"auto", "block", "open"};
  if (option == "--mode") return {"direct", "path"};
  if (option == "--video-codec" || option == "--codec") return film_codec_names();
  if (option == "--bvh") return {"equal-counts", "sah", "sbvh"};
  if (option == "--sampler") return {"sobol", "jittered", "uniform"};
  if (option == "--ambient") return {"traced", "occlusion", "off"};
  if (option == "--quality") return {"draft", "normal", "high", "exact"};
  if (option == "--effects") return with({"auto", "none"}, effect_names());
  if (option == "--tonemap") return tonemap_names();
  if (option == "--probe") return probe_names();
  if (option == "--set") return knob_settings();
  if (option == "--exr-type") return {"half", "float"};
  if (option == "--exr-compression")
    return {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
  if (option == "--png-bits") return {"8", "16"};
  if (option == "--samples") return {"0", "1", "2", "4", "8"};
  if (option == "--device") return {"cpu", "gpu"};
  if (option == "--animation") return {"auto", "all", "none"};
  if (command == "reference") {
    if (option == "--layers") return with({"all", "none"}, reference_layer_names());
    if (option == "--view") return with({"beauty"}, reference_layer_names());
  }
  if (option == "--cut-outs") return cut_out_choices();
  if (option == "--up") return up_axes();
  if (option == "--shading") return {"pbr", "blinn-phong", "lambert"};
  if (option == "--layers") return with({"all"}, layer_names());
  if (option == "--view") return view_names();
  if (command == "bench" && option == "--suite") return {"exactness", "stability", "stillness"};
  if (command == "completion" && option == "shell") return {"bash", "zsh", "fish"};
  if (command == "make-scene" && option == "name") return generated_scenes();
  return {};
}

// CLI11 writes limits behind a colon: "N:INT in [0 - 8]", "TEXT:{auto,on,off}".
void read_type(const std::string& type, OptionEntry& entry) {
  const size_t colon = type.find(':');
  entry.value = type.substr(0, colon);
  if (colon == std::string::npos) return;
  const std::string limits = type.substr(colon + 1);
  const size_t open = limits.find_first_of("{["), close = limits.find_last_of("}]");
  if (open == std::string::npos || close == std::string::npos || close < open) return;
  const std::string inside = limits.substr(open + 1, close - open - 1);
  if (limits[open] == '{') {
    entry.choices = split(inside, ',');
    entry.value = joined(entry.choices, "|");
  } else if (const size_t dash = inside.find(" - "); dash != std::string::npos) {
    entry.range = inside.substr(0, dash) + " to " + inside.substr(dash + 3);
  }
}

bool names_files(const std::string& value) {
  for (const char* word : {"FILE", "SCENE", "PATTERN", ".json", ".png"})
    if (value.find(word) != std::string::npos) return true;
  return false;
}

OptionEntry entry_of(const std::string& command, const CLI::Option& option) {
  OptionEntry entry;
  entry.positional = !option.nonpositional();
  if (entry.positional) {
    entry.names = {option.get_single_name()};
  } else {
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  }
  entry.help = option.get_description();
  entry.group = option.get_group();
  if (option.get_items_expected_max() == 0) return entry;  // a flag
  read_type(option.get_type_name(), entry);
  entry.default_value = option.get_default_str();
  entry.repeats = option.get_expected_max() > 1;
  entry.list = entry.value == "LIST";
  const Names choices = choices_of(command, entry.names.back());
  if (!choices.empty()) entry.choices = choices;
  // "on|off", "auto|off|START,STOP,COUNT": what is in small letters is a value.
  if (entry.choices.empty() && entry.value.find('|') != std::string::npos)
    for (const std::string& word : split(entry.value, '|'))
      if (std::all_of(word.begin(), word.end(), [](char c) { return c >= 'a' && c <= 'z'; }))
        entry.choices.push_back(word);
  if (entry.choices.empty())
    entry.files = entry.value == "DIR" ? OptionEntry::Files::folders
                  : (entry.positional && entry.value != "NAME") || names_files(entry.value) ? OptionEntry::Files::files
                                                                                            : OptionEntry::Files::none;
  return entry;
}

CommandEntry entry_of(const CLI::App& app, const std::string& above) {
  CommandEntry entry;
  entry.name = app.get_name();
  entry.path = above.empty() ? entry.name : above + " " + entry.name;
  entry.help = app.get_description();
  entry.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) entry.options.push_back(entry_of(entry.name, *option));
  std::stable_partition(entry.options.begin(), entry.options.end(), [](const OptionEntry& o) { return o.positional; });
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* a) { return !a->get_group().empty(); })) {
    if (command->get_name().empty()) {  // a group of options, not a command
      CommandEntry group = entry_of(*command, above);
      for (OptionEntry& option : group.options) option.group = command->get_group();
      entry.options.insert(entry.options.end(), group.options.begin(), group.options.end());
    } else {
      entry.commands.push_back(entry_of(*command, entry.path));
    }
  }
  return entry;
}

}  // namespace

CommandEntry command_tree(const CLI::App& app) { return entry_of(app, {}); }

std::vector<std::string> option_groups(const CommandEntry& command) {
  Names groups;
  for (const OptionEntry& o : command.options)
    if (std::find(groups.begin(), groups.end(), o.group) == groups.end()) groups.push_back(o.group);
  return groups;
}

FooterParts footer_parts(const CommandEntry& command, const CommandEntry& program) {
  const bool says_codes = command.footer.find("Exit codes:") != std::string::npos;
  FooterParts parts;
  std::string* part = &parts.notes;
  for (const std::string& line : split(says_codes ? command.footer : command.footer + "\n" + program.footer, '\n')) {
    std::string rest = line;
    for (const auto& [word, begins] :
         {std::pair{"Examples:", &parts.examples}, std::pair{"Exit codes:", &parts.codes}}) {
      if (!line.starts_with(word)) continue;
      part = begins;
      rest = line.substr(std::string(word).size());
      rest.erase(0, rest.find_first_not_of(' '));
    }
    if (line.starts_with("An option can also stand in the environment")) part = &parts.environment;
    if (!rest.empty() || part == &parts.notes) *part += rest + "\n";
  }
  if (parts.notes.find_first_not_of('\n') == std::string::npos) parts.notes.clear();
  return parts;
}

std::string page_name(const CommandEntry& command) {
  std::string name = command.path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

}  // namespace candela::cli
