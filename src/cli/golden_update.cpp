#include "cli/golden_update.h"

#include <algorithm>
#include <cstdlib>

#include "base/file_uses.h"
#include "base/files.h"
#include "base/json.h"
#include "base/text.h"

namespace candela::cli {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::string first_line(const fs::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return {};
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  return text.substr(0, text.find('\n'));
}

Json made_json(const GoldenManifest& golden, const GoldenDevice& picture) {
  Json made = {{"device_class", picture.device_class},
               {"device", picture.device},
               {"driver", picture.driver},
               {"version", CANDELA_VERSION}};
  if (const std::string by = golden_person(); !by.empty()) made["by"] = by;
  if (const std::string commit = golden_commit(golden.folder); !commit.empty()) made["commit"] = commit;
  return made;
}

// The manifest with where its picture was made.
Expected<void> write_manifest(const GoldenManifest& golden, const GoldenDevice& picture) {
  Json j = own_json(golden.text);  // read once already
  // A new golden starts with the limits that the program proposes, written out so that they can be seen and changed.
  const Json proposed = own_json(gate_limits_json({}));
  for (const auto& [limit, value] : proposed["gate"].items())
    if (!j["gate"].contains(limit)) j["gate"][limit] = value;
  const bool own = golden.made.device_class.empty() || golden.made.device_class == picture.device_class;
  (own ? j["made"] : j["also_made"][picture.device_class]) = made_json(golden, picture);
  return write_file_atomically(golden.folder / "golden.json", j.dump(2) + "\n");
}

}  // namespace

// The commit that the folder's Git checkout stands at; empty outside of one.
std::string golden_commit(const fs::path& of) {
  fs::path folder = of;
  std::error_code failed;
  folder = fs::absolute(folder, failed).lexically_normal();
  for (; !fs::exists(folder / ".git", failed); folder = folder.parent_path())
    if (folder == folder.root_path()) return {};
  fs::path git = folder / ".git";
  if (!fs::is_directory(git, failed)) {  // a worktree names its folder
    const std::string line = first_line(git);
    if (!line.starts_with("gitdir: ")) return {};
    git = folder / line.substr(8);
  }
  std::string commit = first_line(git / "HEAD");
  if (commit.starts_with("ref: ")) {
    const std::string common = first_line(git / "commondir");
    commit = first_line((common.empty() ? git : git / common) / commit.substr(5));
  }
  return commit.substr(0, 12);
}

std::string golden_person() {
  for (const char* name : {"GIT_AUTHOR_NAME", "USER", "LOGNAME"})
    if (const char* value = std::getenv(name); value && *value) return value;
  return {};
}

Expected<void> note_changes(const fs::path& root, const std::vector<std::string>& names, const GoldenDevice& picture,
                            const std::string& why) {
  const fs::path file = root / "CHANGES.md";
  std::string text = "# Why goldens changed\n\nWritten by `candela golden update`, newest first.\n";
  std::error_code failed;
  if (fs::exists(file, failed)) {
    const auto bytes = read_file(file);
    if (!bytes) return std::unexpected(bytes.error());
    text.assign(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  }
  std::string heading = why;
  std::replace(heading.begin(), heading.end(), '\n', ' ');
  const std::string by = golden_person(), commit = golden_commit(root);
  const std::string entry =
      fmt::format("\n## {}\n{} (candela {}, {}{}{})\n", heading, joined(names), CANDELA_VERSION, picture.device_class,
                  by.empty() ? "" : ", by " + by, commit.empty() ? "" : ", at " + commit);
  const size_t newest = text.find("\n\n## ");  // the blank line before it ends the introduction
  text.insert(newest == std::string::npos ? text.size() : newest + 1, entry);
  return write_file_atomically(file, std::string_view(text));
}

Expected<bool> update_golden(const GoldenManifest& golden, const GoldenUpdate& update, const fs::path& scratch,
                             GoldenDevice& picture) {
  const fs::path fresh = scratch / (golden.name + golden.ending());
  const auto rendered = render_golden(golden, update.settings, update.allow_blank, fresh);
  if (!rendered) return std::unexpected(Error{rendered.error().kind, rendered.error().text(), golden.name});
  picture = *rendered;
  if (!update.device_class.empty() && update.device_class != picture.device_class)
    return fail(ErrorKind::usage, "--device-class", "the device is {} ({}), not {}", picture.device_class,
                picture.device, update.device_class);
  const bool other = !golden.made.device_class.empty() && golden.made.device_class != picture.device_class;
  if (other && update.device_class.empty())
    return fail(ErrorKind::usage, golden.name,
                "was made on {}, this device is {}; --device-class {} keeps a picture of its own for it",
                golden.made.device_class, picture.device_class, picture.device_class);
  const fs::path kept = other ? golden.own_picture(picture.device_class) : golden.picture();
  if (auto fine = check_output(kept); !fine) return std::unexpected(fine.error());
  const auto bytes = read_file(fresh);
  if (!bytes) return std::unexpected(bytes.error());
  std::error_code failed;
  if (fs::exists(kept, failed)) {
    const auto before = read_image(kept), after = read_image(fresh);
    if (before && after && picture_digest(*before) == picture_digest(*after)) return false;
  }
  if (auto written = write_file_atomically(kept, std::span<const std::byte>(*bytes)); !written)
    return std::unexpected(written.error());
  if (auto written = write_manifest(golden, picture); !written) return std::unexpected(written.error());
  return true;
}

}  // namespace candela::cli
