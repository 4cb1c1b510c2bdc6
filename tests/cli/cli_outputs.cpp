#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "base/files.h"
#include "program.h"

namespace candela::test::cli_outputs {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

// A scene of files that lie beside it, with a sky, a look and pictures.
class Outputs : public ::testing::Test {
 protected:
  Outputs() {
    const Arguments small = {"--size", "16x9", "--quality", "draft", "--quiet"};
    Arguments words = {"render", scene("spheres"), "-o", folder / "tex.png", "-o", folder / "sky.exr"};
    words.insert(words.end(), small.begin(), small.end());
    const Ended made = candela(words);
    EXPECT_EQ(made.code, 0) << made.err;
    for (const char* copy : {"ref.png", "new.png", "unused.png"}) fs::copy_file(folder / "tex.png", folder / copy);
    std::ofstream(folder / "look.json") << R"({"exposure": {"ev": 0}})";
    std::ofstream(folder / "q.gltf") << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
      "material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
      "textures": [{"source": 0}, {"source": 1}], "images": [{"uri": "tex.png"}, {"uri": "unused.png"}],
      "buffers": [{"uri": "q.bin", "byteLength": 60}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
      "max": [1, 1, 0]}, {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}]})";
    const float bytes[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
    std::ofstream(folder / "q.bin", std::ios::binary).write(reinterpret_cast<const char*>(bytes), sizeof bytes);
    std::ofstream(folder / "suite.json") << R"({"scenes": ["q.gltf"], "sizes": ["16x9"]})";
  }
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> files;
    for (const std::string& name : files_in(folder.path()))
      if (!fs::is_directory(folder / name)) files[name] = bytes_of(folder / name);
    return files;
  }
  // Exit 2, a message with these parts, and no file new, gone or other.
  void refused(Arguments words, const Arguments& parts) {
    const auto before = contents();
    const Ended ended = candela(words, folder.path().string());
    std::string line;
    for (const std::string& word : words) line += word + " ";
    EXPECT_EQ(ended.code, 2) << line << ended.err;
    for (const std::string& part : parts) EXPECT_NE(ended.err.find(part), std::string::npos) << line << ended.err;
    EXPECT_TRUE(contents() == before) << line;
  }
  void passes(const Arguments& words) {
    const Ended ended = candela(words, folder.path().string());
    EXPECT_EQ(ended.code, 0) << words.front() << ": " << ended.err;
  }
  Arguments render(Arguments more) const {
    Arguments words = {"render", "q.gltf", "--size", "16x9", "--quality", "draft", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  TestFolder folder;
};

TEST_F(Outputs, WhatIsReadIsNotOverwritten) {
  refused(render({"--sky", "sky.exr", "-o", "sky.exr"}), {"-o: ", "'sky.exr'", "--sky", "name another file"});
  refused(render({"-o", "y.exr", "--timings", "q.gltf"}), {"--timings: ", "'q.gltf'", "SCENE"});
  refused(render({"--look", "look.json", "-o", "y.exr", "--trace", "look.json"}), {"--trace: ", "--look"});
  refused({"bench", "q.gltf", "--json", "q.gltf"}, {"--json: ", "'q.gltf'", "SCENE"});
  refused({"compare", "ref.png", "new.png", "--heatmap", "ref.png"}, {"--heatmap: ", "'ref.png'", "for A"});
  refused({"sheet", "ref.png", "new.png", "-o", "./new.png"}, {"-o: ", "'./new.png'", "PICTURE"});
}

// Files that the scene names are known when it is read, and nothing is written before.
TEST_F(Outputs, WhatTheSceneNamesIsNotOverwritten) {
  refused(render({"-o", "y.exr", "-o", "tex.png"}), {"-o: ", "tex.png", "q.gltf", "name another file"});
  refused(render({"-o", "unused.png"}), {"-o: ", "unused.png"});
  refused(render({"-o", "y.exr", "--timings", "q.bin"}), {"--timings: ", "q.bin"});
  refused({"sequence", "q.gltf", "--frames", "0-2", "-o", "#.exr", "--timings", "q.bin", "--size", "16x9"},
          {"--timings: ", "q.bin"});
  refused({"reference", "q.gltf", "-o", "tex.png", "--spp", "1", "--size", "16x9"}, {"-o: ", "tex.png"});
  refused({"bench", "suite.json", "--csv", "q.bin"}, {"--csv: ", "q.bin"});
  refused({"bench", "suite.json", "--csv", "q.gltf"}, {"--csv: ", "q.gltf"});
  fs::copy_file(folder / "tex.png", folder / "7.png");
  std::ofstream(folder / "n.gltf") << R"({"asset": {"version": "2.0"}, "images": [{"uri": "7.png"}]})";
  refused({"sequence", "n.gltf", "--frames", "0-9", "-o", "%d.png", "--size", "16x9"}, {"-o: ", "7.png"});
  refused({"farm", "shell", "n.gltf", "--frames", "0-9", "-o", "%d.png", "--job", "job"}, {"-o: ", "7.png"});
}

TEST_F(Outputs, TwoOutputsAreTwoFiles) {
  refused(render({"-o", "y.png", "--timings", "y.png"}), {"--timings: ", "'y.png'", "-o", "name two files"});
  refused(render({"-o", "y.exr", "-o", "./y.exr"}), {"-o: ", "'./y.exr'", "'y.exr'"});
  fs::create_symlink("y.exr", folder / "link.exr");  // to what is not there
  refused(render({"-o", "y.exr", "-o", "link.exr"}), {"-o: ", "'link.exr'", "'y.exr'"});
  std::ofstream(folder / "z.exr") << "there";
  fs::create_hard_link(folder / "z.exr", folder / "hard.exr");
  refused(render({"-o", "z.exr", "-o", "hard.exr"}), {"-o: ", "'hard.exr'", "'z.exr'"});
  refused(render({"--frames", "0-2", "-o", "f#.exr", "-o", "f1.exr"}), {"-o"});
}

TEST_F(Outputs, LinksToInputsAreInputs) {
  fs::create_symlink("q.gltf", folder / "soft");
  fs::create_hard_link(folder / "q.gltf", folder / "hard");
  fs::create_symlink(".", folder / "here");
  for (const char* name : {"soft", "hard", "here/q.gltf"})
    refused(render({"-o", "y.exr", "--timings", name}), {"--timings: ", name, "SCENE"});
}

// Options of a file are options too.
TEST_F(Outputs, WhatAConfigurationFileNamesIsCheckedToo) {
  std::ofstream(folder / "c.toml") << "timings = \"q.gltf\"\n";
  refused(render({"-o", "y.exr", "--config", "c.toml"}), {"--timings: ", "'q.gltf'", "SCENE"});
  refused(render({"-o", "y.exr", "--config", "c.toml", "--timings", "c.toml"}), {"--timings: ", "--config"});
}

// A report holds NAME.png: of a golden named "golden", in the golden's folder, the golden itself.
TEST_F(Outputs, AReportOverwritesNoGolden) {
  passes({"golden", "add", "q.gltf", "--root", "goldens", "--name", "golden", "--size", "16x9", "--quality", "draft",
          "--allow-blank", "--quiet"});
  const std::string kept = bytes_of(folder / "goldens/golden/golden.png");
  refused({"golden", "check", "--root", "goldens", "--report", "goldens/golden"},
          {"--report: ", "golden.png", "--root"});
  EXPECT_EQ(bytes_of(folder / "goldens/golden/golden.png"), kept);
  passes({"golden", "check", "--root", "goldens", "--report", "report", "--allow-blank", "--quiet"});
  passes({"golden", "update", "--root", "goldens", "--why", "again", "--allow-blank", "--quiet"});
}

TEST_F(Outputs, WhatIsOnesOwnIsWrittenAgain) {
  for (int i = 0; i < 2; ++i) passes(render({"-o", "y.exr", "-o", "y.png", "--timings", "t.json"}));
  const Arguments film = {"sequence", "q.gltf",    "--frames", "0-1",     "-o",       "f#.png",    "--size",
                          "16x9",     "--quality", "draft",    "--quiet", "--resume", "--timings", "t.json"};
  for (int i = 0; i < 2; ++i) passes(film);
  const Arguments traced = {"reference", "q.gltf", "-o",      "r.exr",   "--spp",    "1",
                            "--size",    "16x9",   "--state", "r.state", "--resume", "--quiet"};
  for (int i = 0; i < 2; ++i) passes(traced);
}

}  // namespace
}  // namespace candela::test::cli_outputs
