#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/golden_run.h"

namespace candela::cli {

struct GoldenUpdate {
  RunSettings settings;
  bool allow_blank = false;
  std::string device_class;  // empty: the one that a golden was made on
};

// Renders a golden and keeps its picture, with where, by whom and at which commit it was made, unless it is the one
// that is kept. On another class of device than the golden's own, which `update` has to name, the picture is that
// class's own, beside the first. True when a picture was written.
Expected<bool> update_golden(const GoldenManifest& golden, const GoldenUpdate& update,
                             const std::filesystem::path& scratch, GoldenDevice& picture);

// Who works here (GIT_AUTHOR_NAME, else the user) and the commit of the folder's checkout; empty where nothing says it.
std::string golden_person();
std::string golden_commit(const std::filesystem::path& folder);

// One entry of CHANGES.md, before the older ones.
Expected<void> note_changes(const std::filesystem::path& root, const std::vector<std::string>& names,
                            const GoldenDevice& picture, const std::string& why);

// `golden accept`: src/cli/golden_accept.cpp. `golden add`: src/cli/golden_add.cpp.
void add_golden_accept(CLI::App& golden, Action& action);
void add_golden_add(CLI::App& golden, Action& action);

}  // namespace candela::cli
