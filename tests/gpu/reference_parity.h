#pragma once
#include "base/files.h"
#include "base/input.h"
#include "frame_fixture.h"
#include "gltf/gltf.h"
#include "reference/visibility.h"
#include "render/reference_frame.h"

namespace candela::test {

inline constexpr int width = 48, height = 36;

struct Pair {
  std::vector<glm::dvec4> gpu, reference;
  double squared(size_t pixel) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
      sum += std::pow(gpu[pixel][c] - reference[pixel][c], 2) / (std::pow(reference[pixel][c], 2) + 0.01);
    return sum / 3;
  }
  double relmse() const {
    double sum = 0;
    for (size_t i = 0; i < gpu.size(); ++i) sum += squared(i);
    return sum / double(gpu.size());
  }
  size_t worst() const {
    size_t at = 0;
    for (size_t i = 0; i < gpu.size(); ++i)
      if (squared(i) > squared(at)) at = i;
    return at;
  }
};

// A copy of a scene, beside its files, in which both renderers should agree. Textures are read from level 0 alone: the
// GPU's mip maps approximate the mean over a pixel, which is another matter than how that light is computed.
struct LampScene {
  enum class Light { kept, one_lamp };
  enum class Textures { level_0, nearest_texel, as_they_are };
};

class ReferenceParity : public FrameTest {
 protected:
  // What the camera sees first that is not blended.
  static std::optional<Hit> nearest_opaque(const reference::World& world, const reference::CameraRay& camera) {
    const Ray ray = reference::rounded(camera);
    std::optional<Hit> hit = reference::next_surface(world, ray, true, nullptr, nullptr);
    while (hit && world.is_blended(hit->item)) {
      const Hit passed = *hit;
      hit = reference::next_surface(world, ray, true, &passed, nullptr);
    }
    return hit;
  }
  using Light = LampScene::Light;
  using Textures = LampScene::Textures;

  // Both at side * side samples a pixel on a grid: the GPU at `side` times the size with one sample, averaged.
  static Pair rendered(Job job, int side, double time_s = 0) {
    job.settings.push_back({"lights", "floor_lux", "0"});     // an approximation of the GPU's
    job.settings.push_back({"textures", "anisotropy", "1"});  // the reference reads one place of level 0
    job.effects = "none";                                     // no shadows: the reference's are off below
    Pair out;
    Job large = job;
    large.width_px *= side, large.height_px *= side, large.samples = 1;
    const Images images = images_of(large, {}, time_s);
    for (int y = 0; y < job.height_px; ++y)
      for (int x = 0; x < job.width_px; ++x) {
        glm::dvec4 sum(0);
        for (int j = 0; j < side; ++j)
          for (int i = 0; i < side; ++i) sum += glm::dvec4(images["beauty"].at<glm::vec4>(x * side + i, y * side + j));
        out.gpu.push_back(sum / double(side * side));
      }
    auto frame = open_reference(job, time_s, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return out;
    reference::TraceSettings settings;
    settings.visibility = false;
    settings.ambient = reference::Ambient::occlusion;  // unoccluded: the GPU's own model, where there is ambient light
    settings.sampler = {reference::SamplerKind::uniform, side * side, 0};
    reference::Film film(job.width_px, job.height_px);
    film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), side * side,
             [](double) { return true; });
    for (size_t i = 0; i < film.pixels(); ++i) out.reference.push_back(film.mean(i));
    return out;
  }

  static Json read_json(const std::vector<std::byte>& bytes, std::vector<std::byte>& rest) {
    const char* text = reinterpret_cast<const char*>(bytes.data());
    if (bytes.size() < 20 || std::memcmp(text, "glTF", 4) != 0) return Json::parse(text, text + bytes.size());
    uint32_t length = 0;
    std::memcpy(&length, text + 12, 4);
    rest.assign(bytes.begin() + 20 + length, bytes.end());
    return Json::parse(text + 20, text + 20 + length);
  }

  // The light stands beside and above the camera that candela takes by itself. Returns the copy's path.
  static std::string one_lamp(const std::filesystem::path& scene_file, Light light,
                              Textures textures = Textures::level_0) {
    // The copy names its files by links into the scene's own folder.
    InputRules rules = input_rules();
    rules.allowed_folders = {scene_file.parent_path()};
    set_input_rules(rules);
    const auto bytes = read_file(scene_file);
    EXPECT_TRUE(bytes) << scene_file;
    if (!bytes) return {};
    std::vector<std::byte> binary;
    Json json = read_json(*bytes, binary);
    if (textures != Textures::as_they_are) {
      constexpr int nearest = 9728, linear = 9729;
      const bool one_texel = textures == Textures::nearest_texel;
      for (Json& sampler : json["samplers"])
        sampler["magFilter"] = sampler["minFilter"] = one_texel ? nearest : sampler.value("magFilter", linear);
      json["samplers"].push_back(
          {{"magFilter", one_texel ? nearest : linear}, {"minFilter", one_texel ? nearest : linear}});
      for (Json& texture : json["textures"])
        if (!texture.contains("sampler")) texture["sampler"] = json["samplers"].size() - 1;
      if (!json.contains("textures") || json["textures"].empty()) json.erase("textures"), json.erase("samplers");
    }
    if (light == Light::one_lamp) add_lamp(scene_file, json);
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path folder =
        std::filesystem::path(::testing::TempDir()) /
        fmt::format("candela_{}_{}_{}_{}", info->name(), scene_file.stem().string(), int(light), int(textures));
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    std::filesystem::create_directories(folder);
    for (const auto& entry : std::filesystem::directory_iterator(scene_file.parent_path()))
      if (entry.path() != scene_file)
        std::filesystem::create_directory_symlink(std::filesystem::absolute(entry.path()),
                                                  folder / entry.path().filename(), ignored);
    const std::filesystem::path out = folder / scene_file.filename();
    write_scene(out, json, binary);
    return out;
  }

  static void add_lamp(const std::filesystem::path& scene_file, Json& json) {
    const auto scene = load_gltf(scene_file);
    ASSERT_TRUE(scene) << scene.error().text();
    const Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), 0);
    const DAabb bounds = world_bounds(*scene, pose);
    const auto view = make_view(*scene, pose, {}, width, height, bounds);
    ASSERT_TRUE(view);
    const glm::dmat3 axes = glm::transpose(glm::dmat3(view->view_from_relative));
    const double reach = std::min(glm::length(bounds.centre() - view->position), glm::length(bounds.extent()) * 3);
    const glm::dvec3 at = view->position + reach * (0.35 * axes[0] + 0.45 * axes[1]);
    for (Json& node : json["nodes"])
      if (node.contains("extensions"))
        node["extensions"].erase("KHR_lights_punctual"), node["extensions"].erase("CANDELA_light_instances");
    json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", std::max(6 * reach * reach, 1e-3)}}};
    Json node = {{"translation", {at.x, at.y, at.z}}};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    json["nodes"].push_back(node);
    json["scenes"][json.value("scene", size_t{0})]["nodes"].push_back(json["nodes"].size() - 1);
    if (json["extensionsUsed"].is_null() || std::find(json["extensionsUsed"].begin(), json["extensionsUsed"].end(),
                                                      "KHR_lights_punctual") == json["extensionsUsed"].end())
      json["extensionsUsed"].push_back("KHR_lights_punctual");
  }

  static void write_scene(const std::filesystem::path& out, const Json& json, const std::vector<std::byte>& binary) {
    std::string text = json.dump();
    std::ofstream file(out, std::ios::binary);
    if (out.extension() != ".glb") {
      file << text;
      return;
    }
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [&](uint32_t v) { file.write(reinterpret_cast<const char*>(&v), 4); };
    word(0x46546c67), word(2), word(uint32_t(20 + text.size() + binary.size()));
    word(uint32_t(text.size())), word(0x4e4f534a);
    file << text;
    file.write(reinterpret_cast<const char*>(binary.data()), long(binary.size()));
  }
};

}  // namespace candela::test
