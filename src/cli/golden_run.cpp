#include "cli/golden_run.h"

#include "base/log.h"
#include "bench/scene_store.h"
#include "cli/scene_notes.h"
#include "metrics/heatmap.h"
#include "render/outputs.h"
#include "session/timings.h"
#include "testscenes/make_scene.h"

namespace candela::cli {
namespace fs = std::filesystem;

Expected<GoldenDevice> render_golden(const GoldenManifest& golden, const RunSettings& settings, bool allow_blank,
                                     const fs::path& picture) {
  const WantedOutputs wanted{
      .linear = golden.exr, .display = !golden.exr, .display_bits = golden.job.png_bits, .files = true};
  Job job = golden.job;
  SceneStore made;
  for (std::string* file : {&job.scene, &job.sky}) {
    if (!file->starts_with(made_prefix)) continue;
    auto scene = made.generated(file->substr(made_prefix.size()), 1, 0);
    if (!scene) return std::unexpected(scene.error());
    *file = file == &job.sky ? sky_beside(*scene).string() : *scene;
  }
  auto session = Session::open(job, wanted, settings);
  if (!session) return std::unexpected(session.error());
  auto frame = (*session)->render(golden.time_s);
  if (!frame) return std::unexpected(frame.error());
  if (const std::string blank = blank_warning(*frame, job, (*session)->scene()); !blank.empty() && !allow_blank)
    return fail(ErrorKind::input, golden.name, "{}; an empty picture guards nothing (--allow-blank keeps it anyway)",
                blank);
  if (auto written = write_outputs(*frame, job, **session, golden.frame, golden.rate, {picture}); !written)
    return std::unexpected(written.error());
  const gpu::DeviceInfo& device = (*session)->device().info();
  return GoldenDevice{device.device_class, device.name, device.driver};
}

std::string picture_digest(const FloatImage& image) {
  std::string digests = fmt::format("{}x{}", image.width, image.height);
  for (const Channel& channel : image.channels)
    digests += "\n" + channel.name + " " +
               (channel.type == ChannelType::uint32 ? hash128(std::as_bytes(std::span(channel.u)))
                                                    : hash128(std::as_bytes(std::span(channel.f))))
                   .hex();
  return hash128(digests).hex();
}

namespace {

// What a person needs to judge a golden that is not simply equal. A picture that cannot be written is only a warning.
void write_pictures(const GoldenManifest& golden, const FloatImage* expected, const FloatImage& actual,
                    const fs::path& folder, GoldenOutcome& outcome) {
  const Encoding encoding = golden.exr ? Encoding::linear : Encoding::display;
  const auto write = [&](const char* suffix, const DisplayImage& image) {
    const fs::path path = folder / (golden.name + suffix);
    if (auto written = write_png(path, image); !written) {
      log::warning("{}", written.error().text());
      return fs::path();
    }
    return path;
  };
  const auto shown = display_planes(actual, encoding);
  if (shown.size() == 3) outcome.actual_png = write("-new.png", as_display(shown, actual.width, actual.height));
  if (!expected) return;
  const auto kept = display_planes(*expected, encoding);
  if (kept.size() == 3) outcome.golden_png = write("-golden.png", as_display(kept, expected->width, expected->height));
  const Comparison& comparison = outcome.gate.comparison;
  if (comparison.flip_map.empty() || kept.size() != 3 || shown.size() != 3) return;
  outcome.heat_map = write("-heat.png", heatmap(comparison.flip_map, comparison.width, comparison.height));
  auto pictures = viewed_pictures(kept, shown, comparison.flip_map, comparison.width, comparison.height, golden.name);
  if (pictures)
    outcome.pictures = std::move(*pictures);
  else
    log::warning("{}", pictures.error().text());
}

void judge(const GoldenManifest& golden, bool exact, GoldenOutcome& outcome) {
  const auto fail_with = [&](std::string message) { outcome.message = std::move(message); };
  const std::string& device_class = outcome.device.device_class;
  const auto limits = parse_gate_limits(golden.text, device_class, (golden.folder / "golden.json").string());
  if (!limits) return fail_with(limits.error().text());
  const auto actual = read_image(outcome.actual);
  if (!actual) return fail_with(actual.error().text());
  outcome.digest = picture_digest(*actual);
  const GoldenDevice& made = golden.made_for(device_class);
  outcome.same_device = made == outcome.device;
  const auto accepted = golden.accepted.find(device_class);
  if (accepted != golden.accepted.end())
    if (std::ranges::find(accepted->second, outcome.digest) != accepted->second.end()) {
      outcome.kind = GoldenOutcome::Kind::passed;
      outcome.gate.level = GateLevel::identical;
      outcome.message = "an accepted picture of " + device_class;
      return;
    }
  std::error_code failed;
  const fs::path kept = golden.picture_for(device_class);
  if (!fs::exists(kept, failed)) {
    outcome.missing = true;
    write_pictures(golden, nullptr, *actual, outcome.actual.parent_path(), outcome);
    return fail_with(
        fmt::format("{} is missing; look at the new picture, then `candela golden update`", kept.filename().string()));
  }
  const auto expected = read_image(kept);
  if (!expected) return fail_with(expected.error().text());
  outcome.limits = *limits;
  outcome.gate = judge_golden(*expected, *actual, *limits, golden.exr ? Encoding::linear : Encoding::display);
  outcome.message = outcome.gate.message;
  const bool tolerated = outcome.gate.level != GateLevel::identical && outcome.gate.passed();
  const auto and_message = [&] { return outcome.message.empty() ? "" : ": " + outcome.message; };
  if (tolerated && (exact || outcome.same_device)) {
    outcome.message = fmt::format("not the same pixels, {}; its limits would call it {}{}",
                                  outcome.same_device ? "on the device that the golden was made on"
                                                      : "and --exact asks "
                                                        "for them",
                                  gate_level_name(outcome.gate.level), and_message());
    outcome.gate.level = GateLevel::failed;
  } else if (tolerated) {
    outcome.message =
        fmt::format("by its limits, since it was made on {} ({}){}", made.device, made.driver, and_message());
  }
  if (outcome.gate.passed()) outcome.kind = GoldenOutcome::Kind::passed;
  if (outcome.gate.level >= GateLevel::warned || outcome.gate.blank)
    write_pictures(golden, &*expected, *actual, outcome.actual.parent_path(), outcome);
}

}  // namespace

GoldenOutcome check_golden(const GoldenManifest& golden, const GoldenCheck& how, const fs::path& folder) {
  GoldenOutcome outcome;
  if (golden.missing_assets) {
    outcome.kind = GoldenOutcome::Kind::skipped;
    outcome.message = "the assets folder is not here";
    return outcome;
  }
  const double start_us = process_clock_us();
  const fs::path actual = folder / (golden.name + golden.ending());
  const auto picture = render_golden(golden, how.settings, how.allow_blank, actual);
  if (picture) {
    outcome.actual = actual;
    outcome.device = *picture;
    judge(golden, how.exact, outcome);
  } else {
    outcome.message = picture.error().text();
  }
  outcome.seconds = (process_clock_us() - start_us) * 1e-6;
  return outcome;
}

}  // namespace candela::cli
