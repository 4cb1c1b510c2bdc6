#include "cli/scene_notes.h"

#include <nlohmann/json.hpp>

#include "base/log.h"
#include "base/text.h"
#include "frame/posed_scene.h"
#include "math/bounds.h"

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

void SaidOnce::note(const std::string& text) {
  constexpr size_t most = 1000;
  if (said_.size() < most && said_.insert(without_numbers(text)).second) log::info("{}", text);
}

Expected<void> note_scene(const Scene& scene, bool strict) {
  std::string first;
  for (const std::string& warning : scene.warnings) {
    log::warning("{}", warning);
    if (first.empty()) first = warning;
  }
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
  if (strict && !first.empty()) return fail(ErrorKind::input, scene.path, "--strict refuses the scene: {}", first);
  return {};
}

Expected<void> note_frame(const FrameResult& frame, const Scene& scene, bool strict,
                          std::vector<std::string>& warnings) {
  for (const std::string& warning : frame.warnings) {
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warn_once(warning, warnings);
  }
  if (strict && !frame.warnings.empty())
    return fail(ErrorKind::input, scene.path, "--strict refuses the scene: {}", frame.warnings.front());
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
  for (const OutputImage& output : frame.outputs) {
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
  const auto posed = pose_scene(scene, job, frame.time_s);
  if (!posed) return false;
  const FrustumPlanes planes = frustum_planes(frame.view.clip_from_relative);
  return std::none_of(posed->data.items.begin(), posed->data.items.end(), [&](const DrawItem& item) {
    const glm::dvec3 centre(item.bounds_relative.centre()), extent(item.bounds_relative.extent());
    return std::all_of(planes.begin(), planes.end(), [&](const glm::dvec4& plane) {
      const glm::dvec3 normal(plane);
      return !(glm::dot(normal, centre) + plane.w + glm::dot(glm::abs(normal), extent) < 0);
    });
  });
}

}  // namespace

std::string blank_warning(const FrameResult& frame, const Job& job, const Scene& scene) {
  const bool alpha_tells = frame.request.shows_through;
  const std::optional<bool> transparent = alpha_tells ? is_transparent(frame) : std::nullopt;
  if (!transparent.value_or(nothing_in_view(frame, job, scene))) return {};
  if (scene.meshes.empty()) return "the frame is blank: the scene has no mesh";
  return fmt::format(
      "the frame is blank: nothing lies before {}; try no --camera (the bounds are then framed), another --frame or "
      "--animation none",
      frame.view.name.empty() ? "the camera" : frame.view.name);
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
