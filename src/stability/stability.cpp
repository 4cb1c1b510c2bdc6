#include "stability/stability.h"

#include <chrono>
#include <cstring>
#include <filesystem>
#include <map>

#include "base/clock.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/log.h"
#include "bench/picture.h"
#include "bench/scene_store.h"
#include "bench/shared_renderer.h"
#include "image/io.h"
#include "render/frame_layers.h"
#include "render/outputs.h"
#include "render/reference_frame.h"
#include "stability/fog_picture.h"
#include "stability/measure.h"
#include "stability/scene_files.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

// A picture with what was said when it was made.
struct Shot {
  Beauty beauty;
  double pre_exposure = 1;
  std::optional<DisplayImage> display;
  std::vector<std::string> warnings;
  LayerCounts layers;
};

class StabilityRun {
 public:
  StabilityRun(const StabilityOptions& options, const RunSettings& settings, const std::function<bool()>& stop)
      : options_(options), settings_(settings), stop_(stop) {
    techniques_ = options.techniques.empty() ? technique_names() : options.techniques;
  }
  Expected<StabilityReport> run();

 private:
  bool wanted(const StabilityRecipe& recipe) const;
  Expected<void> check_scene(const StabilityRecipe& recipe);
  Expected<void> check_fog(const StabilityRecipe& recipe, const StabilityScene& scene, Job job);
  Expected<Shot> shot(Job job, double time_s, bool display, const std::string& effects);
  void check_effects(const StabilityScene& scene, const Job& job, const Shot* bare, StabilityRow& row);
  void check_defaults(const StabilityScene& scene, Job job, std::optional<Beauty>& first, StabilityRow& row);
  Expected<void> check_every_effect(const StabilityScene& scene, Job job, StabilityRow& row);
  void count_faults(const char* with, const Expected<Shot>& made, const Shot* bare, double most,
                    StabilityRow& row) const;
  Expected<std::map<std::string, TruePicture>> plain_truths(const StabilityScene& scene);
  void measure(const StabilityScene& scene, const Shot& shot, const TruePicture* traced, const TruePicture* plain,
               StabilityRow& row) const;
  void judge(const StabilityScene& scene, const Shot& shot, StabilityRow& row) const;
  void refuse(const StabilityScene& scene, const Error& error, StabilityRow& row) const;
  bool keeps_pictures() const { return !options_.pictures.empty() || options_.thumbnails; }
  Expected<void> keep_picture(const StabilityRecipe& recipe, const StabilityScene& scene, const Shot& shot,
                              StabilityRow& row) const;
  void add(StabilityRow row);
  std::string path(const char* name) const { return (store_.folder() / name).string(); }
  std::string without_folder(std::string text) const;  // whose name says nothing, and differs from run to run

  const StabilityOptions& options_;
  RunSettings settings_;
  const std::function<bool()>& stop_;
  std::vector<std::string> techniques_;
  SceneStore store_;
  std::unique_ptr<SharedRenderer> renderer_;
  StabilityReport report_;
};

bool StabilityRun::wanted(const StabilityRecipe& recipe) const {
  const auto& families = options_.families;
  if (!families.empty() && std::find(families.begin(), families.end(), recipe.family) == families.end()) return false;
  const std::string name = recipe.family + "/" + recipe.name;
  return options_.only.empty() || std::any_of(options_.only.begin(), options_.only.end(), [&](const std::string& part) {
           return name.find(part) != std::string::npos;
         });
}

Expected<Shot> StabilityRun::shot(Job job, double time_s, bool display, const std::string& effects) {
  job.effects = effects;
  auto frame = renderer_->frame(job, {.linear = true, .display = display, .display_bits = 16}, time_s);
  if (!frame) return std::unexpected(frame.error());
  auto beauty = beauty_of(*frame);
  if (!beauty) return fail(ErrorKind::device, "", "the frame has no linear picture");
  Shot made{std::move(*beauty), frame->pre_exposure, {}, renderer_->warnings(), {}};
  for (const FrameOutput& output : frame->outputs)
    if (std::ranges::find(job.layers, output.layer) != job.layers.end()) made.layers.add(layer_image(*frame, output));
  made.warnings.insert(made.warnings.end(), frame->warnings.begin(), frame->warnings.end());
  if (display) {
    job.png_bits = 16;
    made.display = display_image(*frame, job);
  }
  return made;
}

// The pixels of the plain scene by technique: those whose pixels are their own are held to their own.
Expected<std::map<std::string, TruePicture>> StabilityRun::plain_truths(const StabilityScene& scene) {
  std::map<std::string, TruePicture> truths;
  if (scene.plain.empty()) return truths;
  Job job = scene.plain_job.value_or(scene.job);
  const std::string sky = scene.plain_sky ? path("plain-sky.exr") : scene.sky ? path("sky.exr") : "";
  job.sky = sky;
  if (auto loaded = renderer_->load(path("plain.glb"), sky); !loaded) return std::unexpected(loaded.error());
  const std::string* shared = nullptr;
  for (const std::string& technique : techniques_) {
    const bool own = has_own_pixels(technique);
    if (!own && shared) {
      truths[technique] = truths[*shared];
      continue;
    }
    job.technique = technique;
    const auto made = shot(job, scene.plain_time_s, false, scene.effects);
    if (!made) return std::unexpected(made.error());
    truths[technique] = picture_truth(made->beauty, made->pre_exposure);
    if (!own) shared = &technique;
  }
  return truths;
}

void StabilityRun::measure(const StabilityScene& scene, const Shot& shot, const TruePicture* traced,
                           const TruePicture* plain, StabilityRow& row) const {
  const PixelCounts counts = count_pixels(shot.beauty, shot.pre_exposure);
  row.pixels = uint64_t(shot.beauty.width_px) * uint64_t(shot.beauty.height_px);
  row.nonfinite = counts.nonfinite;
  row.clamped = counts.beyond_half;
  if (counts.nonfinite > 0)
    row.faults.push_back(
        fmt::format("{} pixels are not finite, the first at {}, {}", counts.nonfinite, counts.first_x, counts.first_y));
  row.may_be_beyond = uint64_t(std::ceil(scene.stray_fraction * double(row.pixels)));
  row.bound = scene.bound, row.plain_bound = scene.plain_bound, row.energy_bound = scene.energy_bound;
  const auto against = [&](const TruePicture& truth, const char* name, double bound, double& largest) {
    const TruthError e = picture_error(shot.beauty, shot.pre_exposure, truth, bound, scene.least_light);
    row.truth += (row.truth.empty() ? "" : " and ") + std::string(name);
    largest = e.max_relative;
    row.beyond = std::max(row.beyond, e.beyond);
    if (std::abs(e.energy) >= std::abs(row.energy)) row.energy = e.energy;
    if (e.max_relative > 0)
      row.worst += fmt::format("{}{}: {}, {}", row.worst.empty() ? "" : "; ", name, e.worst_x, e.worst_y);
    if (e.beyond > row.may_be_beyond)
      row.faults.push_back(fmt::format("{} pixels differ from the {} by more than {}, the worst by {:.3g} at {}, {}",
                                       e.beyond, name, bound, e.max_relative, e.worst_x, e.worst_y));
    // Pixels that may be beyond their bound are edges; where there are more, all light counts.
    const double off = e.beyond > row.may_be_beyond ? e.energy : e.energy_beyond;
    if (!(std::abs(off) <= scene.energy_bound))
      row.faults.push_back(fmt::format("{:+.3g} of the {}'s energy", off, name));
  };
  if (traced) against(*traced, scene.known ? "closed form" : "reference", scene.bound, row.max_relative);
  if (plain) against(*plain, "plain scene", scene.plain_bound, row.plain_relative);
  if (scene.black) {
    row.truth += (row.truth.empty() ? "" : " and ") + std::string("black");
    if (!counts.black) row.faults.push_back("light where there is none");
  }
  if (std::isfinite(scene.most)) {
    row.truth += (row.truth.empty() ? "" : " and ") + fmt::format("at most {}", scene.most);
    if (!(counts.most <= scene.most)) row.faults.push_back(fmt::format("{} is above {}", counts.most, scene.most));
  }
  if (shot.display && scene.display) {
    Job job = scene.job;
    row.display_error = display_error(*shot.display, shot.beauty, shot.pre_exposure, job);
    if (!(row.display_error <= display_bound))
      row.faults.push_back(fmt::format("the display picture is {:.3g} off its curve", row.display_error));
  }
}

std::string StabilityRun::without_folder(std::string text) const {
  const std::string folder = store_.folder().string() + "/";
  for (size_t at; (at = text.find(folder)) != std::string::npos;) text.erase(at, folder.size());
  return text;
}

// With effects too every pixel is finite and no colour negative or above `most`, and where they only take light away
// none is brighter than `bare`.
void StabilityRun::count_faults(const char* with, const Expected<Shot>& made, const Shot* bare, double most,
                                StabilityRow& row) const {
  if (!made) {
    row.faults.push_back(fmt::format("with {}: no picture: {}", with, without_folder(made.error().text())));
    return;
  }
  const EffectCounts counts = count_effects(bare ? &bare->beauty : nullptr, bare ? bare->pre_exposure : 1, made->beauty,
                                            made->pre_exposure, most);
  row.effects_nonfinite += counts.nonfinite;
  const auto fault = [&](uint64_t pixels, const char* what) {
    if (pixels > 0)
      row.faults.push_back(
          fmt::format("with {} {} pixels {}, the first at {}, {}", with, pixels, what, counts.first_x, counts.first_y));
  };
  fault(counts.nonfinite, "are not finite");
  fault(counts.negative, "are negative");
  fault(counts.brighter, "are brighter");
  row.effects_nonfinite += made->layers.nonfinite;
  if (made->layers.nonfinite > 0)
    row.faults.push_back(fmt::format("with {} {} values of layers are not finite", with, made->layers.nonfinite));
  if (const uint64_t pixels = made->layers.overcovered(); pixels > 0)
    row.faults.push_back(fmt::format("with {} the mattes of {} pixels cover more than all of them", with, pixels));
}

// The effects of quality high and of the look. Without a sky image to reflect, without fog and glass they only take
// away.
void StabilityRun::check_effects(const StabilityScene& scene, const Job& job, const Shot* bare, StabilityRow& row) {
  count_faults("effects", shot(job, scene.time_s, false, "auto"), bare, scene.most, row);
}

// What a plain command draws: the defaults of every knob, the light at which lamps without range end among them, and
// the effects of the quality. `first`: the picture of the first technique whose pixels all such techniques share.
void StabilityRun::check_defaults(const StabilityScene& scene, Job job, std::optional<Beauty>& first,
                                  StabilityRow& row) {
  job.settings = options_.settings;
  const auto made = shot(job, scene.time_s, false, "auto");
  count_faults("defaults", made, nullptr, scene.most, row);
  if (!made || has_own_pixels(job.technique)) return;
  if (!first)
    first = made->beauty;
  else if (const uint64_t pixels = difference(*first, made->beauty).differing; pixels > 0)
    row.faults.push_back(fmt::format("with defaults {} pixels are not those of other techniques", pixels));
}

// All that a look can switch on at once, with lights of a size and shadows and occlusion by rays, and the layers that
// come from two times and from many samples.
Expected<void> StabilityRun::check_every_effect(const StabilityScene& scene, Job job, StabilityRow& row) {
  constexpr std::string_view look = R"({"sun": {"angular_radius_deg": 0.5}, "lights": {"radius_m": 0.05},
    "fog": {"scattering": 0.05, "absorption": 0.01, "anisotropy": 0.6, "falloff": 0.3, "emission": 0.01},
    "volumetric": {"phi": 5, "tau": 0.05, "anisotropy": 0.2}, "reflections": {},
    "probes": [{"position": [0, 1, 0], "box": {"min": [-50, -50, -50], "max": [50, 50, 50]}}],
    "bloom": {"strength": 0.1, "beauty": true}, "occlusion": {"radius_m": 2}})";
  job.technique = techniques_.front();
  job.layers = {"motion", "crypto_object", "crypto_material"};
  job.look = path("every-effect.json");
  auto every = own_json(look);
  if (!scene.sky_look.empty()) every.update(own_json(scene.sky_look));
  const std::string text = every.dump();
  if (auto written = write_file_atomically(job.look, std::as_bytes(std::span(text))); !written) return written;
  for (const auto& [pass, knob] : {std::pair("sun", "mode"), {"local", "method"}, {"occlusion", "method"}})
    job.settings.push_back({pass, knob, "traced"});
  for (const auto& [pass, knob] : {std::pair("sun", "samples"), {"local", "samples"}, {"occlusion", "rays"}})
    job.settings.push_back({pass, knob, "2"});
  job.settings.push_back({"fog", "grid", "32x18x24"});
  job.settings.push_back({"probes", "size_px", "16"});
  constexpr double any = std::numeric_limits<double>::infinity();  // fog and bloom add light
  count_faults("every effect", shot(job, scene.time_s, false, "auto"), nullptr, any, row);
  return {};
}

void StabilityRun::judge(const StabilityScene& scene, const Shot& shot, StabilityRow& row) const {
  for (const std::string& warning : shot.warnings) row.warnings.push_back(without_folder(warning));
  if (scene.refused) row.faults.push_back("is drawn, and should be refused");
  if (scene.warns && row.warnings.empty()) row.faults.push_back("nothing warned of it");
  if (scene.clamps && row.clamped == 0) row.faults.push_back("no value is beyond half");
  if (row.differing > 0)
    row.faults.push_back(fmt::format("{} pixels are not {}'s", row.differing, techniques_.front()));
}

void StabilityRun::refuse(const StabilityScene& scene, const Error& error, StabilityRow& row) const {
  row.error = without_folder(error.text());
  row.truth = "refused";
  if (!scene.refused) row.faults.push_back("no picture: " + row.error);
  // The caller must be able to act on it.
  if (scene.refused && error.kind != ErrorKind::input && error.kind != ErrorKind::usage)
    row.faults.push_back(fmt::format("refused with exit code {}", int(error.kind)));
}

void StabilityRun::add(StabilityRow row) {
  report_.faulty_rows += !row.faults.empty();
  report_.nonfinite += row.nonfinite + row.effects_nonfinite;
  for (const std::string& fault : row.faults)
    log::warning("{}/{}, {}: {}", row.family, row.scene, row.technique, fault);
  report_.rows.push_back(std::move(row));
}

Expected<void> StabilityRun::keep_picture(const StabilityRecipe& recipe, const StabilityScene& scene, const Shot& shot,
                                          StabilityRow& row) const {
  constexpr int thumbnail_px = 128;
  if (options_.thumbnails) row.thumbnail = thumbnail_png(eight_bits(*shot.display), thumbnail_px);
  if (options_.pictures.empty()) return {};
  std::string name = recipe.family + "-" + recipe.name;
  for (char& c : name)
    if (!std::isalnum(uint8_t(c)) && c != '-' && c != '+' && c != '.') c = '_';
  std::error_code ignored;
  fs::create_directories(options_.pictures, ignored);
  if (auto kept =
          write_file_atomically(fs::path(options_.pictures) / (name + ".glb"), std::span<const std::byte>(scene.file));
      !kept)
    return kept;
  return write_png(fs::path(options_.pictures) / (name + ".png"), *shot.display, {});
}

Expected<void> StabilityRun::check_scene(const StabilityRecipe& recipe) {
  const Hash128 name = hash128(recipe.family + "/" + recipe.name);
  StabilityInput input{Rng(options_.seed ^ std::stoull(name.hex().substr(0, 16), nullptr, 16)), options_.large};
  const StabilityScene scene = recipe.make(input);
  if (auto written = write_scene_files(scene, store_.folder()); !written) return written;
  StabilityRow empty;
  empty.family = recipe.family, empty.scene = recipe.name, empty.what = recipe.what;

  Job job = scene.job;
  job.scene = path("scene.glb");
  if (scene.sky) job.sky = path("sky.exr");  // else as the scene's job says: a word, or nothing
  for (PathRequest& p : job.paths)
    for (std::string* const file : {&p.points, &p.times})
      if (!file->empty()) *file = path(file->c_str());
  job.settings.insert(job.settings.end(), options_.settings.begin(), options_.settings.end());
  if (!scene.look.empty()) return check_fog(recipe, scene, job);
  const auto plain = plain_truths(scene);
  if (!plain)
    return std::unexpected(Error{plain.error().kind, "the plain scene: " + plain.error().text(), recipe.name});
  if (!scene.sky_look.empty()) job.look = path("look.json");
  std::optional<TruePicture> traced;
  const bool keep = keeps_pictures();
  auto loaded = renderer_->load(job.scene, job.sky);
  std::optional<Shot> first;
  std::optional<Beauty> by_default;
  std::vector<StabilityRow> rows;
  for (const std::string& technique : techniques_) {
    StabilityRow row = empty;
    row.technique = technique;
    job.technique = technique;
    const auto start = Clock::now();
    auto made =
        loaded ? shot(job, scene.time_s, scene.display || keep, scene.effects) : std::unexpected(loaded.error());
    row.wall_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (!made) {
      refuse(scene, made.error(), row);
      rows.push_back(std::move(row));
      if (!loaded) break;  // one row says it for all techniques
      continue;
    }
    if (scene.reference && !scene.refused && !traced) {
      auto picture = traced_picture(job, scene.time_s, std::ldexp(1.0, -int(renderer_->device().subpixel_bits)),
                                    scene.blocked_samples);
      if (picture)
        traced = std::move(*picture);
      else
        row.faults.push_back("the reference: " + picture.error().text());
    }
    if (scene.paths && !first) {
      const auto bad = nonfinite_paths(job, scene.time_s);
      if (!bad || *bad > 0)
        row.faults.push_back("paths: " + (bad ? fmt::format("{} pixels are not finite", *bad) : bad.error().text()));
    }
    const auto own_plain = plain->find(technique);
    measure(scene, *made, traced ? &*traced : nullptr, own_plain == plain->end() ? nullptr : &own_plain->second, row);
    // Textures are loaded for the first technique alone.
    if (first && made->warnings.size() < first->warnings.size()) made->warnings = first->warnings;
    // Pixels of its own are held to the truth alone.
    if (first && !has_own_pixels(techniques_.front()) && !has_own_pixels(technique))
      row.differing = difference(first->beauty, made->beauty).differing;
    judge(scene, *made, row);
    // What a sky shines on a surface from one side may be more than its mean, and what is seen through a surface more
    // than it reflects: such pictures are not compared.
    const bool brightens = scene.sky || !scene.sky_look.empty() || scene.paths;
    if (!first) check_effects(scene, job, brightens ? nullptr : &*made, row);
    check_defaults(scene, job, by_default, row);
    if (!first && keep)
      if (auto kept = keep_picture(recipe, scene, *made, row); !kept) return kept;
    if (!first) first = std::move(*made);
    rows.push_back(std::move(row));
  }
  // Last, for another look loads the sky again and warns again.
  if (first)
    if (auto checked = check_every_effect(scene, job, rows.front()); !checked) return checked;
  for (StabilityRow& row : rows) add(std::move(row));
  ++report_.scenes;
  return {};
}

Expected<void> StabilityRun::check_fog(const StabilityRecipe& recipe, const StabilityScene& scene, Job job) {
  job.look = path("look.json");
  const auto text = std::as_bytes(std::span(scene.look));
  if (auto written = write_file_atomically(job.look, text); !written) return written;
  for (const reference::Mode mode : {reference::Mode::direct, reference::Mode::path}) {
    StabilityRow row;
    row.family = recipe.family, row.scene = recipe.name, row.what = recipe.what;
    row.technique = "reference " + std::string(name_of(mode));
    const auto start = Clock::now();
    const auto picture = fog_picture(job, mode, scene.known);
    row.wall_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (!picture) {
      refuse(scene, picture.error(), row);
      add(std::move(row));
      break;
    }
    StabilityScene judged = scene;
    // Single pixels are noise: their sum is judged.
    if (mode == reference::Mode::path)
      judged.bound = 1e9, judged.energy_bound = std::max(scene.energy_bound, fog_noise_bound);
    Shot made{picture->beauty, 1, {}, {}, {}};
    if (keeps_pictures()) made.display = picture->display;
    measure(judged, made, picture->known ? &*picture->known : nullptr, nullptr, row);
    judge(judged, made, row);
    if (mode == reference::Mode::direct && made.display)
      if (auto kept = keep_picture(recipe, scene, made, row); !kept) return kept;
    add(std::move(row));
  }
  if (scene.refused) {
    ++report_.scenes;
    return {};
  }
  // What the device draws of it is compared with the reference by tests; here it must be numbers.
  StabilityRow drawn;
  drawn.family = recipe.family, drawn.scene = recipe.name, drawn.what = recipe.what;
  drawn.technique = job.technique = techniques_.front();
  const auto start = Clock::now();
  if (auto loaded = renderer_->load(job.scene, job.sky); !loaded)
    refuse(scene, loaded.error(), drawn);
  else
    check_effects(scene, job, nullptr, drawn);
  drawn.wall_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  drawn.pixels = uint64_t(job.width_px) * uint64_t(job.height_px);
  add(std::move(drawn));
  ++report_.scenes;
  return {};
}

Expected<StabilityReport> StabilityRun::run() {
  const auto start = Clock::now();
  auto renderer = SharedRenderer::open(settings_);
  if (!renderer) return std::unexpected(renderer.error());
  renderer_ = std::move(*renderer);
  report_.device = renderer_->device().name, report_.driver = renderer_->device().driver;
  report_.seed = options_.seed, report_.large = options_.large;
  for (const StabilityRecipe& recipe : stability_recipes(options_.sizes)) {
    if (!wanted(recipe)) continue;
    if (stop_ && stop_()) {
      report_.stopped = true;
      break;
    }
    log::info("{}/{}", recipe.family, recipe.name);
    if (auto checked = check_scene(recipe); !checked) return std::unexpected(checked.error());
  }
  report_.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  return std::move(report_);
}

}  // namespace

Expected<StabilityReport> check_stability(const StabilityOptions& options, const RunSettings& settings,
                                          const std::function<bool()>& stop) {
  return StabilityRun(options, settings, stop).run();
}

}  // namespace candela
