#include <exception>
#include <span>
#include <string>

#include "demoscenes/demo_scenes.h"
#include "testscenes/demo_scene_module.h"

namespace candela {
namespace {

std::vector<std::byte> part_of(const DemoScene& scene, CandelaDemoScenePart part, uint64_t seed, int lights) {
  if (part == candela_demo_scene_sky) return scene.sky ? scene.sky(seed) : std::vector<std::byte>{};
  if (part == candela_demo_scene_night_sky) return scene.night_sky ? scene.night_sky(seed) : std::vector<std::byte>{};
  if (part == candela_demo_scene_sound) return scene.sound ? scene.sound(seed) : std::vector<std::byte>{};
  if (part == candela_demo_scene_look) {
    const auto text = std::as_bytes(std::span(scene.look));
    return {text.begin(), text.end()};
  }
  if (part == candela_demo_scene_texts) {
    if (!scene.texts) return {};
    json texts = json::object();
    for (const DemoText& text : scene.texts(seed)) texts[text.suffix] = text.text;
    const std::string dumped = texts.dump();
    const auto bytes = std::as_bytes(std::span(dumped));
    return {bytes.begin(), bytes.end()};
  }
  GlbWriter writer;
  SceneOptions options{Rng(seed), lights};
  scene.make(writer, options);
  return writer.bytes();
}

}  // namespace
}  // namespace candela

// Exceptions may not cross the C interface.
extern "C" const char* candela_make_demo_scene(const char* name, CandelaDemoScenePart part, uint64_t seed, int lights,
                                               CandelaDemoSceneSink* sink, void* user) {
  static thread_local std::string message;
  try {
    const candela::DemoScene* scene = candela::find_demo_scene(name);
    if (!scene) return (message = std::string("there is no scene ") + name).c_str();
    const std::vector<std::byte> bytes = candela::part_of(*scene, part, seed, lights);
    if (!bytes.empty() && sink(user, bytes.data(), bytes.size()) != 0) return "no memory is left for the scene";
    return nullptr;
  } catch (const std::bad_alloc&) {
    return "no memory is left for the scene";
  } catch (const std::exception& e) {
    return (message = e.what()).c_str();
  }
}
