#include "metrics/compare.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/log.h"
#include "cli/command.h"
#include "image/io.h"
#include "metrics/heatmap.h"
#include "metrics/limits.h"
#include "render/frame_names.h"

namespace candela::cli {
namespace {

struct CompareCommand {
  std::string a, b, heatmap;
  std::vector<std::string> limits;
  bool json = false, quiet = false;
};

std::string comparison_table(const Comparison& comparison, const std::vector<LimitVerdict>& verdicts) {
  std::vector<std::vector<std::string>> rows = {{"METRIC", "VALUE", "LIMIT"}};
  for (const auto& [metric, value] : comparison.metrics) {
    std::string limit;
    for (const LimitVerdict& v : verdicts)
      if (v.limit.metric == metric)
        limit += fmt::format("{}{} {}", limit.empty() ? "" : ", ", v.limit.value, v.pass ? "holds" : "BROKEN");
    rows.push_back({metric, fmt::format("{:.6g}", value), limit});
  }
  return table_text(rows);
}

Expected<void> write_heatmap(const std::string& file, const Comparison& comparison) {
  if (file.empty() || comparison.flip_map.empty()) return {};
  return write_png(file, heatmap(comparison.flip_map, comparison.width, comparison.height));
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
  const auto comparison = compare_files(o.a, o.b);
  if (!comparison) return std::unexpected(comparison.error());
  const std::vector<LimitVerdict> verdicts = judge_limits(*comparison, limits);
  if (!comparison->refusal.empty()) log::error("{}", comparison->refusal);
  for (const LimitVerdict& v : verdicts)
    if (!v.pass && comparison->refusal.empty())
      log::error("{} is {:.6g}, the limit is {}", v.limit.metric, v.measured, v.limit.value);
  auto printed =
      o.json ? print(comparison_json(*comparison, verdicts) + "\n") : print(comparison_table(*comparison, verdicts));
  if (printed) printed = write_heatmap(o.heatmap, *comparison);
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
                   "Exit 1 beyond it: max, mae, rmse, relmse, psnr, ssim, flip or differing; may be given again")
      ->allow_extra_args(false)
      ->type_name("METRIC=VALUE");
  command->add_option("--heatmap", o->heatmap, "FLIP of every pixel as colours")->type_name("FILE.png");
  command->add_flag("--quiet", o->quiet, "Only warnings and errors on stderr");
  command->add_flag("--json", o->json, "As JSON");
  command->callback([o, &action] { action = [o] { return run_compare(*o); }; });
}

}  // namespace candela::cli
