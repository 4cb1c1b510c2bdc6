#include "bench/error_truth.h"

#include <algorithm>
#include <optional>

#include "base/files.h"
#include "base/log.h"
#include "bench/error_parts.h"
#include "render/reference_frame.h"
#include "render/reference_layers.h"
#include "session/session.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

// The version does not change with every build, what the tracer computes might.
const std::optional<Hash128>& program_content() {
  static const std::optional<Hash128> content = [] {
    const auto bytes = read_file("/proc/self/exe");
    return bytes ? std::optional(hash128(*bytes)) : std::nullopt;
  }();
  return content;
}

// Empty: nothing can be kept.
fs::path film_file(const Hash128& identity) {
  const fs::path cache = cache_folder();
  if (cache.empty() || !program_content()) return {};
  std::error_code failed;
  fs::create_directories(cache / "references", failed);
  return failed ? fs::path()
                : cache / "references" / (hash128(identity.hex() + program_content()->hex()).hex() + ".film");
}

// What a film goes on from, and where it is kept.
struct KeptFilm {
  reference::Film film;
  fs::path file;  // empty: it is not kept
};
KeptFilm kept_film(const Hash128& identity, const Job& job, reference::FilmParts parts, uint64_t most_spp) {
  KeptFilm kept{reference::Film(job.width_px, job.height_px, parts), film_file(identity)};
  std::error_code failed;
  if (kept.file.empty() || !fs::exists(kept.file, failed)) return kept;
  auto film = reference::Film::load(kept.file, identity, job.width_px, job.height_px, parts);
  if (!film) return kept;  // damaged: it is made anew
  if (film->samples() <= most_spp)
    kept.film = std::move(*film);
  else
    kept.file.clear();  // a longer one must not decide what a shorter one is, nor be lost to it
  return kept;
}

void trace(Truth& truth, const ReferenceFrame& frame, const Job& job, uint64_t seed, const TruthLimits& limits,
           const std::function<bool()>& stop) {
  reference::TraceSettings settings;
  settings.sampler.seed = seed;
  settings.mode = truth.name == "path" ? reference::Mode::path : reference::Mode::direct;
  settings.visibility = truth.name != open_reference_name;
  std::vector<std::string> layers = reference_part_layers(!frame.world->media().empty());
  layers.emplace_back("depth");
  const Hash128 identity = film_identity(job, frame, settings, {}, true);
  auto [film, file] = kept_film(identity, job, film_parts(frame, layers), limits.spp);
  const uint64_t kept = film.samples();
  const reference::Integrator integrator(*frame.world, settings, film.width(), film.height());
  constexpr double save_every_us = 60e6;
  double saved_us = process_clock_us();
  const auto save = [&] {
    saved_us = process_clock_us();
    if (file.empty() || film.samples() == kept) return;
    if (auto saved = film.save(file, identity); !saved)
      log::warning("the traced reference could not be saved for the next run: {}", saved.error().text());
  };
  const double began_us = process_clock_us();
  if (kept < limits.spp)
    reference::refine(
        film, integrator, {.spp = limits.spp, .seconds = limits.seconds, .noise = std::sqrt(limits.noise)},
        [&](const reference::Progress&) { return !stop || !stop(); },
        [&] {
          if (process_clock_us() - saved_us > save_every_us) save();
        });
  if (film.samples() > kept) truth.sample_s = (process_clock_us() - began_us) * 1e-6 / double(film.samples() - kept);
  save();
  log::info("reference {}: {} samples a pixel ({} of them kept before), relative standard error {:.3g} %", truth.name,
            film.samples(), kept, film.relative_error() * 100);
  truth.spp = film.samples();
  if (truth.spp == 0) {
    truth.failed = "stopped before its first sample";
    return;
  }
  const auto image = [&](const std::vector<std::string>& with) {
    return reference_image(film, frame, job, settings_json(settings, {}), with, std::nullopt, {});
  };
  truth.image = image({"variance"});
  if (limits.with_parts) truth.divided = image(layers);
}

}  // namespace

std::vector<std::string> error_reference_names() { return {exact_reference, open_reference_name, "direct", "path"}; }

namespace {

// Light goes through its surfaces, which `direct` takes for opaque.
bool lets_light_through(const Scene& scene) {
  return std::ranges::any_of(scene.materials, [](const Material& m) {
    return m.has(Lobe::transmission) || m.has(Lobe::diffuse_transmission) || m.has(Lobe::scattering);
  });
}

using LoadedScene = Expected<std::shared_ptr<const ReferenceScene>>;

// A scene as each reference takes it, read once.
class TruthScenes {
 public:
  explicit TruthScenes(const Job& job) : job_(job), opaque_(load_reference(job, reference::Mode::direct)) {}
  const LoadedScene& of(reference::Mode mode) {
    if (mode == reference::Mode::direct) return opaque_;
    if (!see_through_) see_through_ = load_reference(job_, mode);
    return *see_through_;
  }
  reference::Mode mode_of(const std::string& name) const {
    const bool through = name == "path" && opaque_ && lets_light_through((*opaque_)->scene);
    return through ? reference::Mode::path : reference::Mode::direct;
  }

 private:
  const Job& job_;
  LoadedScene opaque_;
  std::optional<LoadedScene> see_through_;
};

}  // namespace

std::string claimed_reference(const Job& job, const Scene& scene) {
  const bool shadowed = job.effects == "auto" || job.effects.find("shadows") != std::string::npos ||
                        job.effects.find("occlusion") != std::string::npos;
  return lets_light_through(scene) ? "path" : shadowed ? "direct" : open_reference_name;
}

std::vector<std::vector<Truth>> traced_truths(const Job& job, const std::vector<TruthView>& views,
                                              const std::vector<std::string>& names, const TruthLimits& limits,
                                              const std::function<bool()>& stop) {
  std::vector<std::vector<Truth>> truths(views.size());
  TruthScenes scenes(job);
  for (size_t v = 0; v < views.size(); ++v) {
    Job of_view = job;
    of_view.camera = views[v].camera;
    for (const std::string& name : names) {
      Truth& truth = truths[v].emplace_back(Truth{.name = name});
      const reference::Mode mode = scenes.mode_of(name);
      const LoadedScene& loaded = scenes.of(mode);
      const auto frame =
          loaded ? pose_reference(*loaded, of_view, views[v].time_s, {}, mode) : std::unexpected(loaded.error());
      if (frame)
        trace(truth, **frame, of_view, views[v].seed, limits, stop);
      else
        truth.failed = frame.error().text();
    }
  }
  return truths;
}

}  // namespace candela
