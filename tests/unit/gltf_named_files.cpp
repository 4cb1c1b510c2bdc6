#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/input.h"
#include "gltf_builder.h"
#include "scene/scene_images.h"

namespace candela::test {
namespace {

namespace fs = std::filesystem;

std::string big_endian(uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text.push_back(char(value >> shift));
  return text;
}

// The head of a PNG of RGBA, 8 bits: all that says how large the picture is.
std::string png_head(uint32_t side_px) {
  return "\x89PNG\r\n\x1a\n" + big_endian(13) + "IHDR" + big_endian(side_px) + big_endian(side_px) +
         std::string("\x08\x06\0\0\0\0\0\0\0", 9);
}

class GltfNamedFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("candela-named-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder / "scene");
    b.triangle();
    store(folder / "outside.bin");
    store(folder / "scene/inside.bin");
  }
  void TearDown() override {
    set_input_rules({});
    fs::remove_all(folder);
  }
  void store(const fs::path& file) const {
    std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(b.binary.data()), long(b.binary.size()));
  }
  Expected<Scene> load() {
    std::ofstream(folder / "scene/scene.gltf") << b.json.dump();
    return load_gltf(folder / "scene/scene.gltf");
  }
  Expected<Scene> load_with_buffer(const std::string& uri) {
    b.json["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", uri}}};
    return load();
  }
  void use_image(const std::string& uri) {
    const int i = int(b.json["images"].size());
    b.json["images"].push_back({{"uri", uri}});
    b.json["textures"].push_back({{"source", i}});
    b.json["materials"].push_back({{"emissiveTexture", {{"index", i}}}});
  }
  GltfBuilder b;
  fs::path folder;
};

TEST_F(GltfNamedFiles, AreReadBelowTheScenesFolderAlone) {
  EXPECT_TRUE(load_with_buffer("inside.bin"));
  fs::create_symlink("../outside.bin", folder / "scene/link.bin");
  for (const std::string uri : {"../outside.bin", "%2e%2e/outside.bin", "..%2foutside.bin", "link.bin", "/etc/passwd",
                                "%2fetc/passwd", "/proc/self/environ"}) {
    const auto scene = load_with_buffer(uri);
    ASSERT_FALSE(scene) << uri;
    EXPECT_EQ(scene.error().kind, ErrorKind::input);
    EXPECT_NE(scene.error().text().find("/buffers/0/uri"), std::string::npos) << scene.error().text();
    EXPECT_NE(scene.error().text().find("only files below its own folder"), std::string::npos) << scene.error().text();
  }
  set_input_rules({.allowed_folders = {folder}});
  EXPECT_TRUE(load_with_buffer("../outside.bin"));
  EXPECT_TRUE(load_with_buffer("link.bin"));
}

TEST_F(GltfNamedFiles, AnImageOutsideIsRefusedToo) {
  use_image("../outside.bin");
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const auto scene = load_with_buffer("inside.bin");
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().text().find("/images/0/uri"), std::string::npos) << scene.error().text();
}

TEST_F(GltfNamedFiles, AMissingImageIsAWarningAndACheckerLikeADamagedOne) {
  use_image("absent.png");
  use_image("data:image/png;base64,iVBORw0KGgo=");
  const auto scene = load_with_buffer("inside.bin");
  ASSERT_TRUE(scene) << scene.error().text();
  ASSERT_EQ(scene->warnings.size(), 1u) << scene->warnings[1];
  for (const char* part : {"/images/0", "absent.png", placeholder_note})
    EXPECT_NE(scene->warnings[0].find(part), std::string::npos) << scene->warnings[0];
  const auto missing = decode_scene_image(*scene, 0), damaged = decode_scene_image(*scene, 1);
  ASSERT_TRUE(missing && damaged);
  EXPECT_TRUE(missing->warnings.empty()) << "said already";
  ASSERT_EQ(damaged->warnings.size(), 1u);
  EXPECT_NE(damaged->warnings[0].find(placeholder_note), std::string::npos) << damaged->warnings[0];
  EXPECT_EQ(missing->image.pixels, damaged->image.pixels);
  const std::vector<std::byte>& pixels = missing->image.pixels;
  const auto texel = [&](size_t x, size_t y, size_t channel) {
    return int(pixels[(y * size_t(missing->image.width) + x) * 4 + channel]);
  };
  EXPECT_EQ((std::vector{texel(0, 0, 0), texel(0, 0, 1), texel(0, 0, 2), texel(0, 0, 3)}),
            (std::vector{255, 0, 255, 255}));
  EXPECT_EQ((std::vector{texel(8, 0, 0), texel(8, 0, 1), texel(8, 0, 2), texel(8, 0, 3)}), (std::vector{0, 0, 0, 255}));
}

// As in the Khronos validator's files with objects that nothing uses.
TEST_F(GltfNamedFiles, WhatNobodyUsesMayBeAbsent) {
  b.json["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", "inside.bin"}},
                       {{"byteLength", 36}, {"uri", "not_found.bin"}, {"name", "unused buffer"}},
                       {{"byteLength", 36}, {"name", "buffer without bytes"}}};
  for (const int buffer : {1, 2}) {
    const int view = int(b.json["bufferViews"].size()), accessor = int(b.json["accessors"].size());
    b.json["bufferViews"].push_back({{"buffer", buffer}, {"byteLength", 36}});
    b.json["accessors"].push_back(b.json["accessors"][0]);
    b.json["accessors"][size_t(accessor)]["bufferView"] = view;
    b.primitive({{"POSITION", accessor}});
  }
  const auto scene = load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->meshes.size(), 3u);
  EXPECT_EQ(scene->meshes[0].sections.size(), 1u);
  b.json["nodes"][0]["mesh"] = 1;
  const auto used = load();
  ASSERT_FALSE(used);
  EXPECT_NE(used.error().text().find("/buffers/1/uri"), std::string::npos) << used.error().text();
  b.json["nodes"][0]["mesh"] = 2;
  EXPECT_NE(load().error().text().find("neither a uri nor a binary chunk"), std::string::npos);
}

TEST_F(GltfNamedFiles, DecodedSizesHaveABudget) {
  std::ofstream(folder / "scene/large.png") << png_head(4096);
  for (int i = 0; i < 64; ++i) use_image("large.png");
  const auto scene = load_with_buffer("inside.bin");
  ASSERT_FALSE(scene) << "5.3 GiB of textures and mips";
  EXPECT_EQ(scene.error().kind, ErrorKind::input);
  EXPECT_NE(scene.error().text().find("/images/47"), std::string::npos) << scene.error().text();
  EXPECT_NE(scene.error().text().find("more than the budget of 4096 MiB"), std::string::npos) << scene.error().text();
  set_input_rules({.decode_budget_bytes = uint64_t(6) << 30});
  const auto allowed = load();
  ASSERT_TRUE(allowed) << allowed.error().text();
  EXPECT_NEAR(double(*decoded_bytes(*allowed)), 64.0 * 4096 * 4096 * 4 * 4 / 3, 1000);
}

TEST_F(GltfNamedFiles, MeshesCountInTheBudget) {
  set_input_rules({.decode_budget_bytes = 30});
  const auto scene = load_with_buffer("inside.bin");
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().text().find("budget"), std::string::npos) << scene.error().text();
}

}  // namespace
}  // namespace candela::test
