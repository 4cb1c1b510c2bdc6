#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "gltf_builder.h"

namespace candela::test::gltf_files {
namespace {

namespace fs = std::filesystem;

const fs::path& assets() {
  static const fs::path path = fs::path(CANDELA_SOURCE_DIR) / ".." / "shared" / "assets";
  return path;
}
#define NEED_ASSETS() \
  if (!fs::exists(assets())) GTEST_SKIP() << "the folder shared/assets is absent"

size_t triangles(const Scene& scene) {
  size_t count = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const MeshSection& s : mesh.sections) count += s.topology == Topology::triangles ? s.index.size() / 3 : 0;
  return count;
}

void expect_whole(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes)
    for (const MeshSection& s : mesh.sections) {
      const size_t n = s.position.size();
      for (const uint32_t i : s.index) ASSERT_LT(i, n) << s.place;
      for (const size_t size : {s.normal.size(), s.tangent.size(), s.uv0.size(), s.uv1.size(), s.color.size(),
                                s.joints0.size(), s.weights0.size()})
        ASSERT_TRUE(size == 0 || size == n) << s.place;
      if (s.topology == Topology::triangles) ASSERT_EQ(s.normal.size(), n) << s.place;
    }
  for (const Material& m : scene.materials)
    for (const TextureSlot* slot :
         {&m.base_color_texture, &m.orm_texture, &m.normal_texture, &m.emissive_texture, &m.occlusion_texture}) {
      if (!*slot) continue;
      ASSERT_LT(size_t(slot->image), scene.images.size());
      ASSERT_LT(size_t(slot->sampler), scene.samplers.size());
      const SceneImage& image = scene.images[size_t(slot->image)];
      ASSERT_TRUE(!image.encoded.empty() || image.merge_occlusion >= 0 || image.glossiness_of >= 0) << image.place;
    }
}

TEST(GltfFiles, EveryAssetLoadsOrEndsInTheRightRefusal) {
  NEED_ASSETS();
  const std::map<std::string, std::string> refused = {{"ACMEBox.gltf", "ACME_gizmo"},
                                                      {"Compatibility_04.gltf", "UNKNOWN_ASSET_MINOR_VERSION"},
                                                      {"Compatibility_05.gltf", "FAKE_materials_quantumRendering"}};
  int loaded = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(assets())) {
    const std::string path = entry.path().string(), ending = entry.path().extension().string();
    if ((ending != ".gltf" && ending != ".glb") || path.find("malformed") != std::string::npos) continue;
    const Expected<Scene> scene = load_gltf(entry.path());
    const auto refusal = refused.find(entry.path().filename().string());
    if (refusal == refused.end()) {
      ASSERT_TRUE(scene) << scene.error().text();
      expect_whole(*scene);
      EXPECT_FALSE(scene->order.empty()) << path;
      ++loaded;
    } else {
      ASSERT_FALSE(scene) << path;
      EXPECT_EQ(scene.error().kind, ErrorKind::input);
      EXPECT_NE(scene.error().message.find(refusal->second), std::string::npos) << scene.error().text();
    }
  }
  EXPECT_GE(loaded, 100);
}

TEST(GltfFiles, NothingMalformedCrashes) {
  NEED_ASSETS();
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(assets() / "malformed")) {
    const std::string ending = entry.path().extension().string();
    if (ending != ".gltf" && ending != ".glb") continue;
    const Expected<Scene> scene = load_gltf(entry.path());
    if (scene)
      expect_whole(*scene);
    else
      EXPECT_EQ(scene.error().kind, ErrorKind::input) << scene.error().text();
  }
}

TEST(GltfFiles, EveryTruncationOfABinaryFileIsAnError) {
  GltfBuilder b;
  b.triangle();
  const std::vector<std::byte> whole = b.glb();
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(load_gltf_from_memory(std::span(whole).first(size), "t.glb", "")) << size;
  EXPECT_TRUE(load_gltf_from_memory(whole, "t.glb", ""));
}

// gltfpack made both from one file, so that the compressed one must decode to the same values.
TEST(GltfFiles, MeshoptDecodesToTheQuantizedOriginal) {
  NEED_ASSETS();
  for (const std::string name : {"Fox/Fox", "MorphStressTest/MorphStressTest"}) {
    const Expected<Scene> a = load_gltf(assets() / "quantization" / (name + ".quantized.glb")),
                          b = load_gltf(assets() / "quantization" / (name + ".meshopt.glb"));
    ASSERT_TRUE(a) << a.error().text();
    ASSERT_TRUE(b) << b.error().text();
    ASSERT_EQ(triangles(*a), triangles(*b));
    for (size_t m = 0; m < a->meshes.size(); ++m)
      for (size_t s = 0; s < a->meshes[m].sections.size(); ++s) {
        const MeshSection &x = a->meshes[m].sections[s], &y = b->meshes[m].sections[s];
        EXPECT_EQ(x.bounds.min, y.bounds.min);
        EXPECT_EQ(x.bounds.max, y.bounds.max);
        EXPECT_EQ(x.morph.size(), y.morph.size());
      }
    ASSERT_EQ(a->animations.size(), b->animations.size());
    for (size_t i = 0; i < a->animations.size(); ++i)
      for (size_t c = 0; c < a->animations[i].channels.size(); ++c) {
        const AnimationChannel &x = a->animations[i].channels[c], &y = b->animations[i].channels[c];
        ASSERT_EQ(x.values.size(), y.values.size());
        EXPECT_EQ(x.values, y.values);  // gltfpack -c compresses without filters, so nothing may be lost
      }
  }
  const Expected<Scene> pirate = load_gltf(assets() / "unsupported/meshopt_pirate/pirate.glb");
  ASSERT_TRUE(pirate) << pirate.error().text();
  EXPECT_EQ(triangles(*pirate), 5010u);
}

TEST(GltfFiles, DracoBoxIsTheBox) {
  NEED_ASSETS();
  const Expected<Scene> scene = load_gltf(assets() / "unsupported/draco_Box/Box_Draco.glb");
  if (!scene && scene.error().message.find("module cannot be opened") != std::string::npos)
    GTEST_SKIP() << scene.error().text();
  ASSERT_TRUE(scene) << scene.error().text();
  const MeshSection& s = scene->meshes.at(0).sections.at(0);
  EXPECT_EQ(s.index.size(), 36u);
  EXPECT_EQ(s.position.size(), 24u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(s.bounds.min[axis], -0.5f, 1e-3f);
    EXPECT_NEAR(s.bounds.max[axis], 0.5f, 1e-3f);
  }
  // The triangles wind around their normals.
  for (size_t i = 0; i < s.index.size(); i += 3) {
    const glm::vec3 a = s.position[s.index[i]], b = s.position[s.index[i + 1]], c = s.position[s.index[i + 2]];
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), s.normal[s.index[i]]), 0.5f);
  }
}

TEST(GltfFiles, ThreeWaysOfStoringOneModelAreOneModel) {
  NEED_ASSETS();
  const auto load = [&](const char* path) {
    Expected<Scene> scene = load_gltf(assets() / "khronos/CesiumMan" / path);
    EXPECT_TRUE(scene) << scene.error().text();
    return *scene;
  };
  const Scene a = load("glTF-Binary/CesiumMan.glb"), b = load("glTF-Embedded/CesiumMan.gltf"),
              c = load("glTF/CesiumMan.gltf");
  for (const Scene* other : {&b, &c}) {
    EXPECT_EQ(a.meshes[0].sections[0].position, other->meshes[0].sections[0].position);
    EXPECT_EQ(a.meshes[0].sections[0].index, other->meshes[0].sections[0].index);
    EXPECT_EQ(a.skins[0].inverse_bind, other->skins[0].inverse_bind);
  }
  EXPECT_EQ(a.files.size(), 1u);
  EXPECT_EQ(c.files.size(), 3u);  // the scene, its buffer, its texture
}

TEST(GltfFiles, EscapedNamesAndMissingFiles) {
  const fs::path folder = fs::path(testing::TempDir()) / "candela gltf files";
  fs::create_directories(folder);
  GltfBuilder b;
  b.triangle();
  b.json["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", "a%20b.bin"}}};
  const std::string text = b.json.dump();
  std::ofstream(folder / "scene.gltf") << text;
  const Expected<Scene> missing = load_gltf(folder / "scene.gltf");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().text().find("a b.bin"), std::string::npos) << missing.error().text();
  EXPECT_EQ(missing.error().place, (folder / "scene.gltf").string() + ": /buffers/0/uri");
  std::ofstream(folder / "a b.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(b.binary.data()), long(b.binary.size()));
  const Expected<Scene> scene = load_gltf(folder / "scene.gltf");
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->files, (std::vector<std::string>{(folder / "scene.gltf").string(), (folder / "a b.bin").string()}));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace candela::test::gltf_files
