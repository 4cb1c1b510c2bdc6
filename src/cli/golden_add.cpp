#include <CLI/CLI.hpp>

#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "base/scratch_folder.h"
#include "cli/golden_update.h"
#include "cli/job_options.h"
#include "job/motion_names.h"
#include "render/frame_names.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct AddOptions {
  JobOptions job;
  MomentOptions moment;
  std::string root = "golden", name, format = "png", why = "new";
};

// A file as a manifest names it: relative to the folder that the goldens' folder lies in.
Expected<std::string> named_from(const fs::path& file, const fs::path& home, const char* option) {
  const fs::path whole = fs::weakly_canonical(fs::absolute(file)), folder = fs::weakly_canonical(home);
  const fs::path relative = whole.lexically_relative(folder);
  if (relative.empty() || *relative.begin() == "..")
    return fail(ErrorKind::usage, option,
                "{} is not below {}, where a golden's files have to be; move it there, or choose another --root",
                file.string(), folder.string());
  return relative.generic_string();
}

std::string default_name(const AddOptions& o) {
  const fs::path scene = o.job.scene;
  return scene.stem().string() + (o.moment.frame > 0 ? fmt::format("-{}", o.moment.frame) : "");
}

// All that decides the picture; the keys of a job that are not its default are enough to make it again.
Expected<Json> manifest_of(const AddOptions& o, const Job& given, const Moment& moment, const fs::path& home) {
  Job job = given;
  Json manifest;
  const auto scene = named_from(job.scene, home, "SCENE");
  if (!scene) return std::unexpected(scene.error());
  manifest["scene"] = *scene;
  if (!job.sky.empty() && !is_sky_word(job.sky)) {
    const auto sky = named_from(job.sky, home, "--sky");
    if (!sky) return std::unexpected(sky.error());
    manifest["sky"] = *sky;
    job.sky.clear();
  }
  if (!job.look.empty()) {
    const auto look = named_from(job.look, home, "--look");
    if (!look) return std::unexpected(look.error());
    job.look = *look;
  }
  const auto name = [&](const std::string& file) { return named_from(file, home, "--path"); };
  if (auto named = rename_motion_files(job, name); !named) return std::unexpected(named.error());
  job.scene.clear();
  const Json all = own_json(job_json(job)), plain = own_json(job_json(Job{}));
  Json keys;
  keys["size"] = all["size"];
  for (const auto& [key, value] : all.items())
    if (!plain.contains(key) || plain[key] != value) keys[key] = value;
  manifest["job"] = keys;
  if (moment.frame)
    manifest["frame"] = *moment.frame, manifest["fps"] = moment.rate.text();
  else
    manifest["time"] = moment.time_s;
  if (o.format == "exr") manifest["format"] = "exr";
  return manifest;
}

Expected<int> run_add(CLI::App& command, AddOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  const auto job = job_of(o.job);
  if (!job) return std::unexpected(job.error());
  const auto moment = moment_of(o.job, o.moment);
  if (!moment) return std::unexpected(moment.error());
  const auto settings = run_settings_of(o.job);
  if (!settings) return std::unexpected(settings.error());
  if (o.format != "png" && o.format != "exr")
    return fail(ErrorKind::usage, "--format", "'{}' is neither png nor exr", o.format);
  const std::string name = o.name.empty() ? default_name(o) : o.name;
  if (name.empty() || name.find('/') != std::string::npos || name.starts_with('.'))
    return fail(ErrorKind::usage, "--name", "'{}' cannot be the name of a folder", name);
  const fs::path root = fs::absolute(o.root).lexically_normal(), folder = root / name;
  std::error_code failed;
  if (fs::exists(folder / "golden.json", failed))
    return fail(ErrorKind::usage, "--name",
                "there is a golden {} already; give another name, or keep its new picture with `candela golden update`",
                name);
  const auto manifest = manifest_of(o, *job, *moment, root.parent_path());
  if (!manifest) return std::unexpected(manifest.error());
  if (auto ready = prepare_output(folder / "golden.json"); !ready) return std::unexpected(ready.error());
  GoldenManifest golden{.name = name, .folder = folder, .job = *job, .exr = o.format == "exr"};
  golden.frame = moment->frame, golden.rate = moment->rate, golden.time_s = moment->time_s;
  golden.text = manifest->dump();
  const ScratchFolder scratch("golden");
  GoldenDevice picture;
  const auto made = update_golden(golden, {*settings, o.job.allow_blank, /*device_class=*/{}}, scratch.path(), picture);
  if (!made) {
    fs::remove(folder, failed);  // where it is empty
    return std::unexpected(made.error());
  }
  if (auto noted = note_changes(root, {name}, picture, o.why); !noted) return std::unexpected(noted.error());
  log::info("wrote {} and {}; look at the picture before you commit it", golden.picture().string(),
            (folder / "golden.json").string());
  return 0;
}

}  // namespace

void add_golden_add(CLI::App& golden, Action& action) {
  auto o = std::make_shared<AddOptions>();
  o->job.technique = Job().technique;  // a golden is of one technique, whatever is quickest on a device
  CLI::App* add = golden.add_subcommand("add", "Keep a new picture of a scene, made by the same options as render's");
  add_job_options(*add, o->job);
  add_moment_options(*add, o->moment);
  add->add_option("--root", o->root, "Folder of the goldens; scenes are named from the folder that it lies in")
      ->capture_default_str()
      ->type_name("DIR");
  add->add_option("--name", o->name, "Name of the golden; by default the scene's, with the frame number")
      ->type_name("NAME");
  add->add_option("--format", o->format, "png: as it is shown; exr: linear")->capture_default_str()->type_name("NAME");
  add->add_option("--why", o->why, "Noted in CHANGES.md")->capture_default_str()->type_name("TEXT");
  add_run_options(*add, o->job);
  add->callback([add, o, &action] { action = [add, o] { return run_add(*add, *o); }; });
}

}  // namespace candela::cli
