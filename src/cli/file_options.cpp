#include "cli/file_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <vector>

#include "base/file_uses.h"
#include "image/cube_faces.h"
#include "job/job.h"
#include "look/motion.h"
#include "render/frame_names.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

const std::map<std::string, FileUse>& uses_of_options() {
  static const std::map<std::string, FileUse> uses = {
      {"scene", FileUse::scene},
      {"--sky", FileUse::sky},
      {"--look", FileUse::read},
      {"--camera-path", FileUse::path},
      {"--path", FileUse::path},
      {"--instances", FileUse::instances},
      {"--config", FileUse::read},
      {"--sweep", FileUse::read},
      {"--audio", FileUse::read},
      {"--program", FileUse::read},
      {"--from", FileUse::read},
      {"--compare", FileUse::read},
      {"what", FileUse::scene},
      {"a", FileUse::read},
      {"b", FileUse::read},
      {"pictures", FileUse::read},
      {"frames", FileUse::pattern_read},
      {"--shader-dir", FileUse::read_folder},
      {"--allow-path", FileUse::searched_folder},
      {"--assets", FileUse::searched_folder},
      {"--root", FileUse::searched_folder},
      {"folder", FileUse::searched_folder},
      {"run", FileUse::searched_folder},
      {"--output", FileUse::pattern},
      {"--dump", FileUse::dump},
      {"--video", FileUse::written},
      {"--timings", FileUse::written},
      {"--trace", FileUse::written},
      {"--state", FileUse::written},
      {"--json", FileUse::written},
      {"--csv", FileUse::written},
      {"--heatmap", FileUse::written},
      {"--html", FileUse::written},
      {"--report", FileUse::written_folder},
      {"--pictures", FileUse::written_folder},
      {"--steps", FileUse::written_folder},
      {"--record", FileUse::written_folder},
      {"--job", FileUse::written_folder},
  };
  return uses;
}

// What is written into the folder of an option whatever the job is.
Names fixed_files(const std::string& option) {
  if (option == "--report")
    return {"index.html", "rows.json", "rows.csv", "tune.json", "stability.json", "junit.xml", "run.json"};
  if (option == "--steps") return {"index.html"};
  if (option == "--job") return {"job.json", "job.sbatch", "job.py", "task.sh", "job.mk", "job.sh"};
  return {};
}

// As messages and the tables above call it.
std::string name_of(const CLI::Option& option) {
  if (!option.nonpositional()) return option.get_single_name();
  return option.get_lnames().empty() ? "-" + option.get_snames().front() : "--" + option.get_lnames().front();
}
std::string shown_name(const CLI::Option& option) {
  if (!option.nonpositional()) return option.get_type_name();
  return option.get_snames().empty() ? name_of(option) : "-" + option.get_snames().front();
}

void add_read(const std::string& shown, FileUse use, const std::string& value, std::vector<NamedFile>& read) {
  if (use == FileUse::read_folder) {
    std::error_code failed;
    for (fs::recursive_directory_iterator entry(value, failed), end; !failed && entry != end; entry.increment(failed))
      read.push_back({shown, entry->path()});
    return;
  }
  if (use == FileUse::pattern_read) {
    if (std::error_code failed; fs::is_regular_file(value, failed)) read.push_back({shown, value});
    return;
  }
  if (use == FileUse::sky && is_sky_word(value)) return;
  if (use == FileUse::sky && names_cube_faces(value)) {
    if (const auto faces = cube_face_files(value))
      for (const fs::path& face : *faces) read.push_back({shown, face});
    return;
  }
  if (use == FileUse::path) {
    const bool of_camera = shown == "--camera-path";
    if (const auto path = of_camera ? parse_path(shown, "camera", value) : parse_node_path(shown, value))
      for (const std::string& file : {path->points, path->times})
        if (!file.empty()) read.push_back({shown, file});
    return;
  }
  if (use == FileUse::instances) {
    if (const auto instances = parse_instances(shown, value)) read.push_back({shown, instances->file});
    return;
  }
  read.push_back({shown, value});
  if (use == FileUse::scene) read.push_back({shown, fs::path(value).replace_extension(".look.json")});
}

// A name with a place for the frame's number is many files, which the command declares.
void add_written(const std::string& option, const std::string& shown, FileUse use, const std::string& value,
                 std::vector<NamedFile>& written) {
  if (use == FileUse::written_folder) {
    for (const std::string& name : fixed_files(option)) written.push_back({shown, fs::path(value) / name});
    return;
  }
  const size_t equals = value.find('=');
  if (use == FileUse::dump && equals == std::string::npos) return;  // named after the first output
  const std::string name = use == FileUse::dump ? value.substr(equals + 1) : value;
  if (name.empty() || (use == FileUse::written && name == "-")) return;
  if (use == FileUse::written) return written.push_back({shown, name});
  const auto pattern = parse_pattern(name);
  if (pattern && !pattern->numbered && !pattern->by_camera) written.push_back({shown, pattern->name(0)});
}

}  // namespace

std::optional<FileUse> file_use(const std::string& command, const std::string& option) {
  if (option == "--output" && (command == "plan" || command == "facts")) return FileUse::neither;
  if (option == "--output" && command == "bench") return {};  // exr, png or both
  if (option == "--output" && (command == "sheet" || command == "film" || command == "make-scene"))
    return FileUse::written;
  const auto found = uses_of_options().find(option);
  return found == uses_of_options().end() ? std::nullopt : std::optional(found->second);
}

Expected<void> check_file_options(const CLI::App& command) {
  std::vector<NamedFile> read, written;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = name_of(*option), shown = shown_name(*option);
    const auto use = file_use(command.get_name(), name);
    if (!use || option->get_items_expected_max() == 0) continue;  // --json of most commands is a flag
    for (const std::string& value : option->results())
      if (*use <= FileUse::read_folder && *use != FileUse::neither)
        add_read(shown, *use, value, read);
      else if (*use >= FileUse::written)
        add_written(name, shown, *use, value, written);
  }
  for (const NamedFile& file : read) note_read(file);
  return declare_outputs(written);
}

}  // namespace candela::cli
