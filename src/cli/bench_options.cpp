#include "cli/bench_options.h"

#include "base/log.h"
#include "base/text.h"
#include "cli/input_options.h"
#include "cli/job_options.h"
#include "session/device_technique.h"
#include "stability/stability.h"

namespace candela::cli {
namespace fs = std::filesystem;

Expected<std::string> technique_named(const std::string& name, const std::string& device) {
  if (name != auto_technique) return name;
  auto chosen = device_technique(device);
  if (!chosen) return std::unexpected(chosen.error());
  log::info("technique auto: {}, because {}", chosen->name, chosen->why);
  return std::move(chosen->name);
}

namespace {

Expected<std::vector<int>> whole_list(const char* option, const std::string& text, int lowest) {
  std::vector<int> list;
  for (const std::string& part : split(text, ',')) {
    int value = 0;
    const auto [at, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || at != part.data() + part.size() || value < lowest)
      return fail(ErrorKind::usage, option, "'{}' is not a whole number of at least {}", part, lowest);
    list.push_back(value);
  }
  return list;
}

Expected<std::vector<std::pair<int, int>>> size_list(const std::string& text) {
  std::vector<std::pair<int, int>> list;
  for (const std::string& part : split(text, ',')) {
    const auto size = parse_size(part);
    if (!size) return std::unexpected(Error{ErrorKind::usage, size.error().message, "--size"});
    list.push_back(*size);
  }
  return list;
}

Expected<std::vector<double>> time_list(const BenchOptions& o) {
  std::vector<double> list;
  if (!o.frames.empty()) {
    const auto rate = parse_frame_rate(o.fps);
    if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
    const auto frames = parse_frame_list(o.frames);
    if (!frames) return std::unexpected(Error{ErrorKind::usage, frames.error().message, "--frames"});
    constexpr size_t most = 100'000;
    if (frames->size() > most)
      return fail(ErrorKind::usage, "--frames", "{} frames are more than the {} that bench measures", frames->size(),
                  most);
    for (const int64_t frame : *frames) list.push_back(rate->seconds(frame));
    return list;
  }
  for (const std::string& part : split(o.times, ',')) {
    double value = 0;
    const auto [at, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || at != part.data() + part.size() || !std::isfinite(value))
      return fail(ErrorKind::usage, "--times", "'{}' is not a time in seconds", part);
    list.push_back(value);
  }
  return list;
}

Expected<std::vector<SuiteTechnique>> technique_list(const BenchOptions& o) {
  std::vector<SuiteTechnique> list;
  for (const std::string& name : split(o.techniques, ',')) list.push_back({name, {}});
  return list;
}

Expected<std::vector<KnobSweep>> sweeps(const BenchOptions& o) {
  std::vector<KnobSweep> list;
  for (const std::string& text : o.settings) {
    const auto sweep = parse_knob_sweep(text);
    if (!sweep) return std::unexpected(Error{ErrorKind::usage, sweep.error().message, "--set"});
    list.push_back(*sweep);
  }
  return list;
}

// Puts a parsed list over a suite's, when the option was given.
template <class T>
Expected<void> put(const std::string& given, Expected<std::vector<T>> parsed, std::vector<T>& over) {
  if (given.empty()) return {};
  if (!parsed) return std::unexpected(parsed.error());
  over = std::move(*parsed);
  return {};
}

// In the place of `auto` what it is on the device, once.
Expected<void> name_auto(const BenchOptions& o, std::vector<SuiteTechnique>& techniques) {
  std::vector<SuiteTechnique> named;
  for (SuiteTechnique& technique : techniques) {
    const bool chosen = technique.name == auto_technique;
    if (chosen) {
      const auto name = technique_named(technique.name, o.device);
      if (!name) return std::unexpected(name.error());
      technique.name = *name;
    }
    const auto same = [&](const SuiteTechnique& other) { return other.name == technique.name; };
    if (!chosen || !technique.set.empty() || std::ranges::none_of(named, same)) named.push_back(std::move(technique));
  }
  techniques = std::move(named);
  return {};
}

Expected<void> put_options(const BenchOptions& o, Suite& suite) {
  const Expected<void> done[] = {
      put(o.lights, whole_list("--lights", o.lights, 0), suite.lights),
      put(o.samples, whole_list("--samples", o.samples, 0), suite.samples),
      put(o.sizes, size_list(o.sizes), suite.sizes),
      put(o.times + o.frames, time_list(o), suite.times_s),
      put(o.techniques, technique_list(o), suite.techniques),
      put(o.qualities, Expected<std::vector<std::string>>(split(o.qualities, ',')), suite.qualities),
  };
  for (const Expected<void>& one : done)
    if (!one) return one;
  const auto set = sweeps(o);
  if (!set) return std::unexpected(set.error());
  // Over the suite's sweeps of the same knob, and over those of single techniques.
  for (const KnobSweep& sweep : *set) {
    const auto same = [&](const KnobSweep& s) { return s.pass == sweep.pass && s.knob == sweep.knob; };
    std::erase_if(suite.set, same);
    for (SuiteTechnique& technique : suite.techniques) std::erase_if(technique.set, same);
    suite.set.push_back(sweep);
  }
  if (!o.lights.empty())
    for (SuiteScene& scene : suite.scenes) scene.lights.clear();
  if (!o.camera.empty())
    for (SuiteScene& scene : suite.scenes) scene.camera = {.camera = o.camera};
  for (SuiteScene& scene : suite.scenes) {
    if (!o.sky.empty()) scene.sky = {o.sky, o.sky};
    if (!o.look.empty()) scene.look = {o.look, o.look};
  }
  if (auto chosen = name_auto(o, suite.techniques); !chosen) return chosen;
  if (!o.effects.empty()) suite.effects = o.effects;
  if (!o.transparency.empty()) suite.transparency = split(o.transparency, ',');
  if (o.seed) suite.seed = *o.seed;
  if (!o.output.empty()) suite.output = o.output;
  if (!o.reference.empty()) suite.reference = o.reference;
  if (o.budget_s) suite.budget_s = *o.budget_s;
  if (o.reference_max_lights) suite.reference_max_lights = *o.reference_max_lights;
  if (o.views) suite.view_count = *o.views, suite.views.clear();
  if (o.precision) suite.sampling.precision = *o.precision;
  if (o.warm_up_s) suite.sampling.warm_up_s = *o.warm_up_s;
  if (o.min_runs) suite.sampling.min_runs = *o.min_runs;
  if (o.max_runs) suite.sampling.max_runs = *o.max_runs;
  if (o.max_sessions) suite.sampling.max_sessions = *o.max_sessions;
  return {};
}

bool is_suite(const std::string& text) { return fs::path(text).extension() == ".json"; }

fs::path assets_of(const BenchOptions& o) {
  return o.assets.empty() ? fs::path("../shared/assets") : fs::path(o.assets);
}

}  // namespace

void add_bench_options(CLI::App& command, BenchOptions& o) {
  command.add_option("what", o.what, "Suite files (.json), scenes (.gltf, .glb), or generated scenes by name")
      ->type_name("SUITE.json|SCENE");
  command
      .add_option("--suite", o.suite,
                  "Built-in suite: exactness renders in all techniques and counts differing pixels; stability renders "
                  "extreme scenes and measures them against the truth; stillness measures how much pictures flicker "
                  "under a slowly moving camera")
      ->type_name("NAME");
  command
      .add_option("--techniques", o.techniques,
                  "Separated by commas; all by default. auto: what is quickest on the device")
      ->type_name("LIST");
  command.add_option("--lights", o.lights, "Numbers of lights of generated scenes: 1,4,16")->type_name("LIST");
  command.add_option("--size", o.sizes, "Sizes: 1280x720,640x360")->type_name("LIST");
  command.add_option("--samples", o.samples, "Samples a pixel: 1,4; 0: as the quality says")->type_name("LIST");
  command.add_option("--quality", o.qualities, "Presets of all knobs: draft,high")->type_name("LIST");
  command.add_option("--effects", o.effects, "As for render; given again, each is a configuration")->type_name("SET");
  command.add_option("--transparency", o.transparency, "Methods of drawing blended surfaces: sorted,layers")
      ->type_name("LIST");
  command.add_option("--sky", o.sky, "Sky of every scene, as for render")->type_name("FILE");
  command.add_option("--look", o.look, "Look file of every scene, as for render")->type_name("FILE");
  command.add_option("--set", o.settings, "Values of one knob, each a configuration; may be given again")
      ->allow_extra_args(false)
      ->type_name("PASS.KNOB=A,B,C");
  CLI::Option* times = command.add_option("--times", o.times, "Times in seconds")->type_name("LIST");
  command.add_option("--frames", o.frames, "Frames instead of times: 0-3")->type_name("LIST")->excludes(times);
  command.add_option("--fps", o.fps, "Frames per second of --frames")->capture_default_str()->type_name("RATE");
  command.add_option("--camera", o.camera, "Camera of the scenes by name or index")->type_name("NAME");
  command.add_option("--seed", o.seed, "Seed of generated scenes")->transform(whole_number<uint64_t>())->type_name("N");
  command.add_option("--output", o.output, "What a timed frame produces: exr (linear), png (tone-mapped) or both")
      ->type_name("NAME");
  command.add_option("--reference", o.reference, "Technique whose pixels the others must have")->type_name("NAME");
  command
      .add_option("--reference-max-lights", o.reference_max_lights,
                  "Compare pixels with the reference technique up to this many lights, even where it is not measured")
      ->transform(whole_number<int>())
      ->check(positive_number())
      ->type_name("N");
  command.add_option("--precision", o.precision, "Standard error to reach, as a part of the median; 0.01 is 1 %")
      ->check(positive_number())
      ->type_name("X");
  command.add_option("--min-runs", o.min_runs, "Least number of samples of every configuration")
      ->transform(whole_number<int>())
      ->check(positive_number())
      ->type_name("N");
  command.add_option("--max-runs", o.max_runs, "Largest number of samples; rows that reach it say so")
      ->transform(whole_number<int>())
      ->check(positive_number())
      ->type_name("N");
  command.add_option("--warm-up-s", o.warm_up_s, "Longest warm-up of a configuration")
      ->check(positive_number())
      ->type_name("SECONDS");
  command.add_option("--max-sessions", o.max_sessions, "Configurations open at once; 0: as the device allows")
      ->transform(whole_number<int>())
      ->check(non_negative_number())
      ->type_name("N");
  command
      .add_option(
          "--budget-s", o.budget_s,
          "For suites: time for samples; opening each configuration, and --min-runs of each, are not limited by it. "
          "With --error: time for everything, also for opening and references; the most useful rows are measured first")
      ->check(positive_number())
      ->type_name("SECONDS");
  command.add_flag("--error", o.error,
                   "Measure error against time: every knob from coarse to exact, and every technique at every quality, "
                   "against exact and traced pictures");
  command.add_flag("--resume", o.resume,
                   "With --error: go on from the rows that --json FILE holds; it is written after every row");
  command
      .add_option("--reference-spp", o.reference_spp,
                  "With --error or --suite stillness: samples a pixel of the traced references; 64 by default")
      ->transform(whole_number<uint64_t>())
      ->check(positive_number())
      ->type_name("N");
  command
      .add_option("--reference-seconds", o.reference_s, "With --error: longest time for one traced reference; 0: none")
      ->check(non_negative_number())
      ->type_name("S");
  command
      .add_option("--hdr-flip", o.hdr_flip,
                  "With --error: exposures of hdr-flip; auto takes them from each place's reference")
      ->type_name("auto|START,STOP,COUNT");
  command
      .add_option("--views", o.views,
                  "With --error: views of each scene, its own first (6); with fewer, fewer differences are sure")
      ->transform(whole_number<int>())
      ->check(positive_number())
      ->type_name("N");
  command.add_option("--count", o.count, "With --suite exactness: number of light fields")
      ->transform(whole_number<int>())
      ->check(non_negative_number())
      ->type_name("N");
  command
      .add_option("--only", o.only,
                  "With --suite stability (or a suite file of it): only scenes whose family/name contains one of "
                  "these; with --suite stillness: only these scenes")
      ->type_name("LIST");
  command.add_option("--pictures", o.pictures, "With --suite stability: folder for a PNG and the .glb of each scene")
      ->type_name("DIR");
  command.add_flag("--large", o.large, "With --suite stability: ten million triangles in a pixel, 8192x8192 pixels");
  command.add_option("--assets", o.assets, "Folder of scenes named assets:...; by default ../shared/assets")
      ->type_name("DIR");
  add_input_options(command);
  command.add_option("--report", o.report, "Folder for an HTML page, its figures and the rows as JSON and CSV")
      ->type_name("DIR");
  command.add_option("--json", o.json, "The rows, or the comparison, as JSON; - is stdout")->type_name("FILE");
  command.add_option("--csv", o.csv, "The rows as CSV; - is stdout")->type_name("FILE");
  command.add_option("--from", o.from, "Make the report from rows that were kept, instead of measuring")
      ->type_name("ROWS.json");
  command
      .add_option("--compare", o.compare,
                  "Print what became slower or faster beyond noise; exit 1 if anything became "
                  "slower")
      ->expected(2)
      ->type_name("OLD.json NEW.json");
  command
      .add_option("--no-slower-than", o.no_slower_percent,
                  "With --compare: exit 0 only if, with 95 % confidence for all rows together, no frame is slower by "
                  "more than this; OLD may be a folder, from which the file of the same device is taken")
      ->check(non_negative_number())
      ->type_name("PERCENT");
  command.add_option("--min-change", o.min_change, "With --compare: smallest change to report; 0.05 is 5 %")
      ->check(non_negative_number())
      ->capture_default_str()
      ->type_name("X");
  command.add_option("--device", o.device, "As for render")->type_name("DEVICE");
  command.add_option("--timeout", o.timeout_s, "Longest wait for one frame")
      ->check(positive_number())
      ->capture_default_str()
      ->type_name("SECONDS");
  command.add_flag("--validate", o.validate, "Khronos validation layer; a message fails the configuration");
  command.add_flag("--quiet", o.quiet, "Only warnings and errors on stderr");
}

Expected<void> check_options(const BenchOptions& o) {
  const int modes = int(!o.compare.empty()) + int(!o.from.empty()) + int(!o.suite.empty());
  if (modes > 1) return fail(ErrorKind::usage, "--suite", "--suite, --compare and --from are different things to do");
  if (modes == 1 && !o.what.empty())
    return fail(ErrorKind::usage, o.what.front(), "--suite, --compare and --from take no suite file or scene beside");
  if (modes == 0 && o.what.empty())
    return fail(ErrorKind::usage, "SCENE", "nothing to measure; name suite files, scenes, or generated scenes");
  static const std::vector<std::string> suites = {"exactness", "stability", "stillness"};
  if (!o.suite.empty() && std::find(suites.begin(), suites.end(), o.suite) == suites.end())
    return fail(ErrorKind::usage, "--suite", "{}; suite files are named without --suite",
                unknown_name("built-in suite", o.suite, suites));
  if (o.count && o.suite != "exactness") return fail(ErrorKind::usage, "--count", "goes with --suite exactness");
  if (o.suite != "stability" && (!o.pictures.empty() || o.large))
    return fail(ErrorKind::usage, "--pictures", "--pictures and --large go with --suite stability");
  if (o.suite != "stability" && o.suite != "stillness" && !o.only.empty())
    return fail(ErrorKind::usage, "--only", "goes with --suite stability or stillness");
  if (o.suite == "stillness" &&
      !(o.lights + o.samples + o.times + o.frames + o.camera + o.sky + o.look + o.transparency + joined(o.effects))
           .empty())
    return fail(ErrorKind::usage, "--suite", "the places of stillness choose their own lights, times and cameras");
  if (o.suite == "stability" &&
      !(o.lights + o.sizes + o.samples + o.qualities + o.times + o.frames + o.camera + o.sky + o.look).empty())
    return fail(ErrorKind::usage, "--suite", "the scenes of stability choose their own lights, sizes and times");
  if (o.error && modes > 0)
    return fail(ErrorKind::usage, "--error", "takes scenes or suite files, not --suite, --compare or --from");
  if (o.resume && (!o.error || o.json.empty() || o.json == "-"))
    return fail(ErrorKind::usage, "--resume", "goes with --error and --json FILE, whose rows it goes on from");
  if (!o.error && o.views) return fail(ErrorKind::usage, "--views", "goes with --error");
  if (!o.error && o.suite != "stillness" && o.reference_spp)
    return fail(ErrorKind::usage, "--reference-spp", "goes with --error or --suite stillness");
  if (!o.error && (o.reference_s > 0 || o.hdr_flip != "auto"))
    return fail(ErrorKind::usage, "--reference-seconds", "--reference-seconds and --hdr-flip go with --error");
  if (o.error && (!o.settings.empty() || !o.qualities.empty() || !o.samples.empty()))
    return fail(ErrorKind::usage, "--error",
                "sweeps knobs, qualities and samples itself: --set, --quality and --samples do not go with it");
  if (o.no_slower_percent && o.compare.empty())
    return fail(ErrorKind::usage, "--no-slower-than", "goes with --compare OLD NEW");
  if (!o.report.empty() && (o.suite == "exactness" || o.suite == "stillness" || !o.compare.empty()))
    return fail(ErrorKind::usage, "--report", "reports are of measurements and of --suite stability");
  if (!o.from.empty() && o.report.empty() && o.json.empty() && o.csv.empty())
    return fail(ErrorKind::usage, "--from", "goes with --report, --json or --csv");
  return {};
}

Expected<void> take_stability_file(BenchOptions& o) {
  const auto found = std::find_if(o.what.begin(), o.what.end(),
                                  [](const std::string& text) { return is_suite(text) && names_built_in_suite(text); });
  if (found == o.what.end()) return {};
  if (o.what.size() > 1 || !o.suite.empty() || o.error)
    return fail(ErrorKind::usage, *found,
                "chooses scenes of --suite stability: it takes no other suite, scene or --error beside");
  o.stability_file = *found;
  o.suite = "stability";
  o.what.clear();
  return {};
}

Expected<std::vector<Suite>> suites_of(const BenchOptions& o) {
  std::vector<Suite> suites;
  Suite of_scenes;
  for (const std::string& text : o.what) {
    if (!is_suite(text)) {
      of_scenes.scenes.push_back(suite_scene(text, {}, assets_of(o)));
      continue;
    }
    auto suite = read_suite(text, assets_of(o));
    if (!suite) return std::unexpected(suite.error());
    suites.push_back(std::move(*suite));
  }
  if (!of_scenes.scenes.empty()) suites.push_back(std::move(of_scenes));
  for (Suite& suite : suites)
    if (auto put_over = put_options(o, suite); !put_over) return std::unexpected(put_over.error());
  // One budget for the run, not for each suite.
  if (o.budget_s)
    for (Suite& suite : suites) suite.budget_s = *o.budget_s / double(suites.size());
  return suites;
}

Expected<ExactnessOptions> exactness_of(const BenchOptions& o) {
  Suite suite;
  suite.scenes = scenes_with_lights(assets_of(o));
  if (auto put_over = put_options(o, suite); !put_over) return std::unexpected(put_over.error());
  ExactnessOptions options;
  if (o.count) options.fields = *o.count;
  if (o.seed) options.seed = *o.seed;
  if (!o.sizes.empty()) options.sizes = suite.sizes;
  if (!o.samples.empty()) options.samples = suite.samples;
  options.reference = suite.reference;
  options.scenes = suite.scenes;
  if (o.techniques.empty() && o.settings.empty()) return options;
  // Knobs that were named go to all techniques that were named, else to all there are.
  if (suite.techniques.empty())
    for (const std::string& name : technique_names()) suite.techniques.push_back({name, {}});
  for (SuiteTechnique& technique : suite.techniques) technique.set = suite.set;
  if (auto fine = configurations(suite); !fine) return std::unexpected(fine.error());
  options.techniques = suite.techniques;
  return options;
}

Expected<StillnessOptions> stillness_of(const BenchOptions& o) {
  StillnessOptions options{.places = stillness_places()};
  Suite suite;
  suite.scenes = {{.label = "any"}};
  if (auto put_over = put_options(o, suite); !put_over) return std::unexpected(put_over.error());
  if (!o.only.empty())
    std::erase_if(options.places, [&](const StillnessPlace& place) {
      return std::ranges::none_of(split(o.only, ','), [&](const auto& part) { return place.scene.contains(part); });
    });
  if (options.places.empty()) return fail(ErrorKind::usage, "--only", "stillness has no such scene");
  if (suite.techniques.size() > 1 || suite.sizes.size() > 1)
    return fail(ErrorKind::usage, "--suite", "stillness takes one technique and one size");
  if (!suite.techniques.empty()) options.technique = suite.techniques.front().name;
  if (!o.sizes.empty()) std::tie(options.width_px, options.height_px) = suite.sizes.front();
  if (!o.qualities.empty()) options.qualities = suite.qualities;
  if (o.reference_spp) options.spp = *o.reference_spp;
  for (const KnobSweep& sweep : suite.set) {
    if (sweep.values.size() != 1) return fail(ErrorKind::usage, "--set", "stillness takes one value of a knob");
    options.settings.push_back({sweep.pass, sweep.knob, sweep.values.front()});
  }
  if (auto fine = configurations(suite); !fine) return std::unexpected(fine.error());
  return options;
}

Expected<ErrorSweepOptions> error_sweep_of(const BenchOptions& o) {
  auto suites = suites_of(o);
  if (!suites) return std::unexpected(suites.error());
  if (suites->size() != 1) return fail(ErrorKind::usage, "--error", "takes one suite file, or scenes alone");
  ErrorSweepOptions options{.base = std::move(suites->front()), .truth = {.seconds = o.reference_s}};
  // Frames of a sweep are many: nothing is learned from a median that is good to a percent where errors span decades.
  SamplingRules& sampling = options.base.sampling;
  if (!o.precision) sampling.precision = std::max(sampling.precision, 0.03);
  if (!o.max_runs) sampling.max_runs = std::min(sampling.max_runs, 24);
  // Twofold differences are found in eight rounds (docs/understanding/deciding.md), and most of them in six.
  if (!o.min_runs) sampling.min_runs = std::max(sampling.min_runs, 6);
  if (o.reference_spp) options.truth.spp = *o.reference_spp;
  if (o.hdr_flip != "auto") {
    const auto range = parse_exposure_range(o.hdr_flip);
    if (!range) return std::unexpected(Error{ErrorKind::usage, range.error().message, "--hdr-flip"});
    options.exposures = *range;
  }
  return options;
}

RunSettings bench_settings(const BenchOptions& o) {
  RunSettings settings;
  settings.device = o.device;
  settings.validate = o.validate;
  settings.timeout_s = o.timeout_s;
  return settings;
}

}  // namespace candela::cli
