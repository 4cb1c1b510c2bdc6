#include "gltf/mikktspace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

namespace candela::gltf_mikktspace {
namespace {

using Json = nlohmann::json;

double degrees_between(glm::vec3 a, glm::vec3 b) {
  const glm::dvec3 x = glm::normalize(glm::dvec3(a)), y = glm::normalize(glm::dvec3(b));
  return std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)) * 180 / std::numbers::pi;
}

// A plain reader of float vectors and indices, apart from the loader: tests of one should not rest on the other.
struct PlainGltf {
  Json json;
  std::vector<char> binary;

  static std::vector<char> bytes(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static bool open(const std::string& path, PlainGltf& out) {
    const std::vector<char> file = bytes(path);
    if (file.size() < 20) return false;
    if (std::memcmp(file.data(), "glTF", 4) != 0) {
      out.json = Json::parse(file);
      const std::string uri = out.json["buffers"][0]["uri"];
      out.binary = bytes(path.substr(0, path.rfind('/') + 1) + uri);
      return true;
    }
    uint32_t length;
    std::memcpy(&length, &file[12], 4);
    out.json = Json::parse(file.begin() + 20, file.begin() + 20 + length);
    out.binary.assign(file.begin() + 28 + length, file.end());
    return true;
  }
  template <class T>
  std::vector<T> read(int accessor) const {
    const Json& a = json["accessors"][size_t(accessor)];
    const Json& view = json["bufferViews"][a["bufferView"].get<size_t>()];
    const size_t begin = a.value("byteOffset", size_t(0)) + view.value("byteOffset", size_t(0));
    const size_t stride = view.value("byteStride", sizeof(T));
    std::vector<T> result(a["count"].get<size_t>());
    for (size_t i = 0; i < result.size(); ++i) std::memcpy(&result[i], &binary[begin + i * stride], sizeof(T));
    return result;
  }
  MeshSection section(const Json& primitive) const {
    MeshSection s;
    const Json& attributes = primitive["attributes"];
    s.position = read<glm::vec3>(attributes["POSITION"]);
    s.normal = read<glm::vec3>(attributes["NORMAL"]);
    s.uv0 = read<glm::vec2>(attributes["TEXCOORD_0"]);
    s.tangent = read<glm::vec4>(attributes["TANGENT"]);
    const int indices = primitive["indices"];
    if (json["accessors"][size_t(indices)]["componentType"] == 5125) {
      s.index = read<uint32_t>(indices);
    } else {
      for (uint16_t i : read<uint16_t>(indices)) s.index.push_back(i);
    }
    return s;
  }
};

struct Difference {
  std::vector<double> degrees;  // of each corner, sorted
  size_t other_sign = 0;
  double at(double fraction) const { return degrees[size_t(fraction * double(degrees.size() - 1))]; }
};

Difference compare_with_file(const PlainGltf& file) {
  Difference difference;
  for (const Json& mesh : file.json["meshes"]) {
    for (const Json& primitive : mesh["primitives"]) {
      if (!primitive["attributes"].contains("TANGENT")) continue;
      const MeshSection given = file.section(primitive);
      MeshSection made = given;
      generate_tangents(made, 0);
      for (size_t i = 0; i < given.index.size(); ++i) {
        const glm::vec4 a = given.tangent[given.index[i]], b = made.tangent[made.index[i]];
        difference.degrees.push_back(degrees_between(glm::vec3(a), glm::vec3(b)));
        difference.other_sign += a.w != b.w;
      }
    }
  }
  std::sort(difference.degrees.begin(), difference.degrees.end());
  std::printf("%zu corners: median %.5f, 90 %% %.4f, 99 %% %.4f, 99.9 %% %.4f, most %.3f degrees; other sign %zu\n",
              difference.degrees.size(), difference.at(0.5), difference.at(0.9), difference.at(0.99),
              difference.at(0.999), difference.at(1), difference.other_sign);
  return difference;
}

const std::string assets = CANDELA_SOURCE_DIR "/../shared/assets/";

// A sheet in the plane z = 0 whose texture grows with x up to x = 1 and is mirrored there. v runs down, as in glTF.
MeshSection mirrored_sheet() {
  MeshSection s;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 2; ++y) {
      s.position.emplace_back(x, y, 0);
      s.normal.emplace_back(0, 0, 1);
      s.uv0.emplace_back(x == 1 ? 1 : 0, 1 - y);
    }
  }
  s.index = {0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5};
  return s;
}

TEST(Mikktspace, AgreesWithTheTangentsOfNormalTangentMirrorTest) {
  PlainGltf file;
  if (!PlainGltf::open(assets + "khronos/NormalTangentMirrorTest/NormalTangentMirrorTest.glb", file))
    GTEST_SKIP() << "the folder shared/assets is absent";
  const Difference difference = compare_with_file(file);
  EXPECT_EQ(difference.other_sign, 0u);
  EXPECT_LT(difference.at(1), 0.01);  // degrees
}

// Its positions and texture coordinates were quantized after its tangents were made, and it counts the bitangent's sign
// the other way round, so only the distribution of the angles and the uniformity of the sign can be asked for.
TEST(Mikktspace, AgreesWithTheTangentsOfSponza) {
  PlainGltf file;
  if (!PlainGltf::open(assets + "scenes/Sponza/Sponza.gltf", file))
    GTEST_SKIP() << "the folder shared/assets is absent";
  const Difference difference = compare_with_file(file);
  EXPECT_LT(difference.at(0.5), 0.1);
  EXPECT_LT(difference.at(0.9), 1);
  EXPECT_LT(difference.at(0.99), 5);
  EXPECT_GT(difference.other_sign, difference.degrees.size() / 1000 * 999);
}

TEST(Mikktspace, SplitsVerticesWhereTheTextureIsMirrored) {
  MeshSection s = mirrored_sheet();
  generate_tangents(s, 0);
  ASSERT_EQ(s.position.size(), 8u);  // the two of the seam have two tangents each
  for (size_t i = 0; i < s.index.size(); ++i) {
    const glm::vec4 t = s.tangent[s.index[i]];
    const bool left = i < 6;
    EXPECT_NEAR(t.x, left ? 1 : -1, 1e-6);
    // The image's upward direction is +y on both sides: cross(n, t) * w.
    EXPECT_NEAR(glm::cross(glm::vec3(0, 0, 1), glm::vec3(t)).y * t.w, 1, 1e-6) << i;
  }
}

TEST(Mikktspace, EveryAttributeFollowsASplitVertex) {
  MeshSection s = mirrored_sheet();
  const MeshSection before = s;
  for (uint16_t v = 0; v < 6; ++v) {
    s.uv1.emplace_back(v, 1);
    s.color.emplace_back(v, 2, 3, 4);
    s.joints0.emplace_back(v, 0, 0, 0);
    s.joints1.emplace_back(0, v, 0, 0);
    s.weights0.emplace_back(v, 0, 0, 0);
    s.weights1.emplace_back(0, v, 0, 0);
  }
  MorphTarget target;
  for (int v = 0; v < 6; ++v) {
    target.position.emplace_back(v, 0, 0);
    target.normal.emplace_back(0, v, 0);
    target.tangent.emplace_back(0, 0, v);
  }
  s.morph.push_back(target);
  generate_tangents(s, 0);
  const MorphTarget& m = s.morph[0];
  for (size_t i = 0; i < s.index.size(); ++i) {
    const uint32_t old = before.index[i], now = s.index[i];
    ASSERT_LT(now, s.position.size());
    EXPECT_EQ(s.position[now], before.position[old]);
    EXPECT_EQ(s.uv0[now], before.uv0[old]);
    EXPECT_EQ(s.uv1[now].x, float(old));
    EXPECT_EQ(s.color[now].x, float(old));
    EXPECT_EQ(s.joints0[now].x, old);
    EXPECT_EQ(s.joints1[now].y, old);
    EXPECT_EQ(s.weights0[now].x, float(old));
    EXPECT_EQ(s.weights1[now].y, float(old));
    EXPECT_EQ(glm::vec3(m.position[now].x, m.normal[now].y, m.tangent[now].z), glm::vec3(float(old)));
  }
}

// Two triangles of a fan: angles of 90 and 45 degrees weigh their directions.
TEST(Mikktspace, WeighsByTheAngleAtTheCorner) {
  MeshSection s;
  s.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
  s.normal.assign(4, {0, 0, 1});
  s.uv0 = {{0, 0}, {1, 0}, {0, 1}, {-2, 1}};
  s.index = {0, 1, 2, 0, 2, 3};
  generate_tangents(s, 0);
  // On both, v = y: u grows along +x at constant v.
  EXPECT_NEAR(s.tangent[0].x, 1, 1e-6);

  s.uv0[3] = {-1, 0};  // on the second now u = x, v = x + y: constant v runs along (1, -1)
  generate_tangents(s, 0);
  const glm::dvec2 a(1, 0), b = glm::normalize(glm::dvec2(1, -1) * 1.0);
  const glm::dvec2 expected = glm::normalize(a * (std::numbers::pi / 2) + b * (std::numbers::pi / 4));
  EXPECT_NEAR(s.tangent[0].x, expected.x, 1e-6);
  EXPECT_NEAR(s.tangent[0].y, expected.y, 1e-6);
}

TEST(Mikktspace, DegenerateTrianglesAndTextureGetFiniteUnitTangents) {
  MeshSection s = mirrored_sheet();
  s.index.insert(s.index.end(), {0, 0, 1, 2, 2, 2});  // no area
  s.position.insert(s.position.end(), {{9, 9, 9}, {8, 9, 9}, {9, 8, 9}, {5, 5, 5}});
  s.normal.insert(s.normal.end(), {{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}});  // one normal is missing
  s.uv0.insert(s.uv0.end(), 4, {0.5f, 0.5f});                                     // no area in texture space
  s.index.insert(s.index.end(), {6, 7, 8});
  generate_tangents(s, 0);
  ASSERT_EQ(s.tangent.size(), s.position.size());
  for (const glm::vec4& t : s.tangent) {
    EXPECT_NEAR(glm::length(glm::vec3(t)), 1, 1e-5);
    EXPECT_EQ(std::abs(t.w), 1);
  }
  EXPECT_NEAR(s.tangent[s.index[12]].x, 1, 1e-6);  // a degenerate triangle takes what its vertex has

  MeshSection untextured = mirrored_sheet();
  untextured.uv0.clear();
  generate_tangents(untextured, 0);
  EXPECT_NEAR(glm::length(glm::vec3(untextured.tangent[0])), 1, 1e-6);
  EXPECT_NEAR(untextured.tangent[0].z, 0, 1e-6);
}

TEST(FlatNormals, UnshareVerticesAndFollowTheWinding) {
  MeshSection s;
  s.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  s.color = {{0, 0, 0, 1}, {1, 0, 0, 1}, {2, 0, 0, 1}, {3, 0, 0, 1}};
  s.tangent.assign(4, {1, 0, 0, 1});
  s.index = {0, 1, 2, 0, 3, 1, 2, 2, 2};
  s.morph.resize(1);
  s.morph[0].position = {{0, 0, 0}, {0, 0, 0}, {0, -1, 1}, {0, 0, 0}};  // turns the first triangle to face -y
  generate_flat_normals(s);
  ASSERT_EQ(s.position.size(), 9u);
  EXPECT_TRUE(s.tangent.empty());
  EXPECT_EQ(s.normal[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(s.normal[4], glm::vec3(0, 1, 0));
  EXPECT_NEAR(glm::length(s.normal[7]), 1, 1e-6);
  EXPECT_EQ(s.color[4].x, 3);
  EXPECT_EQ(s.index[5], 5u);
  EXPECT_EQ(s.normal[0] + s.morph[0].normal[0], glm::vec3(0, -1, 0));
}

}  // namespace
}  // namespace candela::gltf_mikktspace
