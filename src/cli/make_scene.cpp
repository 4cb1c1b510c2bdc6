#include "testscenes/make_scene.h"

#include <CLI/CLI.hpp>

#include "base/file_uses.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/signals.h"
#include "render/frame_names.h"

namespace candela::cli {
namespace {

struct MakeSceneOptions {
  std::string name, output;
  uint64_t seed = 1;
  int lights = 0;
};

Expected<int> run_make_scene(const MakeSceneOptions& o) {
  const auto views = scene_names();
  const std::vector<std::string> names(views.begin(), views.end());
  if (std::find(names.begin(), names.end(), o.name) == names.end())
    return fail(ErrorKind::usage, "NAME", "{}", unknown_name("scene", o.name, names));
  if (o.output.empty()) return fail(ErrorKind::usage, "-o", "no output given; name a .glb file");
  if (std::filesystem::path(o.output).extension() != ".glb")
    return fail(ErrorKind::usage, "-o", "'{}' does not end in .glb", o.output);
  if (o.lights < 0) return fail(ErrorKind::usage, "--lights", "{} is below 0", o.lights);
  const auto beside = make_files_beside(o.name, o.seed, o.output);
  if (!beside) return std::unexpected(beside.error());
  std::vector<NamedFile> files{{"-o", o.output}};
  for (const SceneFile& file : *beside) files.push_back({"-o", file.path});
  if (auto fine = declare_outputs(files); !fine) return std::unexpected(fine.error());
  if (auto ready = prepare_output(o.output); !ready) return std::unexpected(ready.error());
  const HeldSignals held;
  if (auto made = make_scene(o.name, o.seed, o.lights, o.output); !made) return std::unexpected(made.error());
  log::info("wrote {}", o.output);
  for (const SceneFile& file : *beside) log::info("wrote {}", file.path.string());
  if (held.pending() != 0) log::warning("interrupted, but the scene is whole; a second interrupt ends at once");
  return held.pending() != 0 ? 128 + held.pending() : 0;
}

}  // namespace

void add_make_scene(CLI::App& app, Action& action) {
  auto o = std::make_shared<MakeSceneOptions>();
  CLI::App* command = app.add_subcommand("make-scene", "Write a generated test scene");
  command->add_option("name", o->name, "Which one (candela list scenes)")->type_name("NAME");
  command->add_option("--lights", o->lights, "Number of lights; 0 is the scene's own number")
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--seed", o->seed, "Seed of all that is random")
      ->transform(whole_number<uint64_t>())
      ->capture_default_str()
      ->type_name("N");
  command->add_option("-o,--output", o->output, "File to write (.glb)")->type_name("FILE");
  command->callback([o, &action] { action = [o] { return run_make_scene(*o); }; });
}

}  // namespace candela::cli
