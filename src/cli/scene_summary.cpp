#include "cli/scene_summary.h"

#include <glm/gtc/constants.hpp>
#include <nlohmann/json.hpp>

#include "base/names.h"
#include "base/text.h"
#include "math/bounds.h"
#include "scene/frame_data.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* type_name(LightType type) {
  return type == LightType::directional ? "directional" : type == LightType::point ? "point" : "spot";
}

// Nodes of the shown scene that carry each light or camera.
std::vector<int> uses(const Scene& scene, size_t count, int Node::*member) {
  std::vector<int> uses(count);
  for (const int n : scene.order)
    if (const int index = scene.nodes[size_t(n)].*member; index >= 0) ++uses[size_t(index)];
  return uses;
}

std::vector<ClipFacts> clips_of(const Scene& scene, const Job& job) {
  auto clips = clip_facts(scene, job.animation);
  return clips ? std::move(*clips) : std::vector<ClipFacts>{};
}

std::string named(size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{}", index) : fmt::format("{} {}", index, quoted_name(name));
}

std::string counted(uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

// The first few lines of a kind, and how many more there are.
class Lines {
 public:
  Lines(std::string& text, std::string_view title) : text_(text), title_(title) {}
  void add(const std::string& line) {
    constexpr size_t most = 24;
    if (++count_ <= most) text_ += fmt::format("{:<11} {}\n", count_ == 1 ? title_ : "", line);
  }
  void end(std::string_view option) {
    constexpr size_t most = 24;
    if (count_ > most) text_ += fmt::format("{:<11} and {} more ({})\n", "", count_ - most, option);
  }

 private:
  std::string& text_;
  std::string_view title_;
  size_t count_ = 0;
};

std::string clip_line(const std::vector<ClipFacts>& clips, size_t i) {
  const ClipFacts& clip = clips[i];
  std::string line =
      fmt::format("{}, {:.3f} s, {}, {}", named(i, clip.name), clip.end_s,
                  counted(uint64_t(clip.targets), "target", "targets"), clip.plays ? "plays" : "does not play");
  if (clip.conflicts > 0)
    line += fmt::format("; {} {} by {} too", clip.conflicts,
                        clip.conflicts == 1 ? "of its channels is driven" : "of its channels are driven",
                        named(size_t(clip.with), clips[size_t(clip.with)].name));
  return line;
}

std::string camera_line(const Camera& camera, size_t i) {
  if (!camera.perspective)
    return fmt::format("{}, orthographic, {:.4g} x {:.4g} m", named(i, camera.name), 2 * std::abs(camera.xmag),
                       2 * std::abs(camera.ymag));
  return fmt::format("{}, perspective, {:.4g} degrees high", named(i, camera.name), glm::degrees(camera.yfov_rad));
}

std::string light_line(const Light& light, size_t i, int used) {
  std::string line = fmt::format("{}, {}, {:.4g} {}", named(i, light.name), type_name(light.type), light.intensity,
                                 light.type == LightType::directional ? "lx" : "cd");
  if (used != 1) line += fmt::format(", {}", used == 0 ? "on no node" : counted(uint64_t(used), "node", "nodes"));
  return line;
}

std::string bounds_text(const DAabb& box) {
  if (box.empty()) return "nothing is drawn";
  const glm::dvec3 size = box.max - box.min;
  return fmt::format("{:.4g} x {:.4g} x {:.4g} m, from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", size.x,
                     size.y, size.z, box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z);
}

std::string drawn_text(const SceneFacts& facts) {
  std::string text = fmt::format("{} in {}", counted(facts.triangles, "triangle", "triangles"),
                                 counted(facts.draw_items, "item", "items"));
  const std::pair<uint64_t, const char*> kinds[] = {
      {facts.mask_items, "masked"},     {facts.blend_items, "blended"},   {facts.refracting_items, "refracting"},
      {facts.skinned_items, "skinned"}, {facts.morphed_items, "morphed"}, {facts.unlit_items, "unlit"}};
  for (const auto& [count, kind] : kinds)
    if (count > 0) text += fmt::format(", {} {}", count, kind);
  if (facts.lines + facts.points > 0) text += fmt::format("; {} lines, {} points", facts.lines, facts.points);
  return text;
}

}  // namespace

void add_summary(Json& json, const Scene& scene, const Job& job, const SurveyedFrame& frame) {
  Json clips = Json::array(), cameras = Json::array(), lights = Json::array();
  const std::vector<ClipFacts> facts = clips_of(scene, job);
  for (size_t i = 0; i < facts.size(); ++i) {
    const ClipFacts& clip = facts[i];
    clips.push_back({{"index", i},
                     {"name", clip.name},
                     {"seconds", clip.end_s},
                     {"targets", clip.targets},
                     {"plays", clip.plays},
                     {"conflicts", clip.conflicts},
                     {"conflicts_with", clip.with < 0 ? Json(nullptr) : Json(clip.with)}});
  }
  const std::vector<int> camera_uses = uses(scene, scene.cameras.size(), &Node::camera),
                         light_uses = uses(scene, scene.lights.size(), &Node::light);
  for (size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    cameras.push_back({{"index", i},
                       {"name", camera.name},
                       {"type", camera.perspective ? "perspective" : "orthographic"},
                       {"nodes", camera_uses[i]}});
  }
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    lights.push_back({{"index", i},
                      {"name", light.name},
                      {"type", type_name(light.type)},
                      {"intensity", light.intensity},
                      {"nodes", light_uses[i]}});
  }
  json["clips"] = std::move(clips), json["cameras"] = std::move(cameras), json["lights"] = std::move(lights);
  json["bounds"] = nullptr;
  if (const DAabb box = world_bounds(scene, frame.pose); !box.empty())
    json["bounds"] = {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}};
}

std::string summary_text(const Scene& scene, const Job& job, const SurveyedFrame& frame) {
  std::string text = fmt::format("{:<11} {}\n", "scene", printable(scene.path));
  text += fmt::format("{:<11} {}\n", "bounds", bounds_text(world_bounds(scene, frame.pose)));
  text += fmt::format("{:<11} {}\n", "drawn", drawn_text(frame.facts));
  text += fmt::format("{:<11} {}\n", "camera", printable(frame.view.name));
  Lines cameras(text, "cameras");
  for (size_t i = 0; i < scene.cameras.size(); ++i) cameras.add(camera_line(scene.cameras[i], i));
  cameras.end("--json");
  const std::vector<int> light_uses = uses(scene, scene.lights.size(), &Node::light);
  text += fmt::format("{:<11} {} point, {} spot, {} directional{}\n", "light", frame.facts.point_lights,
                      frame.facts.spot_lights, frame.facts.directional_lights,
                      frame.sky.studio              ? "; the studio"
                      : frame.facts.environment     ? "; a sky"
                      : frame.request.neutral_light ? "; the neutral light"
                                                    : "");
  Lines lights(text, "lights");
  for (size_t i = 0; i < scene.lights.size(); ++i) lights.add(light_line(scene.lights[i], i, light_uses[i]));
  lights.end("--json");
  const std::vector<ClipFacts> clips = clips_of(scene, job);
  Lines animations(text, "animations");
  for (size_t i = 0; i < clips.size(); ++i) animations.add(clip_line(clips, i));
  animations.end("--json");
  if (!scene.variants.empty()) text += fmt::format("{:<11} {}\n", "variants", printable(joined(scene.variants)));
  Lines extensions(text, "extensions");
  for (const ExtensionUse& use : scene.extensions)
    extensions.add(fmt::format("{}: {}{}", printable(use.name),
                               use.support == Support::supported      ? "supported"
                               : use.support == Support::approximated ? "approximated, "
                                                                      : "ignored, ",
                               use.consequence));
  extensions.end("--json");
  for (const std::string& note : frame.notes) text += fmt::format("{:<11} {}\n", "note", note);
  return text;
}

}  // namespace candela::cli
