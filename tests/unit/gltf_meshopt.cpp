#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "gltf_builder.h"

namespace candela::test::gltf_meshopt {
namespace {

// EXT_meshopt_compression as encoders write it: the view lies in a fallback buffer without bytes, its data in buffer 0.
struct MeshoptBuilder : GltfBuilder {
  MeshoptBuilder() {
    use("EXT_meshopt_compression", true);
    use("KHR_mesh_quantization", true);
  }

  int compressed(std::vector<unsigned char> bytes, const std::string& mode, const std::string& filter, size_t count,
                 size_t stride) {
    binary.resize((binary.size() + 3) / 4 * 4);
    Json view = {{"buffer", 1}, {"byteOffset", fallback_bytes}, {"byteLength", count * stride}};
    if (mode == "ATTRIBUTES") view["byteStride"] = stride;
    Json& meshopt = view["extensions"]["EXT_meshopt_compression"];
    meshopt = {{"buffer", 0},    {"byteOffset", binary.size()}, {"byteLength", bytes.size()}, {"mode", mode},
               {"count", count}, {"byteStride", stride}};
    if (!filter.empty()) meshopt["filter"] = filter;
    fallback_bytes += (count * stride + 3) / 4 * 4;
    const std::byte* p = reinterpret_cast<const std::byte*>(bytes.data());
    binary.insert(binary.end(), p, p + bytes.size());
    json["bufferViews"].push_back(view);
    return int(json["bufferViews"].size()) - 1;
  }
  template <class T>
  int attributes(const std::vector<T>& values, const std::string& filter, size_t count, size_t stride) {
    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(count, stride));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), count, stride));
    return compressed(bytes, "ATTRIBUTES", filter, count, stride);
  }
  int described(int view, const std::string& type, int component_type, size_t count, bool normalized) {
    json["accessors"].push_back({{"bufferView", view},
                                 {"type", type},
                                 {"componentType", component_type},
                                 {"count", count},
                                 {"normalized", normalized}});
    return int(json["accessors"].size()) - 1;
  }
  Expected<Scene> load() {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["buffers"] = {
        {{"byteLength", binary.size()}},
        {{"byteLength", fallback_bytes}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    return GltfBuilder::load();
  }
  size_t fallback_bytes = 0;
};

constexpr size_t corners = 4;
const std::vector<float> square = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

int add_positions(MeshoptBuilder& b) {
  const int position = b.described(b.attributes(square, "", corners, 12), "VEC3", 5126, corners, false);
  b.json["accessors"][size_t(position)]["min"] = {0, 0, 0};
  b.json["accessors"][size_t(position)]["max"] = {1, 1, 0};
  return position;
}

const MeshSection& section_of(const Expected<Scene>& scene) { return scene->meshes.at(0).sections.at(0); }

TEST(GltfMeshopt, TrianglesAndIndices) {
  const std::vector<unsigned int> indices = {0, 1, 2, 2, 1, 3};
  for (const std::string mode : {"TRIANGLES", "INDICES"}) {
    MeshoptBuilder b;
    const int position = add_positions(b);
    std::vector<unsigned char> bytes(512);
    bytes.resize(mode == "TRIANGLES"
                     ? meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size())
                     : meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
    b.primitive({{"POSITION", position}})["indices"] =
        b.described(b.compressed(bytes, mode, "", 6, 2), "SCALAR", 5123, 6, false);
    const Expected<Scene> scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    const MeshSection& s = section_of(scene);
    ASSERT_EQ(s.index.size(), 6u);
    float area = 0;  // the codec may turn a triangle's corners but keeps its winding
    for (size_t i = 0; i < 6; i += 3)
      area += glm::cross(s.position[s.index[i + 1]] - s.position[s.index[i]],
                         s.position[s.index[i + 2]] - s.position[s.index[i]])
                  .z /
              2;
    EXPECT_FLOAT_EQ(area, 1.f) << mode;
  }
}

TEST(GltfMeshopt, OctahedralNormals) {
  const std::vector<float> normals = {0.6f, 0, 0.8f, 0, 0, -0.6f, 0.8f, 0, 0, 0.28f, -0.96f, 0, -1, 0, 0, 0};
  for (const size_t stride : {size_t(4), size_t(8)}) {
    MeshoptBuilder b;
    const int position = add_positions(b);
    std::vector<std::byte> packed(corners * stride);
    meshopt_encodeFilterOct(packed.data(), corners, stride, stride == 4 ? 8 : 16, normals.data());
    const int normal = b.described(b.attributes(packed, "OCTAHEDRAL", corners, stride), "VEC3",
                                   stride == 4 ? 5120 : 5122, corners, true);
    b.primitive({{"POSITION", position}, {"NORMAL", normal}}, 0);
    const Expected<Scene> scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    for (size_t i = 0; i < corners; ++i)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(section_of(scene).normal[i][c], normals[i * 4 + size_t(c)], stride == 4 ? 2e-2 : 1e-4) << i;
  }
}

TEST(GltfMeshopt, QuaternionsAndExponentials) {
  const std::vector<float> turns = {0, 0, 0, 1, 0.6f, 0, 0, 0.8f};
  const std::vector<float> shifts = {1000, -0.5f, 0.125f, 3, 2, 1};
  MeshoptBuilder b;
  b.use("EXT_mesh_gpu_instancing", true);
  const int position = add_positions(b);
  std::vector<std::byte> packed_turns(2 * 8), packed_shifts(2 * 12);
  meshopt_encodeFilterQuat(packed_turns.data(), 2, 8, 16, turns.data());
  meshopt_encodeFilterExp(packed_shifts.data(), 2, 12, 15, shifts.data());
  const int rotation = b.described(b.attributes(packed_turns, "QUATERNION", 2, 8), "VEC4", 5122, 2, true);
  const int translation = b.described(b.attributes(packed_shifts, "EXPONENTIAL", 2, 12), "VEC3", 5126, 2, false);
  b.primitive({{"POSITION", position}}, 0);
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", rotation},
                                                                               {"TRANSLATION", translation}};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Instances& instances = *scene->nodes[0].instances;
  const glm::quat wanted(0.8f, 0.6f, 0, 0);
  EXPECT_NEAR(std::abs(glm::dot(instances.rotation[1], wanted)), 1.f, 1e-6f);
  EXPECT_NEAR(std::abs(instances.rotation[0].w), 1.f, 1e-6f);
  // One exponent is shared by the vector: 15 bits of its largest component.
  for (size_t i = 0; i < 2; ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(instances.translation[i][c], shifts[i * 3 + size_t(c)], std::abs(shifts[i * 3]) / 8192) << i << c;
}

TEST(GltfMeshopt, DamagedDataAndWrongStridesAreRefused) {
  MeshoptBuilder b;
  const int position = add_positions(b);
  b.primitive({{"POSITION", position}}, 0);
  ASSERT_TRUE(b.load());
  MeshoptBuilder damaged = b;
  damaged.binary[0] = std::byte(0x17);  // the codec's header
  const Expected<Scene> scene = damaged.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("damaged"), std::string::npos) << scene.error().text();
  MeshoptBuilder filtered = b;
  filtered.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "QUATERNION";
  EXPECT_FALSE(filtered.load()) << "a stride of 12 holds no quaternion";
}

}  // namespace
}  // namespace candela::test::gltf_meshopt
