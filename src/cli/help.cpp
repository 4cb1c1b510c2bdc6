#include "cli/help.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "base/text.h"

namespace candela::cli {
namespace {

constexpr const char* exit_codes =
    "Exit codes: 0 fine; 1 a comparison failed; 2 usage; 3 input (scene or file); 4 device or driver; 5 output could "
    "not be\n"
    "written; 6 out of memory; 7 the image holds non-finite pixels. Data goes to stdout, log and progress to stderr.\n"
    "An option can also be set in the environment: CANDELA_DEVICE=cpu is --device cpu. The command line overrides it.";

// In the order of the help. What stands in none is the command's own.
const std::vector<std::pair<std::string, std::vector<std::string>>>& groups() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> table = {
      {"Moment", {"frame", "frames", "time", "fps", "animation"}},
      {"Camera",
       {"camera", "up", "eye", "target", "yfov", "azimuth", "elevation", "fit", "follow", "turntable", "camera-path",
        "shutter", "fstop", "focus", "sensor", "subframes", "iso"}},
      {"Scene", {"path", "instances"}},
      {"Picture",
       {"output", "size", "view", "layers", "exposure", "tonemap", "background", "exr-type", "exr-compression",
        "png-bits", "no-dither", "metadata-timings", "allow-nonfinite", "dump", "region", "overscan", "light-groups",
        "steps"}},
      {"Light and look", {"sky", "look", "sides", "shading", "cut-outs", "variant", "probe", "effects", "seed"}},
      {"How the frame is made",
       {"technique", "transparency", "quality", "samples", "set", "time-budget", "error-budget", "sweep",
        "error-reference"}},
      {"Film",
       {"video", "video-codec", "video-pad", "audio", "resume", "cache", "in-flight", "encoders", "shard", "record"}},
      {"Tracing",
       {"mode", "spp", "seconds", "noise", "sampler", "bvh", "visibility", "ambient", "ambient-distance", "bounces",
        "fog-steps", "fog-lights", "footprints", "threads", "state"}},
      {"Measuring", {"timings", "trace", "overlap", "check-determinism", "pass-times", "stop-after"}},
      {"Device", {"device", "allow-cpu", "devices", "queues", "timeout", "validate", "shader-dir"}},
      {"Input", {"allow-path", "decode-budget-mb", "strict", "allow-blank", "config"}},
      {"Messages", {"quiet", "verbose", "log", "json", "dot"}},
  };
  return table;
}

const std::map<std::string, std::string>& examples() {
  static const std::map<std::string, std::string> table = {
      {"render",
       "  candela render scene.glb -o frame.exr -o frame.png --frame 120\n"
       "  candela render model.glb -o model.png --fit --azimuth 210 --sky studio.hdr\n"
       "  candela render scene.glb -o 'out/{camera}.{frame:04}.png' --camera all --frames 0-48x24\n"
       "  candela render scene.glb -o light.exr --layers depth,normal,direct,ambient_diffuse --timings -\n"},
      {"sequence",
       "  candela sequence scene.glb --frames 0-249 -o 'out/%04d.exr' --resume\n"
       "  candela sequence scene.glb --frames 0-249 --video film.mp4 --size 1920x1080\n"
       "  candela sequence model.glb --turntable 96 --animation none --video turn.mp4\n"
       "  candela sequence scene.glb --frames 0-9999 --shard 3/8 -o 'out/%05d.exr'\n"
       "  candela sequence scene.glb --frames 0-249 -o 'truth/%04d.exr' --technique reference --mode path --spp 256\n"},
      {"watch",
       "  candela watch scene.glb -o scene.png --size 640x360\n"
       "  candela watch scene.glb -o scene.png --shader-dir shaders --pass-times\n"},
      {"slurm",
       "  candela farm slurm scene.glb --frames 0-9999 -o 'out/%04d.exr' --video film.mp4 --gpus 1 --submit\n"
       "  candela farm status scene.farm\n"},
      {"shell",
       "  candela farm shell scene.glb --frames 0-9999 -o 'out/%04d.exr'\n"
       "  sh scene.farm/job.sh                                  on every machine\n"},
      {"reference",
       "  candela reference scene.glb -o truth.exr --mode path --noise 0.01\n"
       "  candela reference scene.glb -o direct.exr --spp 256 --frame 120\n"},
      {"plan", "  candela plan scene.glb\n  candela plan scene.glb --dot | dot -Tsvg > frame.svg\n"},
      {"completion", "  source <(candela completion bash)\n"},
      {"compare",
       "  candela compare truth.exr frame.exr --heatmap flip.png --limit flip=0.05\n"
       "  candela compare before.png after.png --html difference.html\n"},
      {"tune", "  candela tune scene.glb --size 1920x1080 --seconds 120\n"},
      {"film",
       "  candela film film.mp4.frames -o part.mp4               what an interrupted sequence --video has made so far\n"
       "  candela film 'out/%04d.png' -o film.mov --video-codec prores4444 --fps 25\n"},
      {"sheet", "  candela sheet out/*.png -o sheet.png --columns 4\n"},
      {"bench",
       "  candela bench scene.glb --techniques clustered,forward-plus --report out\n"
       "  candela bench --error scene.glb --json rows.json\n"
       "  candela bench suite.json --compare before.json\n"},
  };
  return table;
}

// Of a command that writes a farm's job: its own, and what most films need of those of `sequence`.
std::vector<std::string> writer_options(const std::vector<std::string>& more) {
  std::vector<std::string> names = {"frames", "output", "video",   "video-codec", "size", "camera",
                                    "sky",    "look",   "quality", "device",      "job",  "name",
                                    "shards", "rounds", "cpus",    "memory-mb",   "gpus", "program"};
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

bool is_writer(const CLI::App* app) { return app->get_parent() && app->get_parent()->get_name() == "farm"; }

// What most calls of a command need, for -h; of other commands everything is shown.
const std::map<std::string, std::vector<std::string>>& brief_options() {
  static const std::map<std::string, std::vector<std::string>> table = {
      {"render",
       {"output", "frame", "fps", "animation", "camera", "fit", "azimuth", "size", "sky", "look", "exposure", "tonemap",
        "background", "quality", "layers", "device"}},
      {"sequence",
       {"frames", "output", "video", "fps", "animation", "camera", "fit", "follow", "turntable", "size", "sky", "look",
        "exposure", "quality", "resume", "shard", "device"}},
      {"reference",
       {"output", "mode", "spp", "noise", "frame", "camera", "fit", "size", "sky", "look", "layers", "resume"}},
      {"watch",
       {"output", "frame", "time", "camera", "fit", "size", "sky", "look", "shader-dir", "pass-times", "device"}},
      {"plan", {"frame", "camera", "size", "technique", "quality", "effects", "json", "dot"}},
      {"facts", {"frame", "animation", "camera", "json"}},
      {"slurm", writer_options({"minutes", "slurm", "submit"})},
      {"opencue", writer_options({"minutes"})},
      {"make", writer_options({})},
      {"shell", writer_options({})},
      {"tune", {"seconds", "size", "frame", "camera", "sky", "look"}},
      {"bench", {"techniques", "lights", "sizes", "report", "compare", "error", "budget-s", "json"}},
  };
  return table;
}

// In lines of at most `width` characters.
std::string wrapped(const std::string& text, size_t width) {
  std::string lines;
  size_t used = 0;
  for (const std::string& word : split(text, ' ')) {
    const bool fits = used + 1 + word.size() <= width;
    if (used > 0) lines += fits ? ' ' : '\n';
    used = (used > 0 && fits ? used + 1 : 0) + word.size();
    lines += word;
  }
  return lines;
}

// Without the name of each option's variable: they follow from the options'.
class Formatter : public CLI::Formatter {
 public:
  explicit Formatter(bool brief) : brief_(brief) {}
  std::string brief_groups(const CLI::App* app) const {
    const auto names = brief_options().find(app->get_name());
    std::string text = "\nOptions:\n";
    for (const std::string& name : names->second) {
      const CLI::Option* option = app->get_option_no_throw("--" + name);
      if (!option) continue;
      const std::string type = option->get_expected_max() == 0 ? "" : " " + split(option->get_type_name(), ':').front();
      const std::string called =
          (option->get_snames().empty() ? "" : "-" + option->get_snames().front() + ", ") + "--" + name + type;
      text += fmt::format("  {:<26} {}\n", called, first_clause(option->get_description()));
    }
    return text;
  }
  std::string make_footer(const CLI::App* app) const override {
    if (!is_brief(app)) return CLI::Formatter::make_footer(app);
    std::string text = "\nExamples:\n";
    if (const auto found = examples().find(app->get_name()); found != examples().end()) {
      size_t end = 0;
      for (int line = 0; line < 3 && end < found->second.size(); ++line) end = found->second.find('\n', end) + 1;
      text += found->second.substr(0, end);
    }
    if (is_writer(app))
      return text + fmt::format(
                        "\nIt takes all options of `candela sequence` that decide what is rendered: candela farm "
                        "{} --help-all\n",
                        app->get_name());
    return text + fmt::format("\nAll options: candela {} --help\n", app->get_name());
  }
  // Writers of farms are always brief: their --help-all says the rest.
  bool is_brief(const CLI::App* app) const {
    return (brief_ || is_writer(app)) && brief_options().contains(app->get_name());
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(CLI::Formatter::make_option_desc(option), 90);
  }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = mode != CLI::AppFormatMode::All && is_brief(app)
                           ? make_description(app) + make_usage(app, name) + brief_groups(app) + make_footer(app)
                           : CLI::Formatter::make_help(app, name, mode);
    for (size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
    return text;
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string variable = " (Env:" + option->get_envname() + ")";
    if (const size_t at = text.find(variable); at != std::string::npos) text.erase(at, variable.size());
    return text;
  }

 private:
  // Up to where a line would end, a bracket or a colon opens, or a second thought begins.
  static std::string first_clause(const std::string& text) {
    constexpr size_t most = 78;
    size_t end = std::min(text.find_first_of(";("), text.find(": "));
    if (end == std::string::npos || end > most) end = text.size() <= most ? text.size() : text.rfind(' ', most);
    while (end > 0 && (text[end - 1] == ' ' || text[end - 1] == ',')) --end;
    return text.substr(0, end);
  }

  bool brief_;
};

std::string variable_of(const std::string& option) {
  std::string name = "CANDELA_" + option;
  for (char& c : name) c = c == '-' ? '_' : char(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

void complete_options(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_lnames().empty()) continue;
    const std::string name = option->get_lnames().front();
    for (const auto& [group, names] : groups())
      if (std::find(names.begin(), names.end(), name) != names.end()) option->group(group);
    if (option->get_configurable() && name != "config") option->envname(variable_of(name));
  }
}

}  // namespace

void complete_help(CLI::App& app, bool brief) {
  app.formatter(std::make_shared<Formatter>(brief));
  app.footer(exit_codes);
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    complete_help(*command, brief);
    complete_options(*command);
    const auto example = examples().find(command->get_name());
    if (example != examples().end()) command->footer("Examples:\n" + example->second + "\n" + exit_codes);
  }
}

}  // namespace candela::cli
