#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "gltf/gltf.h"

// Every broken file that was published for the purpose, through the loader: it ends in a scene or in one line that says
// why, and where the Khronos validator has reported errors, an error or a warning names one of them.
namespace candela {
namespace {

namespace fs = std::filesystem;
const fs::path malformed = fs::path(CANDELA_SOURCE_DIR) / "../shared/assets/malformed";

std::vector<fs::path> gltf_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(malformed)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".gltf" || ending == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::set<std::string> reported_errors(const fs::path& file) {
  std::set<std::string> codes;
  std::ifstream stream(file.string() + ".report.json");
  if (!stream) return codes;
  const nlohmann::json report = nlohmann::json::parse(stream);
  for (const auto& message : report["issues"]["messages"])
    if (message["severity"] == 0) codes.insert(message["code"].get<std::string>());
  return codes;
}

bool names_one(const std::string& text, const std::set<std::string>& codes) {
  return std::any_of(codes.begin(), codes.end(),
                     [&](const std::string& code) { return text.find(code) != std::string::npos; });
}

TEST(Malformed, EveryFileLoadsOrSaysWhyNot) {
  if (!fs::exists(malformed)) GTEST_SKIP() << "the folder shared/assets is absent";
  size_t count = 0;
  for (const fs::path& file : gltf_files()) {
    SCOPED_TRACE(file.string());
    ++count;
    const Expected<Scene> scene = load_gltf(file);
    const std::set<std::string> errors = reported_errors(file);
    if (!scene) {
      EXPECT_EQ(scene.error().kind, ErrorKind::input);
      EXPECT_EQ(scene.error().text().find('\n'), std::string::npos) << scene.error().text();
      EXPECT_TRUE(scene.error().place.starts_with(file.string())) << scene.error().place;
      if (!errors.empty()) EXPECT_TRUE(names_one(scene.error().message, errors)) << scene.error().text();
      continue;
    }
    std::string warnings;
    for (const std::string& warning : scene->warnings) warnings += warning + "\n";
    if (!errors.empty()) EXPECT_TRUE(names_one(warnings, errors)) << "loaded with these warnings:\n" << warnings;
  }
  EXPECT_GE(count, 220u);
}

struct Expectation {
  const char *file, *code;
  bool loads;
};

// The files without a report beside them; the codes are those that the validator gives (MANIFEST.md).
TEST(Malformed, FilesOfOtherLoadersNameTheCode) {
  if (!fs::exists(malformed)) GTEST_SKIP() << "the folder shared/assets is absent";
  const Expectation expectations[] = {
      {"assimp/BoxBadNormals-glTF-Binary/BoxBadNormals.glb", "ACCESSOR_VECTOR3_NON_UNIT", true},
      {"assimp/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "ACCESSOR_INVALID_FLOAT", false},
      {"assimp/IncorrectVertexArrays/Cube.gltf", "BUFFER_VIEW_TOO_LONG", false},
      {"assimp/IndexOutOfRange/AllIndicesOutOfRange.gltf", "ACCESSOR_INDEX_PRIMITIVE_RESTART", true},
      {"assimp/IndexOutOfRange/IndexOutOfRange.gltf", "ACCESSOR_INDEX_OOB", false},
      {"assimp/MissingBin/BoxTextured.gltf", "IO_ERROR", false},
      {"assimp/RecursiveNodes/RecursiveNodes.gltf", "NODE_LOOP", false},
      {"assimp/TestNoRootNode/NoScene.gltf", "UNRESOLVED_REFERENCE", false},
      {"tinygltf/integer-out-of-bounds.gltf", "BUFFER_VIEW_TOO_LONG", false},
      {"tinygltf/invalid-buffer-index.gltf", "UNRESOLVED_REFERENCE", false},
      {"tinygltf/invalid-buffer-view-index.gltf", "UNRESOLVED_REFERENCE", false},
      {"tinygltf/invalid-primitive-indices.gltf", "UNRESOLVED_REFERENCE", false},
      {"tinygltf/issue-416.gltf", "PATTERN_MISMATCH", false},
      {"tinygltf/unassigned-skeleton.gltf", "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE", true},
      {"truncated/CesiumMan.head-200000.glb", "GLB_UNEXPECTED_END_OF_CHUNK_DATA", false},
      {"truncated/AlphaBlendModeTest.head-4000.glb", "GLB_UNEXPECTED_END_OF_CHUNK_DATA", false},
  };
  for (const Expectation& expected : expectations) {
    const Expected<Scene> scene = load_gltf(malformed / expected.file);
    SCOPED_TRACE(expected.file);
    EXPECT_EQ(scene.has_value(), expected.loads) << (scene ? "" : scene.error().text());
    std::string said = scene ? "" : scene.error().text();
    if (scene)
      for (const std::string& warning : scene->warnings) said += warning + "\n";
    EXPECT_NE(said.find(expected.code), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace candela
