#include "scene/make_scene.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "base/files.h"
#include "scene/gltf.h"
#include "scene/procedural_shapes.h"

namespace candela {
namespace {

std::vector<std::byte> made(std::string_view name, uint64_t seed = 1, int lights = 0) {
  auto bytes = make_scene_bytes(std::string(name), seed, lights);
  EXPECT_TRUE(bytes.has_value()) << name;
  return bytes.value_or(std::vector<std::byte>{});
}

nlohmann::json document(const std::vector<std::byte>& glb) {
  uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  const char* text = reinterpret_cast<const char*>(glb.data() + 20);
  return nlohmann::json::parse(text, text + length);
}

TEST(MakeScene, ReproducesTheCommittedFiles) {
  const std::filesystem::path folder = std::filesystem::path(CANDELA_SOURCE_DIR) / "scenes";
  for (std::string_view name : scene_names()) {
    const auto committed = read_file(folder / name / (std::string(name) + ".glb"));
    ASSERT_TRUE(committed.has_value()) << committed.error().text();
    EXPECT_TRUE(*committed == made(name)) << name << ": make it again with candela make-scene " << name << " --seed 1";
  }
}

TEST(MakeScene, EveryCommittedSceneHasAName) {
  std::set<std::string> names;
  for (std::string_view name : scene_names()) names.emplace(name);
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(CANDELA_SOURCE_DIR) / "scenes"))
    if (entry.is_directory()) EXPECT_TRUE(names.contains(entry.path().filename().string())) << entry.path();
}

TEST(MakeScene, FilesAreSmallWholeAndHaveACamera) {
  for (std::string_view name : scene_names()) {
    const auto bytes = made(name);
    EXPECT_LT(bytes.size(), 60000u) << name;
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 8, 4);
    EXPECT_EQ(length, bytes.size()) << name;
    EXPECT_EQ(document(bytes)["cameras"].size(), 1u) << name;
    EXPECT_FALSE(scene_description(name).empty());
  }
}

TEST(MakeScene, EverySceneLoadsWithoutAWarningAndWithAllItsExtensions) {
  for (std::string_view name : scene_names()) {
    const auto scene = load_gltf_from_memory(made(name), std::string(name), "");
    ASSERT_TRUE(scene.has_value()) << scene.error().text();
    for (const std::string& warning : scene->warnings) ADD_FAILURE() << name << ": " << warning;
    for (const ExtensionUse& use : scene->extensions)
      EXPECT_EQ(use.support, Support::supported) << name << ": " << use.name;
  }
}

TEST(MakeScene, TheSeedChangesSeededScenesOnly) {
  EXPECT_NE(made("instanced", 1), made("instanced", 2));
  EXPECT_NE(made("animated", 1), made("animated", 2));
  EXPECT_EQ(made("spheres", 1), made("spheres", 2));
}

TEST(MakeScene, ScattersAsManyLightsAsAsked) {
  const nlohmann::json json = document(made("animated", 1, 1000));
  int lamps = 0;
  for (const auto& node : json["nodes"]) lamps += node.value("name", "") == "lantern" ? 1 : 0;
  EXPECT_EQ(lamps, 1000);
}

TEST(MakeScene, RefusesWhatItCannotMake) {
  const auto unknown = make_scene_bytes("castle", 1, 0);
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().kind, ErrorKind::usage);
  EXPECT_NE(unknown.error().message.find("unlit-box"), std::string::npos);
  EXPECT_EQ(make_scene_bytes("spheres", 1, 5).error().kind, ErrorKind::usage);
  EXPECT_EQ(make_scene_bytes("animated", 1, -1).error().kind, ErrorKind::usage);
  EXPECT_EQ(make_scene("unlit-box", 1, 0, "/proc/none/box.glb").error().kind, ErrorKind::output);
}

TEST(MakeScene, FarWorldIsNearWorldMoved) {
  const nlohmann::json near_world = document(made("near-world")), far_world = document(made("far-world"));
  ASSERT_EQ(near_world["nodes"].size(), far_world["nodes"].size());
  int moved = 0;
  for (size_t i = 0; i < near_world["nodes"].size(); ++i) {
    const auto &a = near_world["nodes"][i], &b = far_world["nodes"][i];
    EXPECT_EQ(a["name"], b["name"]);
    if (!a.contains("translation")) continue;
    EXPECT_EQ(b["translation"][0].get<double>() - a["translation"][0].get<double>(), 1e6);
    EXPECT_EQ(b["translation"][2].get<double>() - a["translation"][2].get<double>(), -1e6);
    ++moved;
  }
  EXPECT_GE(moved, 5);
}

// The front of every triangle, by its winding, is the side its normals point to.
void expect_outward(const Shape& shape, const char* name) {
  ASSERT_EQ(shape.position.size(), shape.normal.size());
  ASSERT_GT(shape.index.size(), 0u);
  for (size_t i = 0; i < shape.index.size(); i += 3) {
    const uint32_t a = shape.index[i], b = shape.index[i + 1], c = shape.index[i + 2];
    const glm::dvec3 face = glm::cross(shape.position[b] - shape.position[a], shape.position[c] - shape.position[a]);
    EXPECT_GT(glm::length(face), 1e-9) << name << " triangle " << i / 3;
    EXPECT_GT(glm::dot(face, shape.normal[a] + shape.normal[b] + shape.normal[c]), 0) << name << " triangle " << i / 3;
  }
  for (glm::dvec3 n : shape.normal) EXPECT_NEAR(glm::length(n), 1, 1e-12) << name;
}

TEST(ProceduralShapes, WindingAgreesWithNormals) {
  expect_outward(sphere(2, 12, 8), "sphere");
  expect_outward(torus(1, 0.3, 12, 8), "torus");
  expect_outward(column(0.3, 3, 12), "column");
  expect_outward(box({1, 2, 3}, 2), "box");
  expect_outward(quad(1, 2), "quad");
  expect_outward(ground(4, 2, 1), "ground");
}

TEST(ProceduralShapes, ASphereIsClosed) {
  double volume = 0;  // by the divergence theorem: a hole or a doubled triangle would show
  const Shape shape = sphere(1, 64, 48);
  for (size_t i = 0; i < shape.index.size(); i += 3)
    volume += glm::dot(shape.position[shape.index[i]],
                       glm::cross(shape.position[shape.index[i + 1]], shape.position[shape.index[i + 2]])) /
              6;
  EXPECT_NEAR(volume, 4.18879, 0.02);
}

}  // namespace
}  // namespace candela
