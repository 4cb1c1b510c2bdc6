#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "../unit/scene_gltf_builder.h"
#include "render/session.h"

namespace candela::test {

// Whole frames of small scenes under validation and synchronization checks: any message fails the render.
class FrameTest : public ::testing::Test {
 protected:
  static std::filesystem::path scenes() { return CANDELA_SOURCE_DIR "/scenes"; }
  static std::filesystem::path scene(const std::string& name) { return scenes() / name / (name + ".glb"); }
  static std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(scenes()))
      if (std::filesystem::exists(scene(entry.path().filename()))) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  // A file for this test alone.
  static std::string write(const GltfBuilder& builder) {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = fmt::format("candela_{}_{}.glb", info->test_suite_name(), info->name());
    std::replace(name.begin(), name.end(), '/', '_');  // of parameterised tests
    const std::string path = ::testing::TempDir() + name;
    const auto bytes = builder.glb();
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), long(bytes.size()));
    return path;
  }

  static Job job_for(const std::filesystem::path& path, int width, int height, int samples = 1) {
    Job job;
    job.scene = path;
    job.width_px = width;
    job.height_px = height;
    job.samples = samples;
    job.tonemap = "none";
    return job;
  }
  static Job with_layers(Job job) {
    job.layers = layer_names();
    return job;
  }
  static void look(Job& job, glm::dvec3 eye, glm::dvec3 target, double yfov_deg = 45) {
    job.camera.eye = eye;
    job.camera.target = target;
    job.camera.yfov_deg = yfov_deg;
  }

  static std::unique_ptr<Session> open(const Job& job, const WantedOutputs& wanted = {}) {
    RunSettings settings;
    settings.validate = true;
    auto session = Session::open(job, wanted, settings);
    EXPECT_TRUE(session) << session.error().text();
    return session ? std::move(*session) : nullptr;
  }
  static FrameResult render(Session& session, double time_s = 0, bool hash_outputs = false) {
    auto result = session.render(time_s, hash_outputs);
    EXPECT_TRUE(result) << result.error().text();
    return result ? std::move(*result) : FrameResult{};
  }
  // The bytes live on the device, so they are copied before the session goes.
  struct Image {
    std::string layer;
    std::vector<std::byte> bytes;
    int width = 0, height = 0;
    template <class T = float>
    T at(int x, int y) const {
      T value;
      std::memcpy(&value, bytes.data() + (size_t(y) * size_t(width) + size_t(x)) * sizeof(T), sizeof(T));
      return value;
    }
    size_t pixels() const { return size_t(width) * size_t(height); }
    template <class T>
    std::vector<T> values() const {
      std::vector<T> out(bytes.size() / sizeof(T));
      std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
      return out;
    }
    bool operator==(const Image&) const = default;
  };
  struct Images : std::vector<Image> {
    const Image& operator[](const std::string& layer) const {
      for (const Image& i : *this)
        if (i.layer == layer) return i;
      ADD_FAILURE() << "no output " << layer;
      static const Image none;
      return none;
    }
  };
  static Images images(const FrameResult& result) {
    Images list;
    for (const OutputImage& output : result.outputs) {
      const auto found = result.readbacks.find(output.resource);
      if (found == result.readbacks.end()) {
        ADD_FAILURE() << output.layer << " was not read back";
        continue;
      }
      const auto bytes = found->second->bytes();
      list.push_back({output.layer, {bytes.begin(), bytes.end()}, result.width_px, result.height_px});
    }
    return list;
  }
  static Images images_of(const Job& job, const WantedOutputs& wanted = {}, double time_s = 0) {
    const auto session = open(job, wanted);
    return session ? images(render(*session, time_s)) : Images{};
  }
};

// Pieces of scenes. Each returns the node.
inline int add_node(GltfBuilder& b, Json node) {
  b.json["nodes"].push_back(std::move(node));
  const int index = int(b.json["nodes"].size()) - 1;
  b.json["scenes"][0]["nodes"].push_back(index);
  return index;
}
inline GltfBuilder empty_scene() {
  GltfBuilder b;
  b.json["nodes"] = Json::array();
  b.json["scenes"][0]["nodes"] = Json::array();
  return b;
}
// A square in the plane z = 0 that faces +Z, of half size `half`.
inline int add_square_mesh(GltfBuilder& b, float half, int material) {
  const int position = b.accessor<float>("VEC3", {-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0});
  const int normal = b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  Json& p = b.primitive({{"POSITION", position}, {"NORMAL", normal}});
  p["indices"] = b.accessor<uint16_t>("SCALAR", {0, 1, 2, 0, 2, 3});
  p["material"] = material;
  return int(b.json["meshes"].size()) - 1;
}
inline int add_material(GltfBuilder& b, Json material) {
  b.json["materials"].push_back(std::move(material));
  return int(b.json["materials"].size()) - 1;
}
inline Json base_color(double r, double g, double b, double a = 1) {
  return {{"baseColorFactor", {r, g, b, a}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
}
// Diffuse alone: KHR_materials_specular with no specular at all.
inline Json diffuse_material(double r, double g, double b) {
  return {{"pbrMetallicRoughness", base_color(r, g, b)},
          {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
}
inline Json unlit_material(double r, double g, double b, double a = 1) {
  return {{"pbrMetallicRoughness", base_color(r, g, b, a)}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}
inline void add_light(GltfBuilder& b, Json light, Json node) {
  Json& lights = b.json["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(std::move(light));
  node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
  add_node(b, std::move(node));
  b.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_specular", "KHR_materials_unlit"};
}
inline void use_materials(GltfBuilder& b) {
  b.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_specular", "KHR_materials_unlit"};
}

}  // namespace candela::test
