#include "cli/golden_manifest.h"

#include "base/files.h"
#include "base/input.h"
#include "base/json.h"
#include "base/text.h"
#include "job/motion_names.h"
#include "testscenes/make_scene.h"

namespace candela::cli {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

Expected<void> read_time(const Json& j, const std::string& file, GoldenManifest& golden) {
  if (j.contains("time")) {
    if (!j["time"].is_number()) return fail(ErrorKind::input, file + ": /time", "is not a number");
    golden.time_s = j["time"].get<double>();
    return {};
  }
  if (j.contains("frame") && !j["frame"].is_number_integer())
    return fail(ErrorKind::input, file + ": /frame", "is not a whole number");
  if (j.contains("fps")) {
    const auto rate = parse_frame_rate(j["fps"].is_string() ? j["fps"].get<std::string>() : j["fps"].dump());
    if (!rate) return std::unexpected(Error{ErrorKind::input, rate.error().message, file + ": /fps"});
    golden.rate = *rate;
  }
  golden.frame = j.value("frame", int64_t(0));
  golden.time_s = golden.rate.seconds(*golden.frame);
  return {};
}

Expected<std::string> resolve(const Json& j, const char* key, const std::string& file, const fs::path& root,
                              const fs::path& assets, GoldenManifest& golden) {
  if (!j.contains(key)) return std::string();
  if (!j[key].is_string()) return fail(ErrorKind::input, file + ": /" + key, "is not a text");
  const std::string text = j[key].get<std::string>();
  if (text.starts_with(made_prefix)) {
    const std::string name = text.substr(made_prefix.size());
    const auto views = scene_names();
    const std::vector<std::string> names(views.begin(), views.end());
    if (std::find(names.begin(), names.end(), name) == names.end())
      return fail(ErrorKind::input, file + ": /" + key, "{}", unknown_name("scene", name, names));
    return text;
  }
  constexpr std::string_view prefix = "assets:";
  const bool asset = text.starts_with(prefix);
  const fs::path home = asset ? assets : root.parent_path();
  std::error_code failed;
  if (asset && !fs::is_directory(assets, failed)) {
    golden.missing_assets = true;
    return text;
  }
  const fs::path named = home / text.substr(asset ? prefix.size() : 0);
  if (auto allowed = check_named_file(named, home, file); !allowed)
    return fail(ErrorKind::input, file + ": /" + key, "{}", allowed.error().message);
  return named.string();
}

Expected<void> read_accepted(const Json& j, const std::string& file, GoldenManifest& golden) {
  if (!j.contains("accepted")) return {};
  if (!j["accepted"].is_object())
    return fail(ErrorKind::input, file + ": /accepted", "is not an object of device classes");
  for (const auto& [device_class, digests] : j["accepted"].items()) {
    if (!digests.is_array())
      return fail(ErrorKind::input, file + ": /accepted/" + device_class, "is not a list of digests");
    for (const Json& entry : digests) {
      const Json digest = entry.is_object() ? entry.value("digest", Json()) : entry;
      if (!digest.is_string())
        return fail(ErrorKind::input, file + ": /accepted/" + device_class,
                    "holds something other than a digest or an object with one");
      golden.accepted[device_class].push_back(digest.get<std::string>());
    }
  }
  return {};
}

GoldenDevice read_device(const Json& made) {
  const auto text = [&](const char* key) {
    const Json value = made.is_object() ? made.value(key, Json()) : Json();
    return value.is_string() ? value.get<std::string>() : std::string();
  };
  return {text("device_class"), text("device"), text("driver")};
}

Expected<GoldenManifest> read_golden(const fs::path& folder, const fs::path& root, const fs::path& assets) {
  const std::string file = (folder / "golden.json").string();
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  GoldenManifest golden{.name = folder.filename().string(), .folder = folder};
  golden.text.assign(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const auto read = read_json(golden.text, file);
  if (!read) return std::unexpected(read.error());
  const Json& j = *read;
  if (!j.is_object()) return fail(ErrorKind::input, file, "is not a JSON object");
  static const std::vector<std::string> keys = {"scene", "sky",      "job",  "frame",     "fps",    "time",
                                                "gate",  "accepted", "made", "also_made", "format", "note"};
  for (const auto& entry : j.items())
    if (std::find(keys.begin(), keys.end(), entry.key()) == keys.end())
      return fail(ErrorKind::input, file, "{}", unknown_name("key", entry.key(), keys));
  if (!j.contains("scene")) return fail(ErrorKind::input, file + ": /scene", "is missing");
  auto job = job_from_json(j.value("job", Json::object()).dump());
  if (!job) return std::unexpected(Error{ErrorKind::input, job.error().message, file + ": /job" + job.error().place});
  golden.job = *job;
  const auto scene = resolve(j, "scene", file, root, assets, golden),
             sky = resolve(j, "sky", file, root, assets, golden);
  if (!scene) return std::unexpected(scene.error());
  if (!sky) return std::unexpected(sky.error());
  golden.job.scene = *scene;
  if (!sky->empty() || !is_sky_word(golden.job.sky)) golden.job.sky = *sky;
  if (const fs::path look = root.parent_path() / golden.job.look; !golden.job.look.empty()) {
    if (auto allowed = check_named_file(look, root.parent_path(), file); !allowed)
      return fail(ErrorKind::input, file + ": /job/look", "{}", allowed.error().message);
    golden.job.look = look.string();
  }
  const auto below_root = [&](const std::string& name) -> Expected<std::string> {
    const fs::path named = root.parent_path() / name;
    if (auto allowed = check_named_file(named, root.parent_path(), file); !allowed)
      return fail(ErrorKind::input, file + ": /job", "{}", allowed.error().message);
    return named.string();
  };
  if (auto named = rename_motion_files(golden.job, below_root); !named) return std::unexpected(named.error());
  if (auto checked = check_job(golden.job); !checked)
    return std::unexpected(Error{ErrorKind::input, checked.error().text(), file + ": /job"});
  if (auto good = read_time(j, file, golden); !good) return std::unexpected(good.error());
  if (auto good = read_accepted(j, file, golden); !good) return std::unexpected(good.error());
  golden.exr = j.value("format", Json("png")) == "exr";
  golden.made = read_device(j.value("made", Json()));
  if (j.contains("also_made") && j["also_made"].is_object())
    for (const auto& [device_class, made] : j["also_made"].items()) golden.also_made[device_class] = read_device(made);
  return golden;
}

}  // namespace

Expected<std::vector<GoldenManifest>> read_goldens(const fs::path& root, const fs::path& assets,
                                                   const std::string& filter) {
  std::vector<fs::path> folders;
  std::error_code failed;
  const fs::path whole_root = fs::absolute(root).lexically_normal();
  for (fs::directory_iterator entry(whole_root, failed), end; !failed && entry != end; entry.increment(failed))
    if (fs::exists(entry->path() / "golden.json") &&
        entry->path().filename().string().find(filter) != std::string::npos)
      folders.push_back(entry->path());
  if (failed)
    return fail(ErrorKind::input, root.string(),
                "cannot be read: {}; name the folder of goldens with --root, or make one with candela golden add",
                failed.message());
  std::sort(folders.begin(), folders.end());
  std::vector<GoldenManifest> goldens;
  for (const fs::path& folder : folders) {
    auto golden = read_golden(folder, whole_root, assets);
    if (!golden) return std::unexpected(golden.error());
    goldens.push_back(std::move(*golden));
  }
  if (goldens.empty())
    return fail(ErrorKind::usage, filter.empty() ? "--root" : "--filter", "no golden below {}{}", root.string(),
                filter.empty() ? "" : fmt::format(" has '{}' in its name", filter));
  return goldens;
}

}  // namespace candela::cli
