#include <CLI/CLI.hpp>

#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/golden_run.h"
#include "cli/golden_update.h"
#include "cli/input_options.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct AcceptOptions {
  std::string run, root = "golden", assets, filter, why;
};

// A golden of a run that failed and has a picture.
struct Failed {
  std::string name, digest;
  GoldenDevice device;
};

Expected<std::vector<Failed>> failed_of(const fs::path& run) {
  const fs::path file = fs::is_directory(run) ? run / golden_run_file : run;
  const auto read = read_json_file(file);
  if (!read) return std::unexpected(read.error());
  const auto wrong = [&](size_t i) {
    return fail(ErrorKind::input, fmt::format("{}: /goldens/{}", file.string(), i),
                "is no golden of `candela golden check --report`");
  };
  if (!read->is_object() || !read->contains("goldens") || !(*read)["goldens"].is_array()) return wrong(0);
  std::vector<Failed> failed;
  const Json& goldens = (*read)["goldens"];
  for (size_t i = 0; i < goldens.size(); ++i) {
    const Json& j = goldens[i];
    if (!j.is_object()) return wrong(i);
    for (const char* key : {"name", "digest", "device_class", "device", "driver"})
      if (!j.contains(key) || !j[key].is_string()) return wrong(i);
    if (!j.contains("pass") || !j["pass"].is_boolean()) return wrong(i);
    if (j["pass"].get<bool>() || j["digest"].get<std::string>().empty()) continue;
    failed.push_back({j["name"], j["digest"], {j["device_class"], j["device"], j["driver"]}});
  }
  return failed;
}

Expected<void> accept(const GoldenManifest& golden, const Failed& failed, const std::string& why) {
  Json j = own_json(golden.text);  // read once already
  Json entry = {{"digest", failed.digest}, {"device", failed.device.device}, {"driver", failed.device.driver}};
  if (const std::string by = golden_person(); !by.empty()) entry["by"] = by;
  if (const std::string commit = golden_commit(golden.folder); !commit.empty()) entry["commit"] = commit;
  entry["why"] = why;
  j["accepted"][failed.device.device_class].push_back(entry);
  return write_file_atomically(golden.folder / "golden.json", j.dump(2) + "\n");
}

Expected<int> run_accept(const AcceptOptions& o) {
  if (o.why.empty())
    return fail(ErrorKind::usage, "--why", "say why these pictures are right too; it is kept in golden.json");
  const auto failed = failed_of(o.run);
  if (!failed) return std::unexpected(failed.error());
  const auto goldens = read_goldens(o.root, fs::path(o.assets), "");
  if (!goldens) return std::unexpected(goldens.error());
  size_t count = 0;
  for (const Failed& one : *failed) {
    if (one.name.find(o.filter) == std::string::npos) continue;
    const auto golden = std::ranges::find(*goldens, one.name, &GoldenManifest::name);
    if (golden == goldens->end())
      return fail(ErrorKind::input, o.run, "holds the golden '{}', which is not below {}", one.name, o.root);
    if (auto accepted = accept(*golden, one, o.why); !accepted) return std::unexpected(accepted.error());
    log::info("{}: accepted on {}", one.name, one.device.device);
    ++count;
  }
  if (count == 0)
    return fail(ErrorKind::usage, o.filter.empty() ? "RUN" : "--filter", "{} holds no failed picture{}", o.run,
                o.filter.empty() ? "" : fmt::format(" of a golden with '{}' in its name", o.filter));
  log::info("{} pictures accepted; commit the changed golden.json", count);
  return 0;
}

}  // namespace

void add_golden_accept(CLI::App& golden, Action& action) {
  auto o = std::make_shared<AcceptOptions>();
  CLI::App* accept = golden.add_subcommand(
      "accept", "Keep the failed pictures of a run as right too, beside the goldens' own, after looking at its page");
  accept->add_option("run", o->run, "Folder of `golden check --report`")->required()->type_name("DIR");
  accept->add_option("--why", o->why, "Why they are right too; kept in golden.json")->type_name("TEXT");
  accept->add_option("--filter", o->filter, "Only goldens with this in their name")->type_name("TEXT");
  accept->add_option("--root", o->root, "Folder of the goldens")->capture_default_str()->type_name("DIR");
  accept->add_option("--assets", o->assets, "As for check")->type_name("DIR");
  accept->callback([o, &action] { action = [o] { return run_accept(*o); }; });
}

}  // namespace candela::cli
