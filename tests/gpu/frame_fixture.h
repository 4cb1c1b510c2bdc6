#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "../unit/scene_pieces.h"
#include "job/frame_choices.h"
#include "session/session.h"

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
  // A file of the running test's own.
  static std::string look_file(const std::string& text) {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::string path =
        ::testing::TempDir() + fmt::format("candela_{}_{}.look.json", info->test_suite_name(), info->name());
    std::ofstream(path) << text;
    return path;
  }
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
    for (const char* of_a_look : {"bloom", "fog", "fog_transmittance", "volumetric"}) std::erase(job.layers, of_a_look);
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
    for (const FrameOutput& output : result.outputs) {
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

}  // namespace candela::test
