// First: Filament's headers make a macro of a name that nlohmann's json uses for a function.
#include "frame_server.h"

#include <filament/Camera.h>
#include <filament/ColorGrading.h>
#include <filament/Renderer.h>
#include <filament/SwapChain.h>
#include <filament/View.h>
#include <filament/Viewport.h>
#include <utils/EntityManager.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "filament_scene.h"
#include "filament_sky.h"
#include "gltf/gltf.h"
#include "image/io.h"
#include "job/job.h"

// Filament's side of the comparison: candela's scene, camera and lights through Filament's renderer. Linear tone
// mapping and sRGB encoding, no fog, dithering or FXAA; Filament's own choices otherwise. Shadows, ambient occlusion,
// bloom and image-based light where they are asked for.
namespace candela::peers {
namespace {

using filament::Engine;

// What is not Filament's: the scene at a time, as candela poses it.
struct Posed {
  Scene scene;
  AnimationChoice animations;
  View view;
  FrameData at(double time_s) const { return make_frame_data(scene, evaluate_pose(scene, animations, time_s), view); }
};

Expected<Posed> load(const std::string& file, int width_px, int height_px) {
  Posed posed;
  auto scene = load_gltf(file);
  if (!scene) return std::unexpected(scene.error());
  posed.scene = std::move(*scene);
  auto animations = choose_animations(posed.scene, "all");
  if (!animations) return std::unexpected(animations.error());
  posed.animations = *animations;
  const Pose pose = evaluate_pose(posed.scene, posed.animations, 0);
  auto view = make_view(posed.scene, pose, {}, width_px, height_px, world_bounds(posed.scene, pose));
  if (!view) return std::unexpected(view.error());
  posed.view = *view;
  return posed;
}

// Along the view, to the end of the farthest light's range.
float light_reach_m(const View& view, const FrameData& frame) {
  float reach = 0;
  for (const LightItem& light : frame.lights)
    reach = std::max(reach, std::min(light.range_m, 1000.0f) -
                                (glm::mat4(view.view_from_relative) * glm::vec4(light.position, 1)).z);
  return reach;
}

struct Effects {
  int shadowed_spots = 0;
  double occlusion_radius_m = 0, bloom_strength = 0;  // 0: none
  std::string sky;
};

class Filament {
 public:
  Expected<void> open(Engine::Backend backend, const Posed& posed, int width_px, int height_px, int samples,
                      const Effects& effects) {
    width_px_ = uint32_t(width_px), height_px_ = uint32_t(height_px);
    pixels_.resize(size_t(width_px_) * height_px_ * 4);
    engine_ = Engine::create(backend);
    if (!engine_) return fail(ErrorKind::device, "", "Filament found no device");
    swap_chain_ = engine_->createSwapChain(width_px_, height_px_, filament::SwapChain::CONFIG_READABLE);
    renderer_ = engine_->createRenderer();
    renderer_->setDisplayInfo({.refreshRate = 0});
    renderer_->setClearOptions({.clearColor = {0, 0, 0, 1}, .clear = true});
    auto scene = FilamentScene::make(*engine_, posed.scene, evaluate_pose(posed.scene, posed.animations, 0),
                                     posed.at(0), effects.shadowed_spots);
    if (!scene) return std::unexpected(scene.error());
    scene_ = *scene;
    make_view(posed.view, samples, light_reach_m(posed.view, posed.at(0)), effects);
    return effects.sky.empty() ? Expected<void>() : add_sky(*engine_, *scene_.scene(), effects.sky);
  }

  Expected<Json> frame(const Posed& posed, double time_s) {
    const auto start = Clock::now();
    const FrameData data = posed.at(time_s);
    const double posed_ms = ms_since(start);
    if (auto moved = scene_.move(*engine_, data); !moved) return std::unexpected(moved.error());
    // It advises to skip frames while the device is behind; here each frame is waited for.
    renderer_->beginFrame(swap_chain_);
    renderer_->render(view_);
    bool arrived = false;
    using Buffer = filament::backend::PixelBufferDescriptor;
    renderer_->readPixels(
        0, 0, width_px_, height_px_,
        Buffer(
            pixels_.data(), pixels_.size(), Buffer::PixelDataFormat::RGBA, Buffer::PixelDataType::UBYTE,
            [](void*, size_t, void* user) { *static_cast<bool*>(user) = true; }, &arrived));
    renderer_->endFrame();
    do engine_->flushAndWait();
    while (!arrived);
    return Json{{"cpu_ms", {{"animate", posed_ms}}}};
  }

  Expected<void> save(const std::string& file) const {
    DisplayImage image{int(width_px_), int(height_px_), 3, 8, {}};
    for (size_t i = 0; i < pixels_.size(); i += 4)
      for (size_t c = 0; c < 3; ++c) image.pixels.push_back(std::byte(pixels_[i + c]));
    return write_png(file, image);
  }

 private:
  void make_view(const View& of, int samples, float light_far_m, const Effects& effects) {
    auto* camera = engine_->createCamera(utils::EntityManager::get().create());
    // Culls beyond the far distance; draws without one.
    camera->setProjection(2 * std::atan(of.tan_y) * 180 / std::numbers::pi, of.tan_x / of.tan_y, of.near_m, 10000);
    camera->setModelMatrix(filament_matrix(glm::mat4(glm::inverse(of.view_from_relative))));
    camera->setExposure(1.0f);
    view_ = engine_->createView();
    view_->setCamera(camera);
    view_->setScene(scene_.scene());
    view_->setViewport({0, 0, width_px_, height_px_});
    view_->setSampleCount(uint8_t(samples));
    // Its default far distance, 100 m, would leave lights out that the street has; 5 m is its default near one.
    view_->setDynamicLightingOptions(5, std::max(100.0f, light_far_m));
    view_->setShadowingEnabled(effects.shadowed_spots > 0);
    view_->setAntiAliasing(filament::View::AntiAliasing::NONE);
    view_->setDithering(filament::View::Dithering::NONE);
    view_->setAmbientOcclusionOptions(
        {.radius = float(effects.occlusion_radius_m), .enabled = effects.occlusion_radius_m > 0});
    view_->setBloomOptions({.strength = float(effects.bloom_strength),
                            .blendMode = filament::View::BloomOptions::BlendMode::INTERPOLATE,
                            .threshold = false,
                            .enabled = effects.bloom_strength > 0});
    view_->setScreenSpaceRefractionEnabled(false);
    view_->setColorGrading(filament::ColorGrading::Builder()
                               .toneMapping(filament::ColorGrading::ToneMapping::LINEAR)
                               .quality(filament::ColorGrading::QualityLevel::HIGH)
                               .build(*engine_));
  }

  Engine* engine_ = nullptr;  // the process ends with it: nothing is given back
  filament::SwapChain* swap_chain_ = nullptr;
  filament::Renderer* renderer_ = nullptr;
  filament::View* view_ = nullptr;
  FilamentScene scene_;
  uint32_t width_px_ = 0, height_px_ = 0;
  std::vector<uint8_t> pixels_;
};

int run(int argc, char** argv) {
  CLI::App app("Renders a scene by Filament: one frame to a file, or frames when asked to on standard input");
  std::string file, size = "1280x720", backend = "vulkan", output;
  int samples = 4;
  double time_s = 0;
  app.add_option("scene", file)->required();
  app.add_option("--size", size);
  app.add_option("--samples", samples);
  app.add_option("--backend", backend)->check(CLI::IsMember({"vulkan", "opengl"}));
  app.add_option("-o", output, "PNG of one frame, instead of serving");
  app.add_option("--time", time_s, "of that frame");
  Effects effects;
  app.add_option("--shadowed-spots", effects.shadowed_spots, "Spot lights with shadow maps, the nearest first");
  app.add_option("--occlusion", effects.occlusion_radius_m, "Radius in metres of ambient occlusion");
  app.add_option("--bloom", effects.bloom_strength);
  app.add_option("--sky", effects.sky, "Equirectangular image, as background and light");
  CLI11_PARSE(app, argc, argv);
  const auto failed = [](const Error& error) {
    std::fprintf(stderr, "%s\n", error.text().c_str());
    return int(error.kind);
  };
  const auto pixels = parse_size(size);
  if (!pixels) return failed(pixels.error());
  const auto posed = load(file, pixels->first, pixels->second);
  if (!posed) return failed(posed.error());
  static Filament filament;
  if (auto opened = filament.open(backend == "vulkan" ? Engine::Backend::VULKAN : Engine::Backend::OPENGL, *posed,
                                  pixels->first, pixels->second, samples, effects);
      !opened)
    return failed(opened.error());
  FrameServer server{.about = {{"program", "filament"}, {"version", FILAMENT_VERSION}, {"backend", backend}},
                     .frame = [&](double at_s) { return filament.frame(*posed, at_s); },
                     .save = [&](const std::string& to) { return filament.save(to); }};
  if (output.empty()) return server.run();
  if (auto frame = server.frame(time_s); !frame) return failed(frame.error());
  if (auto saved = server.save(output); !saved) return failed(saved.error());
  return 0;
}

}  // namespace
}  // namespace candela::peers

int main(int argc, char** argv) {
  const int code = candela::peers::run(argc, argv);
  std::fflush(nullptr);
  // Filament's threads still run; its engine is not taken down, so no destructor may run beneath them.
  std::quick_exit(code);
}
