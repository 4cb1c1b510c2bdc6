#include "metrics/compare.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/files.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/input_options.h"
#include "cli/report_files.h"
#include "image/io.h"
#include "image/png_write.h"
#include "metrics/heatmap.h"
#include "metrics/limits.h"
#include "render/frame_names.h"
#include "report/compare_report.h"

namespace candela::cli {
namespace {

struct CompareCommand {
  std::string a, b, heatmap, html, hdr_flip = "auto";
  std::vector<std::string> limits, regions;
  bool allow_nonfinite = false, json = false, quiet = false;
};

std::string place_text(const Place& place) {
  return place.channel.empty() ? "" : fmt::format("pixel ({}, {}), {}", place.x, place.y, place.channel);
}

constexpr const char* needs_colour = "there is no flip of images without colour, the channels R, G and B, or Y";

std::string broken_limit(const LimitVerdict& v) {
  const std::string where = v.region.empty() ? "" : " of region " + v.region;
  if (!std::isnan(v.measured))
    return fmt::format("{}{} is {:.6g}, the limit is {}", v.limit.metric, where, v.measured, v.limit.value);
  return fmt::format("{}{} has a limit and was not measured: {}", v.limit.metric, where,
                     v.limit.metric == "hdr-flip"
                         ? "it is of scene-linear colour (EXR, HDR), and not with --hdr-flip off"
                         : "it is of the channels R, G and B, or Y, and there are none");
}

using Rows = std::vector<std::vector<std::string>>;

void add_metrics(Rows& rows, const std::string& where, const std::map<std::string, double>& metrics,
                 const Place& max_at, const std::optional<NoiseFloor>& noise,
                 const std::vector<LimitVerdict>& verdicts) {
  for (const auto& [metric, value] : metrics) {
    std::string limit, note;
    for (const LimitVerdict& v : verdicts)
      if (v.limit.metric == metric && v.region == where)
        limit += fmt::format("{}{} {}", limit.empty() ? "" : ", ", v.limit.value, v.pass ? "holds" : "BROKEN");
    if (metric == "max") note = place_text(max_at);
    if (noise && (metric == "rmse" || metric == "relmse")) {
      const double floor = metric == "rmse" ? noise->rmse : noise->relmse;
      note = fmt::format("{} the reference's noise, {:.4g}", value <= floor ? "below" : "above", floor);
    }
    rows.push_back({metric, fmt::format("{:.6g}", value), limit, note});
  }
}

std::string comparison_table(const Comparison& c, const std::vector<LimitVerdict>& verdicts) {
  std::string text = fmt::format("non-finite pixels: {} in the reference, {} in the test image\n",
                                 c.nonfinite_reference, c.nonfinite_test);
  if (!c.refusal.empty()) return text;
  Rows rows = {{"METRIC", "VALUE", "LIMIT", "NOTE"}};
  add_metrics(rows, "", c.metrics, c.max_at, c.noise, verdicts);
  text += table_text(rows);
  text += fmt::format("relmse: epsilon {}; relmse-trimmed: without the {} % of the pixels where it is largest\n",
                      relmse_epsilon, trimmed_fraction * 100);
  if (c.exposures)
    text += fmt::format("hdr-flip: {} exposures from {:.6g} to {:.6g} stops, ACES curve\n", c.exposures->count,
                        c.exposures->start, c.exposures->stop);
  for (const RegionResult& region : c.regions) {
    rows = {{"REGION " + region.region.text(), "VALUE", "LIMIT", "NOTE"}};
    add_metrics(rows, region.region.text(), region.metrics, region.max_at, region.noise, verdicts);
    text += "\n" + table_text(rows);
  }
  if (!c.layers.empty()) {
    rows = {{"LAYER", "METRIC", "VALUE", "NOTE"}};
    for (const LayerResult& layer : c.layers)
      for (const auto& [metric, value] : layer.metrics)
        rows.push_back({layer.name, metric, fmt::format("{:.6g}", value),
                        metric == "max" || metric.ends_with("-max") ? place_text(layer.max_at) : ""});
    text += "\n" + table_text(rows);
  }
  return text;
}

Expected<CompareOptions> options_of(const CompareCommand& o) {
  CompareOptions options{.layers = true};
  if (o.hdr_flip == "auto") {
    options.hdr_flip = HdrFlipChoice{};
  } else if (o.hdr_flip != "off") {
    const auto range = parse_exposure_range(o.hdr_flip);
    if (!range) return std::unexpected(range.error());
    options.hdr_flip = HdrFlipChoice{*range};
  }
  for (const std::string& text : o.regions) {
    const auto region = parse_region(text);
    if (!region) return std::unexpected(region.error());
    options.regions.push_back(*region);
  }
  return options;
}

Expected<void> write_heatmap(const std::string& file, const Comparison& comparison) {
  if (file.empty()) return {};
  if (comparison.flip_map.empty()) {
    log::warning("{} is not written: {}", file,
                 comparison.refusal.empty() ? needs_colour : "the images cannot be compared");
    return {};
  }
  return write_png(file, heatmap(comparison.flip_map, comparison.width, comparison.height));
}

// As the display shows them: scene-linear colour through its encoding, clamped.
Expected<std::vector<Plane>> shown_planes(const std::string& file) {
  const auto image = read_image(file);
  if (!image) return std::unexpected(image.error());
  auto planes = display_planes(*image, encoding_of(file));
  if (planes.size() != 3) return fail(ErrorKind::input, file, "has no colour channels to show");
  return planes;
}

Expected<void> write_html(const CompareCommand& o, const Comparison& c, const std::vector<LimitVerdict>& verdicts) {
  if (o.html.empty()) return {};
  if (!c.refusal.empty()) {
    log::warning("{} is not written: the images cannot be compared", o.html);
    return {};
  }
  CompareReport report{.reference = o.a, .test = o.b, .program = this_program(), .metrics = c.metrics};
  for (const LimitVerdict& v : verdicts)
    report.limits.push_back(
        {v.limit.metric + (v.region.empty() ? "" : " of " + v.region), v.measured, v.limit.value, v.pass});
  const auto reference = shown_planes(o.a), test = shown_planes(o.b);
  if (!reference) return std::unexpected(reference.error());
  if (!test) return std::unexpected(test.error());
  auto pictures = viewed_pictures(*reference, *test, c.flip_map, c.width, c.height, o.html);
  if (!pictures) return std::unexpected(pictures.error());
  report.pictures = std::move(*pictures);
  report.pictures.first = "reference", report.pictures.second = "test";
  return write_file_atomically(o.html, compare_html(report));
}

// Equal values that are not finite are no difference, but both images are broken.
void refuse_nonfinite(Comparison& comparison) {
  if (comparison.nonfinite_in_both == 0 || !comparison.refusal.empty()) return;
  comparison.refusal = fmt::format(
      "{} values are not finite in both images alike, which no metric can judge; --allow-nonfinite takes them for "
      "equal",
      comparison.nonfinite_in_both);
  comparison.metrics.clear();
  comparison.flip_map.clear();
  comparison.layers.clear(), comparison.regions.clear();
}

Expected<int> run_compare(const CompareCommand& o) {
  if (o.quiet) log::set_level(log::Level::warning);
  if (o.a.empty() || o.b.empty())
    return fail(ErrorKind::usage, "A B", "two images are needed: the reference and the one under test");
  std::vector<Limit> limits;
  for (const std::string& text : o.limits) {
    const auto limit = parse_limit(text);
    if (!limit) return std::unexpected(limit.error());
    limits.push_back(*limit);
  }
  if (!o.heatmap.empty()) {
    if (const auto format = output_format(o.heatmap); !format || *format != OutputFormat::png)
      return fail(ErrorKind::usage, "--heatmap", "'{}' does not end in .png", o.heatmap);
    if (auto ready = prepare_output(o.heatmap); !ready) return std::unexpected(ready.error());
  }
  if (!o.html.empty())
    if (auto ready = prepare_output(o.html); !ready) return std::unexpected(ready.error());
  const auto options = options_of(o);
  if (!options) return std::unexpected(options.error());
  auto comparison = compare_files(o.a, o.b, *options);
  if (!comparison) return std::unexpected(comparison.error());
  if (!o.allow_nonfinite) refuse_nonfinite(*comparison);
  const std::vector<LimitVerdict> verdicts = judge_limits(*comparison, limits);
  if (!comparison->refusal.empty()) log::error("{}", comparison->refusal);
  for (const std::string& note : comparison->notes) log::info("{}", note);
  for (const auto& [layers, file] :
       {std::pair(&comparison->only_in_reference, &o.a), std::pair(&comparison->only_in_test, &o.b)})
    if (!layers->empty()) log::error("only {} has {}", *file, joined(*layers));
  for (const SharedLevels& levels : comparison->shared_levels)
    log::warning("{} has {} levels in {} and {} in {}: the first {}, {} ranks, are compared", levels.layer,
                 levels.reference, o.a, levels.test, o.b, levels.shared(), 2 * levels.shared());
  for (const LimitVerdict& v : verdicts)
    if (!v.pass && comparison->refusal.empty()) log::error("{}", broken_limit(v));
  auto printed =
      o.json ? print(comparison_json(*comparison, verdicts) + "\n") : print(comparison_table(*comparison, verdicts));
  if (printed) printed = write_heatmap(o.heatmap, *comparison);
  if (printed) printed = write_html(o, *comparison, verdicts);
  if (!printed) return std::unexpected(printed.error());
  return passes(*comparison, verdicts) ? 0 : int(ErrorKind::comparison);
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  auto o = std::make_shared<CompareCommand>();
  CLI::App* command = app.add_subcommand("compare", "Measure how far image B is from image A");
  command->add_option("a", o->a, "Reference")->type_name("A");
  command->add_option("b", o->b, "Image under test")->type_name("B");
  command
      ->add_option("--limit", o->limits,
                   "Exit 1 if a metric is worse than this, in the whole image or in a region: max, mae, rmse, relmse, "
                   "relmse-trimmed, p50, p90, p99, p99.9, psnr, ssim, flip, hdr-flip or differing; may be given again")
      ->allow_extra_args(false)
      ->type_name("METRIC=VALUE");
  command
      ->add_option("--region", o->regions,
                   "Measure this part too, in pixels from the upper left corner; may be given again")
      ->allow_extra_args(false)
      ->type_name("X,Y,W,H");
  command
      ->add_option("--hdr-flip", o->hdr_flip,
                   "Exposures of hdr-flip in stops; auto takes them from the reference (give them to compare several "
                   "results); off")
      ->capture_default_str()
      ->type_name("auto|off|START,STOP,COUNT");
  command->add_option("--heatmap", o->heatmap, "FLIP of every pixel as colours")->type_name("FILE.png");
  command->add_option("--html", o->html, "A page with both pictures, to slide, blink and zoom, and what was measured")
      ->type_name("FILE");
  add_decode_budget(*command);
  command->add_flag(
      "--allow-nonfinite", o->allow_nonfinite,
      "NaN and infinity at the same place in both images are not a difference; otherwise they are exit 1");
  command->add_flag("--quiet", o->quiet, "Only warnings and errors on stderr");
  command->add_flag("--json", o->json, "As JSON");
  command->callback([o, &action] { action = [o] { return run_compare(*o); }; });
}

}  // namespace candela::cli
