#include "cli/scene_notes.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/log.h"
#include "base/text.h"
#include "gltf/losses.h"
#include "math/bounds.h"
#include "passes/post/pack.h"
#include "plan/posed_scene.h"
#include "render/metering.h"
#include "render/picture_tones.h"
#include "scene/neutral_light.h"

namespace candela::cli {
namespace {

const char* support_name(Support support) {
  return support == Support::supported ? "supported" : support == Support::approximated ? "approximated" : "ignored";
}

// Lists of numbers, "26-53, 55", go whole: signs and blanks too.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](unsigned char c) { return c < 128 && std::isalpha(c) == 0; });
  return text;
}

// Keeps a frame's warning, and says it where none before differs from it in its numbers alone; --verbose says all.
void warn_once(const std::string& text, std::vector<std::string>& warnings) {
  const std::string key = without_numbers(text);
  const bool before =
      std::ranges::any_of(warnings, [&](const std::string& said) { return without_numbers(said) == key; });
  log::write(before ? log::Level::debug : log::Level::warning, text);
  warnings.push_back(text);
}

}  // namespace

Strictness strictness(std::string_view text) {
  return text.empty() ? Strictness::none : text == "loss" ? Strictness::loss : Strictness::all;
}

void SaidOnce::note(const std::string& text) {
  constexpr size_t most = 1000;
  if (said_.size() < most && said_.insert(without_numbers(text)).second) log::info("{}", text);
}

namespace {

// The validator's name for a fault, in brackets at the end of a warning; empty where there is none.
std::string_view code_of(std::string_view warning) {
  const size_t open = warning.rfind('(');
  if (open == std::string_view::npos || !warning.ends_with(')')) return {};
  const std::string_view code = warning.substr(open + 1, warning.size() - open - 2);
  const bool is_code = code.size() > 3 && std::ranges::all_of(code, [](char c) {
                         return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
                       });
  return is_code ? code : std::string_view();
}

// A line a code: the first of it, and how many there are. --verbose says all.
void say_by_code(const std::vector<std::string>& warnings) {
  std::map<std::string_view, size_t> counts;
  for (const std::string& warning : warnings) ++counts[code_of(warning)];
  std::set<std::string_view> said;
  for (const std::string& warning : warnings) {
    const std::string_view code = code_of(warning);
    if (code.empty() || counts[code] == 1)
      log::warning("{}", warning);
    else if (!said.insert(code).second)
      log::debug("{}", warning);
    else
      log::warning("{}, and {} more (--verbose)", warning, counts[code] - 1);
  }
}

std::string first_loss(const std::vector<std::string>& warnings) {
  const auto found = std::ranges::find_if(warnings, tells_of_loss);
  return found == warnings.end() ? std::string() : *found;
}

std::unexpected<Error> refused(const Scene& scene, Strictness strict, const std::string& why) {
  return fail(ErrorKind::input, scene.path, "--strict{} refuses the scene: {}",
              strict == Strictness::loss ? "=loss" : "", why);
}

}  // namespace

Expected<void> note_scene(const Scene& scene, Strictness strict) {
  std::string first;
  say_by_code(scene.warnings);
  if (!scene.warnings.empty()) first = scene.warnings.front();
  for (const ExtensionUse& use : scene.extensions) {
    if (use.support == Support::supported) {
      log::debug("extension {}: supported", use.name);
      continue;
    }
    const std::string line = fmt::format("extension {} is {}: {}{}", use.name, support_name(use.support),
                                         use.consequence, use.users.empty() ? "" : " (" + joined(use.users) + ")");
    if (use.support == Support::ignored) {
      log::warning("{}", line);
      if (first.empty()) first = line;
    } else {
      log::info("{}", line);
    }
  }
  if (!scene.variants.empty() && scene.variant < 0)
    log::info("the file has variants of its materials, of which --variant draws one: {}", joined(scene.variants));
  if (strict == Strictness::loss) first = first_loss(scene.warnings);
  if (strict != Strictness::none && !first.empty()) return refused(scene, strict, first);
  return {};
}

Expected<void> note_frame(const FrameResult& frame, const Scene& scene, Strictness strict,
                          std::vector<std::string>& warnings) {
  for (const std::string& warning : frame.warnings) {
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warn_once(warning, warnings);
  }
  if (strict == Strictness::none || frame.warnings.empty()) return {};
  const std::string first = strict == Strictness::loss ? first_loss(frame.warnings) : frame.warnings.front();
  if (!first.empty()) return refused(scene, strict, first);
  return {};
}

nlohmann::ordered_json extensions_json(const Scene& scene) {
  auto list = nlohmann::ordered_json::array();
  for (const ExtensionUse& use : scene.extensions)
    list.push_back({{"name", use.name},
                    {"required", use.required},
                    {"support", support_name(use.support)},
                    {"consequence", use.consequence},
                    {"users", use.users}});
  return list;
}

namespace {

// Alpha of every pixel is 0; nullopt where the frame has no alpha to tell by.
std::optional<bool> is_transparent(const FrameResult& frame) {
  for (const FrameOutput& output : frame.outputs) {
    if (output.layer == "beauty" && output.counts >= 0 && frame.request.shows_through)
      return frame.counts.at(size_t(output.counts)).covered == 0;
    if (output.packing != Packing::texels || (output.layer == "display" && !frame.request.display_alpha())) continue;
    size_t pixel = 0, offset = 0, length = 0;  // bytes of a pixel, of its alpha, and the alpha's length
    if (output.layer == "beauty" && output.format == VK_FORMAT_R32G32B32A32_SFLOAT)
      pixel = 16, offset = 12, length = 4;
    else if (output.layer == "beauty" && output.format == VK_FORMAT_R16G16B16A16_SFLOAT)
      pixel = 8, offset = 6, length = 2;
    else if (output.layer == "display" && output.format == VK_FORMAT_R8G8B8A8_UNORM)
      pixel = 4, offset = 3, length = 1;
    else if (output.layer == "display" && output.format == VK_FORMAT_R16G16B16A16_UNORM)
      pixel = 8, offset = 6, length = 2;
    else
      continue;
    const auto found = frame.readbacks.find(output.resource);
    if (found == frame.readbacks.end()) continue;
    const std::span<const std::byte> bytes = found->second->bytes();
    const size_t count = size_t(frame.width_px) * size_t(frame.height_px);
    for (size_t i = 0; i < count && (i + 1) * pixel <= bytes.size(); ++i)
      for (size_t b = 0; b < length; ++b)
        if (bytes[i * pixel + offset + b] != std::byte{0}) return false;
    return true;
  }
  return std::nullopt;
}

// Nothing's bounds reach into the view. Sky and background cover what no surface does, so alpha does not tell.
bool nothing_in_view(const FrameResult& frame, const Job& job, const Scene& scene) {
  if (frame.sees_items) return false;
  const auto posed = pose_scene(scene, job, frame.time_s);
  if (!posed) return false;
  return !any_in_view(posed->data.items, frame.view);
}

}  // namespace

namespace {

// What may bring something into view, of what was given.
std::string blank_advice(const FrameResult& frame, const Job& job, const Scene& scene) {
  std::vector<std::string> ways;
  if (job.camera.eye)
    ways.emplace_back("--fit instead of --eye and --target");
  else if (!job.camera.camera.empty())
    ways.emplace_back("--fit, or no --camera: all that is drawn is then framed");
  else if (frame.view.name != "framed bounds")
    ways.emplace_back("--fit: all that is drawn is then framed");
  if (!scene.animations.empty() && job.animation != "none") {
    ways.emplace_back("another --frame");
    ways.emplace_back("--animation none");
  }
  if (ways.empty()) return "candela facts lists what the scene holds";
  std::string text = "try ";
  for (size_t i = 0; i < ways.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 < ways.size() ? ", " : " or ", ways[i]);
  return text;
}

std::string black_advice(const Job& job, const Scene& scene) {
  if (job.sky == "none") return "--sky none is no light but the scene's own: leave it out, or name a sky";
  if (!has_light(scene)) return "nothing lights the scene: --sky studio does";
  return "--exposure auto, or --sky studio beside the scene's lights";
}

}  // namespace

std::string blank_warning(const FrameResult& frame, const Job& job, const Scene& scene) {
  const bool alpha_tells = frame.request.shows_through;
  const std::optional<bool> transparent = alpha_tells ? is_transparent(frame) : std::nullopt;
  if (transparent ? *transparent : nothing_in_view(frame, job, scene)) {
    if (scene.meshes.empty()) return "the frame is blank: the scene has no mesh";
    return fmt::format("the frame is blank: nothing lies before {}; {}",
                       frame.view.name.empty() ? "the camera" : frame.view.name, blank_advice(frame, job, scene));
  }
  if (const auto tones = tones_of(frame, job); tones && tones->is_black)
    return fmt::format("the frame is blank: every pixel is black; {}", black_advice(job, scene));
  return {};
}

std::string tone_note(const FrameResult& frame, const Job& job) {
  const auto tones = tones_of(frame, job);
  if (!tones || tones->is_black) return {};
  constexpr double most_clipped = 0.2, least_seen = 0.01;
  const bool clipped = tones->clipped > most_clipped;
  if (!clipped && tones->seen >= least_seen) return {};
  std::string mend = "--exposure auto";
  if (const auto ev = metered_ev(job)) mend += fmt::format(", which is --exposure {:.1f} here", *ev);
  if (clipped) return fmt::format("{:.0f} % of the picture is clipped to white: try {}", 100 * tones->clipped, mend);
  return fmt::format("{:.1f} % of the picture is above black: try {}", 100 * tones->seen, mend);
}

void note_tones(const FrameResult& frame, const Job& job, SaidOnce& said) {
  if (said.tones) return;
  const std::string note = tone_note(frame, job);
  if (note.empty()) return;
  log::warning("{}", note);
  said.tones = true;
}

Expected<void> note_blank(const FrameResult& frame, const Job& job, const Scene& scene, const BlankRules& rules,
                          std::vector<std::string>& warnings) {
  const std::string blank = blank_warning(frame, job, scene);
  if (blank.empty()) return {};
  if (rules.strict && !rules.allowed)
    return fail(ErrorKind::input, scene.path, "--strict refuses the frame: {} (--allow-blank lets it pass)", blank);
  const std::string text = rules.frame ? fmt::format("frame {}: {}", *rules.frame, blank) : blank;
  constexpr size_t most = 100;  // of a film that is blank throughout
  if (warnings.size() < most) warn_once(text, warnings);
  return {};
}

}  // namespace candela::cli
