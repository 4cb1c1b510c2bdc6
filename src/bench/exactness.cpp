#include "bench/exactness.h"

#include <chrono>

#include "base/clock.h"
#include "base/log.h"
#include "base/rng.h"
#include "base/text.h"
#include "bench/picture.h"
#include "bench/scene_store.h"
#include "bench/shared_renderer.h"
#include "testscenes/make_scene.h"

namespace candela {
namespace {

// One way to render a picture.
struct Way {
  std::string technique, label;
  std::vector<KnobSetting> settings;
};

class ExactnessRun {
 public:
  ExactnessRun(const ExactnessOptions& options, const RunSettings& settings, const std::function<bool()>& stop)
      : options_(options), settings_(settings), stop_(stop) {}

  Expected<ExactnessReport> run();

 private:
  Expected<void> check_fields();
  Expected<void> check_scenes();
  Expected<void> check_scene(const std::string& label, const std::string& again, const std::string& file,
                             uint64_t seed);
  std::vector<Way> ways(uint64_t seed) const;
  ExactnessRow& row_of(const std::string& scene, const std::string& technique);
  void count(ExactnessRow& row, const PictureDifference& d, const Job& job, const std::string& again);
  bool stopped();

  const ExactnessOptions& options_;
  RunSettings settings_;
  const std::function<bool()>& stop_;
  SceneStore store_;
  std::unique_ptr<SharedRenderer> renderer_;
  ExactnessReport report_;
};

bool ExactnessRun::stopped() {
  if (stop_ && stop_()) report_.stopped = true;
  return report_.stopped;
}

std::vector<Way> ExactnessRun::ways(uint64_t seed) const {
  std::vector<Way> all;
  if (!options_.techniques.empty()) {
    for (const SuiteTechnique& technique : options_.techniques) {
      Suite suite;
      suite.techniques = {technique};
      suite.scenes = {{.label = "any"}};
      const auto configured = configurations(suite);
      if (!configured) continue;  // shown to be fine before the run
      for (const Configuration& c : *configured)
        all.push_back({technique.name, joined(std::vector{technique.name, settings_text(c.job)}, " "), c.job.settings});
    }
    return all;
  }
  // Each technique as it is, and once with knobs drawn by lot; the reference's own knobs must not matter either.
  for (const std::string& name : technique_names()) {
    if (name != options_.reference) all.push_back({name, name, {}});
    all.push_back({name, name + ", knobs by lot", drawn_settings(seed * 16 + all.size())});
  }
  return all;
}

ExactnessRow& ExactnessRun::row_of(const std::string& scene, const std::string& technique) {
  for (ExactnessRow& row : report_.rows)
    if (row.scene == scene && row.technique == technique) return row;
  return report_.rows.emplace_back(ExactnessRow{.scene = scene, .technique = technique});
}

void ExactnessRun::count(ExactnessRow& row, const PictureDifference& d, const Job& job, const std::string& again) {
  ++row.pictures;
  ++report_.pictures;
  if (d.differing == 0) return;
  ++row.differing_pictures;
  row.differing_pixels += d.differing;
  row.max_difference = std::max(row.max_difference, d.max_difference);
  report_.differing_pixels += d.differing;
  if (d.differing <= row.worst_pixels) return;
  row.worst_pixels = d.differing;
  row.worst = fmt::format("{}: {} pixels, the first at {}, {}, with --size {}x{} --samples {} --technique {}", again,
                          d.differing, d.first_x, d.first_y, job.width_px, job.height_px, job.samples, job.technique);
  for (const KnobSetting& s : job.settings) row.worst += fmt::format(" --set {}.{}={}", s.pass, s.knob, s.value);
}

Expected<void> ExactnessRun::check_scene(const std::string& label, const std::string& again, const std::string& file,
                                         uint64_t seed) {
  const auto at_place = [&](const Error& e) { return std::unexpected(Error{e.kind, e.text(), again}); };
  if (auto loaded = renderer_->load(file); !loaded) return at_place(loaded.error());
  for (const auto& [width_px, height_px] : options_.sizes)
    for (const int samples : options_.samples) {
      Job job;
      job.scene = file;
      job.width_px = width_px, job.height_px = height_px, job.samples = samples;
      std::map<std::string, Beauty> references;
      for (const Way& way : ways(seed)) {
        job.technique = way.technique;
        job.settings.clear();
        const Job wanted = with_every_light(job, options_.reference);
        if (!references.contains(wanted.technique)) {
          auto reference = renderer_->render(wanted, 0);
          if (!reference) return at_place(reference.error());
          references.emplace(wanted.technique, std::move(*reference));
        }
        job.settings = way.settings;
        const auto picture = renderer_->render(job, 0);
        if (!picture) return at_place(picture.error());
        count(row_of(label, way.label), difference(references.at(wanted.technique), *picture), job, again);
      }
    }
  return {};
}

Expected<void> ExactnessRun::check_fields() {
  const std::string generator = "light-field";
  for (int i = 0; i < options_.fields && !stopped(); ++i) {
    const uint64_t seed = options_.seed + uint64_t(i);
    const int lights = lights_of_field(seed);
    const auto file = store_.generated(generator, seed, lights);
    if (!file) return std::unexpected(file.error());
    const std::string again = fmt::format("make-scene {} --seed {} --lights {}", generator, seed, lights);
    if (auto checked = check_scene(generator, again, *file, seed); !checked) return checked;
    store_.remove(*file);
    if ((i + 1) % 50 == 0)
      log::info("{} of {} fields, {} pixels differ", i + 1, options_.fields, report_.differing_pixels);
  }
  return {};
}

Expected<void> ExactnessRun::check_scenes() {
  uint64_t seed = options_.seed;
  for (const SuiteScene& scene : options_.scenes) {
    if (stopped()) break;
    if (!scene.missing.empty()) {
      report_.skipped.push_back(fmt::format("{}: {}", scene.label, scene.missing));
      continue;
    }
    const int lights = scene.lights.empty() ? 0 : scene.lights.front();
    const auto file =
        scene.generated() ? store_.generated(scene.label, options_.seed, lights) : Expected<std::string>(scene.file);
    if (!file) return std::unexpected(file.error());
    const std::string again =
        scene.generated() ? fmt::format("make-scene {} --seed {} --lights {}", scene.label, options_.seed, lights)
                          : scene.label;
    if (auto checked = check_scene(scene.label, again, *file, seed++); !checked) return checked;
  }
  return {};
}

Expected<ExactnessReport> ExactnessRun::run() {
  const auto start = Clock::now();
  auto renderer = SharedRenderer::open(settings_);
  if (!renderer) return std::unexpected(renderer.error());
  renderer_ = std::move(*renderer);
  report_.device = renderer_->device().name, report_.driver = renderer_->device().driver;
  if (auto checked = check_fields(); !checked) return std::unexpected(checked.error());
  if (auto checked = check_scenes(); !checked) return std::unexpected(checked.error());
  report_.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  return std::move(report_);
}

}  // namespace

std::span<const DrawnKnob> drawn_knobs() {
  static const DrawnKnob table[] = {
      {"cull", "enabled", {"0", "1"}},
      {"occlusion_cull", "mode", {"off", "on"}},
      {"occlusion_cull", "first_share", {"0", "0.005", "0.1"}},
      {"lights", "test", {"aabb", "cone-sphere", "capsule", "capsule-joint"}},
      {"lights", "mask", {"0", "1"}},
      {"lights", "list", {"auto", "bitmask", "compact"}},
      {"lights", "tile_px", {"8", "16", "24", "32", "64"}},
      {"lights", "order", {"auto", "sorted", "segments"}},
      {"lights", "slices_per_octave", {"1", "2", "4", "8", "16"}},
      {"lights", "few", {"0", "0", "8"}},  // most often lists even of a single light
      {"lights", "memory_mb", {"1", "512"}},
      {"lights", "sift_over", {"0", "1073741824"}},
      {"sun", "skip_served", {"0", "1"}},
      {"sun", "draws", {"2097152", "4194304"}},
      {"local", "draws", {"2097152", "4194304"}},
      {"fragments", "memory_mib", {"128", "256"}},
      {"fragments", "rounds", {"16", "32"}},
      {"rasterize", "small_px", {"1", "8", "64"}},
      {"rasterize", "list", {"1", "524288"}},
      {"pose_lights", "enabled", {"off", "on"}},
      {"key_depth", "tiles", {"0", "1"}},
      {"sample_store", "in", {"image", "buffer"}},
      {"pose_items", "enabled", {"0", "1"}},
      {"bvh", "builder", {"equal-counts", "sah", "sbvh"}},
      {"bvh", "buckets", {"12", "32"}},
      {"bvh", "max_leaf", {"1", "8"}},
      {"bvh", "block", {"0", "2"}},
      {"bvh", "node_cost", {"0.125", "0.5"}},
      {"bvh", "depth", {"8", "60"}},
      {"bvh", "budget", {"0", "1"}},
      {"bvh", "repeated", {"0", "524288"}},
      {"light_rays", "apart", {"off", "on"}},
      {"light_rays", "budget_mb", {"1", "256"}},
      {"bvh", "traversal", {"shader"}},  // the others are of devices that have them (bench/suites/traversal.json)
  };
  return table;
}

std::vector<std::string> picture_changing_knobs() {
  std::vector<std::string> names;
  for (const KnobRow& knob : knob_rows("high"))
    if (knob.kind != "time") names.push_back(knob.pass + "." + knob.knob);
  return names;
}

std::vector<KnobSetting> drawn_settings(uint64_t seed) {
  Rng rng(seed ^ 0x5e771e5);
  std::vector<KnobSetting> settings;
  for (const DrawnKnob& knob : drawn_knobs())
    settings.push_back({knob.pass, knob.knob, knob.values[rng.next() % knob.values.size()]});
  return settings;
}

int lights_of_field(uint64_t seed) { return int(std::lround(std::exp2(Rng(seed ^ 0x1197).uniform(0, 9)))); }

std::vector<SuiteScene> scenes_with_lights(const std::filesystem::path& assets) {
  std::vector<SuiteScene> scenes;
  for (const char* path : {"lights/PointLightTest/PointLightTest.gltf", "lights/SpotLightTest/SpotLightTest.gltf",
                           "lights/spotLightTest-gdx/spotLightTest.gltf", "lights/TrafficLight/TrafficLight.glb",
                           "lights/lights_punctual_test/gltf_KHR_lights_punctual_test.glb",
                           "cameras/lightCameraAnimations/lightCameraAnimations.gltf"})
    scenes.push_back(suite_scene(std::string("assets:") + path, {}, assets));
  for (const char* name : {"spheres", "alpha", "animated", "near-world", "far-world", "orthographic"})
    scenes.push_back(suite_scene(name, {}, assets));
  for (const auto& [name, lights] : {std::pair("street", 2048), std::pair("lights-stacked", 10'000)}) {
    scenes.push_back(suite_scene(name, {}, assets));
    scenes.back().lights = {lights};
  }
  return scenes;
}

Expected<ExactnessReport> check_exactness(const ExactnessOptions& options, const RunSettings& settings,
                                          const std::function<bool()>& stop) {
  return ExactnessRun(options, settings, stop).run();
}

}  // namespace candela
