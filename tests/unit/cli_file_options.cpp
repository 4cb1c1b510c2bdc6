#include "cli/file_options.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <set>

#include "base/file_uses.h"
#include "base/log.h"
#include "cli/cli.h"
#include "cli/command.h"
#include "cli/command_tree.h"

namespace candela::cli::file_options {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// The parser's own table.
class FileOptions : public ::testing::Test {
 protected:
  FileOptions() {
    add_commands(app, action);
    collect(command_tree(app));
    folder = fs::path(testing::TempDir()) /
             (std::string("candela-options-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~FileOptions() override {
    forget_file_uses();
    fs::remove_all(folder);
  }
  void collect(const CommandEntry& command) {
    if (!command.commands.empty())
      for (const CommandEntry& c : command.commands) collect(c);
    else
      commands.push_back(command);
  }

  CLI::App app{"", "candela"};
  Action action;
  std::vector<CommandEntry> commands;
  fs::path folder;
};

// What follows an option that names no file. A word that is not here says a file, or what it says has to be decided.
bool is_no_file(const std::string& value) {
  static const std::set<std::string> words = {"",
                                              "N",
                                              "X",
                                              "S",
                                              "MS",
                                              "EV",
                                              "NAME",
                                              "LIST",
                                              "RATE",
                                              "SECONDS",
                                              "DEGREES",
                                              "WxH",
                                              "X,Y,Z",
                                              "COLOR",
                                              "X,Y,W,H",
                                              "MIB",
                                              "I/N",
                                              "SET",
                                              "SHARE",
                                              "TEXT",
                                              "NAME=VALUE",
                                              "DEVICE",
                                              "FORMAT",
                                              "SHELL",
                                              "METRES",
                                              "M",
                                              "MM",
                                              "ANGLE",
                                              "SPEED",
                                              "PX|P%",
                                              "NAME=NODE,...",
                                              "METRIC=VALUE",
                                              "PASS.KNOB=VALUE",
                                              "INT",
                                              "UINT",
                                              "FLOAT",
                                              "%",
                                              "SPP",
                                              "PERCENT",
                                              "OFF",
                                              "bvh.NAME=VALUE",
                                              "PASS.KNOB=A,B,C",
                                              "auto|off|START,STOP,COUNT",
                                              "auto|START,STOP,COUNT"};
  return words.contains(value);
}

TEST_F(FileOptions, OfEachItIsKnownWhetherItIsReadOrWritten) {
  ASSERT_GT(commands.size(), 20u);
  size_t known = 0;
  for (const CommandEntry& command : commands)
    for (const OptionEntry& option : command.options) {
      const auto use = file_use(command.name, option.names.back());
      const bool names_files = option.files != OptionEntry::Files::none;
      if (option.value.empty() && !option.positional) continue;  // a flag
      EXPECT_EQ(names_files, use.has_value()) << command.path << " " << option.names.back() << " " << option.value
                                              << ": say in cli/file_options.cpp whether the file is read or written";
      if (!names_files)
        EXPECT_TRUE(is_no_file(option.value) || !option.choices.empty())
            << command.path << " " << option.names.back() << " takes " << option.value << ": a file?";
      known += use.has_value();
    }
  EXPECT_GT(known, 80u);
}

bool reads(FileUse use) { return use == FileUse::read || use == FileUse::scene || use == FileUse::sky; }
bool writes(FileUse use) { return use >= FileUse::written; }

// A name inside, of folders; with what stands before it, of others.
std::string value_of(FileUse use, const std::string& file) {
  return use == FileUse::dump ? "pass.image=" + file : file;
}

// Every pair of an option that is written and another of the same command, at one file.
TEST_F(FileOptions, NoOutputIsAnInputOrAnotherOutput) {
  size_t pairs = 0;
  for (const CommandEntry& command : commands)
    for (const OptionEntry& written : command.options) {
      const auto to = file_use(command.name, written.names.back());
      if (!to || !writes(*to) || written.value.empty()) continue;
      for (const OptionEntry& other : command.options) {
        const auto from = file_use(command.name, other.names.back());
        if (!from || &other == &written || other.value.empty()) continue;
        if (!reads(*from) && (!writes(*from) || *from == FileUse::written_folder)) continue;
        // Folders: of the files in them, one that this command writes.
        const fs::path file = *to != FileUse::written_folder       ? folder / "file"
                              : written.names.back() == "--report" ? folder / "index.html"
                              : written.names.back() == "--job"    ? folder / "job.json"
                                                                   : fs::path();
        if (file.empty()) continue;  // --record and --pictures: their files have names of their own
        std::ofstream(file) << "before";
        const std::string target = *to == FileUse::written_folder ? folder.string() : file.string();
        CLI::App one{"", "candela"};
        Action none;
        add_commands(one, none);
        CLI::App* leaf = &one;
        for (size_t at = command.path.find(' '); at != std::string::npos; at = command.path.find(' ', at + 1))
          leaf = leaf->get_subcommand(command.path.substr(at + 1, command.path.find(' ', at + 1) - at - 1));
        const auto give = [&](const OptionEntry& option, const std::string& value) {
          leaf->get_option(option.names.back())->add_result(value);
        };
        give(written, value_of(*to, target));
        give(other, value_of(*from, file.string()));
        forget_file_uses();
        const auto fine = check_file_options(*leaf);
        const std::string what = command.path + " " + written.names.back() + " " + other.names.back();
        ++pairs;
        ASSERT_FALSE(fine) << what;
        EXPECT_EQ(fine.error().kind, ErrorKind::usage) << what;
        for (const std::string& part : {other.positional ? other.value : other.names.front(), written.names.front(),
                                        file.filename().string(), std::string("; name ")})
          EXPECT_NE(fine.error().text().find(part), std::string::npos) << what << ": " << fine.error().text();
      }
    }
  EXPECT_GT(pairs, 150u);
}

TEST_F(FileOptions, FoldersAreTheirFilesAndWhatIsNoConflictIsNone) {
  const std::string scene = (folder / "s.gltf").string(), out = (folder / "y.exr").string();
  std::ofstream(scene) << "{}";
  const auto fine = [&](Words words) {
    CLI::App one{"", "candela"};
    Action none;
    add_commands(one, none);
    std::reverse(words.begin(), words.end());
    one.parse(words);
    const CLI::App* leaf = &one;
    while (!leaf->get_subcommands().empty()) leaf = leaf->get_subcommands().front();
    forget_file_uses();
    return bool(check_file_options(*leaf));
  };
  EXPECT_TRUE(fine({"render", scene, "-o", out, "--timings", "-", "--trace", "-"}));
  EXPECT_TRUE(fine({"render", scene, "--timings", "/dev/null", "--trace", "/dev/null", "-o", out}));
  EXPECT_TRUE(fine({"compare", out, out}));
  EXPECT_TRUE(fine({"sheet", out, out, "-o", (folder / "sheet.png").string()}));
  EXPECT_TRUE(fine({"render", scene, "-o", (folder / "####.exr").string(), "--frames", "0-1"}));
  EXPECT_TRUE(fine({"plan", scene, "-o", out, "-o", out}));
  EXPECT_TRUE(fine({"render", scene, "--sky", "none", "--look", "none", "-o", out, "--json"}));
  fs::create_directories(folder / "shaders/lib");
  fs::create_directories(folder / "faces");
  std::ofstream(folder / "shaders/lib/noise.glsl") << "";
  for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"})
    std::ofstream(folder / "faces" / (std::string(face) + ".png")) << "";
  const std::string shaders = (folder / "shaders").string(), faces = (folder / "faces").string();
  EXPECT_FALSE(fine({"render", scene, "-o", out, "--shader-dir", shaders, "--trace", shaders + "/lib/noise.glsl"}));
  EXPECT_FALSE(fine({"render", scene, "-o", faces + "/ny.png", "--sky", faces}));
  EXPECT_TRUE(fine({"render", scene, "-o", faces + "/other.png", "--sky", faces}));
  EXPECT_FALSE(fine({"render", scene, "-o", out, "--timings", (folder / "s.look.json").string()}))
      << "it would be the scene's look from then on";
}

}  // namespace
}  // namespace candela::cli::file_options
