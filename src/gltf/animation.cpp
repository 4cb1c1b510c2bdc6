#include "gltf/animation.h"

#include <numeric>

#include <algorithm>

#include "gltf/accessors.h"
#include "gltf/pointers.h"

namespace candela::gltf {
namespace {

const Json* pointer_extension(const Json& target) { return extension(target, "KHR_animation_pointer"); }

// What a channel drives; a warning and nothing when this program cannot drive it.
std::vector<PointerTarget> targets_of(Document& document, const Scene& scene, const Json& target,
                                      const std::string& path) {
  std::string pointer;
  if (const Json* e = pointer_extension(target)) {
    pointer = text(document, *e, "pointer", "", path + "/extensions/KHR_animation_pointer");
  } else {
    const int node = index_of(document, target, "node", scene.nodes.size(), path);
    if (node < 0) {
      document.warn(path, "the channel names no node and is left out");
      return {};
    }
    const std::string name = text(document, target, "path", "", path);
    if (name != "translation" && name != "rotation" && name != "scale" && name != "weights") {
      document.warn(path + "/path",
                    "'{}' is no path of an animation channel; the channel is left out (VALUE_NOT_IN_LIST)", name);
      return {};
    }
    pointer = fmt::format("/nodes/{}/{}", node, name);
  }
  // The weights of a mesh are those of every node that shows it and has none of its own.
  if (unsigned mesh = 0; std::sscanf(pointer.c_str(), "/meshes/%u/", &mesh) == 1 &&
                         pointer.starts_with(fmt::format("/meshes/{}/weights", mesh))) {
    std::vector<PointerTarget> out;
    const std::string rest = pointer.substr(fmt::format("/meshes/{}/", mesh).size());
    for (size_t n = 0; n < scene.nodes.size(); ++n)
      if (scene.nodes[n].mesh == int(mesh) && scene.nodes[n].weights.empty())
        if (const auto found = pointer_target(scene, fmt::format("/nodes/{}/{}", n, rest))) out.push_back(*found);
    return out;
  }
  const std::optional<PointerTarget> found = pointer_target(scene, pointer);
  if (!found) {
    document.warn(path, "'{}' cannot be animated (unknown, absent or without morph targets); the channel is left out",
                  pointer);
    return {};
  }
  if (found->path <= TargetPath::node_scale && scene.nodes[size_t(found->object)].has_matrix) {
    document.warn(
        path,
        "node {} has a matrix and cannot be animated; the channel is left out (ANIMATION_CHANNEL_TARGET_NODE_MATRIX)",
        found->object);
    return {};
  }
  return {*found};
}

Interpolation interpolation_of(Document& document, const Json& sampler, const std::string& path) {
  const std::string name = text(document, sampler, "interpolation", "LINEAR", path);
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  if (name != "LINEAR")
    document.warn(path + "/interpolation", "'{}' is no interpolation; LINEAR is used (VALUE_NOT_IN_LIST)", name);
  return Interpolation::linear;
}

std::vector<float> read_times(Document& document, int accessor, const std::string& path) {
  std::vector<float> times = all_floats(document, accessor, 1, path + "/input");
  const std::string where = fmt::format("/accessors/{}", accessor);
  bool equal = false;
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] < times[i - 1]) {
      document.warn(where,
                    "key {} at {} s comes before its predecessor at {} s; keys are sorted "
                    "(ACCESSOR_ANIMATION_INPUT_NON_INCREASING)",
                    i, times[i], times[i - 1]);
      break;
    }
    equal |= times[i] == times[i - 1];
  }
  if (equal)
    document.warn(where, "two keys have the same time; the later one wins (ACCESSOR_ANIMATION_INPUT_NON_INCREASING)");
  if (*std::ranges::min_element(times) < 0)
    document.warn(where, "the first key lies before 0 s (ACCESSOR_ANIMATION_INPUT_NEGATIVE)");
  return times;
}

// Values are scalars, vectors or (weights) runs of scalars; all that matters is how many numbers there are a key.
std::vector<float> read_values(Document& document, int accessor, const std::string& path) {
  const Elements elements = elements_of(document, accessor, path + "/output");
  const size_t count = elements.count * size_t(elements.components);
  document.charge(count, sizeof(float), elements.path + "/count");
  std::vector<float> values(count);
  read_floats(document, elements, elements.components, {}, values);
  return values;
}

// By their times, those of one time in the order of the file; with their values.
void sort_keys(AnimationChannel& channel) {
  if (std::ranges::is_sorted(channel.times_s)) return;
  std::vector<size_t> order(channel.times_s.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::ranges::sort(order, {}, [&](size_t key) { return std::pair(channel.times_s[key], key); });
  const size_t per_key = channel.values.size() / order.size();
  std::vector<float> times, values;
  for (const size_t key : order) {
    times.push_back(channel.times_s[key]);
    const auto first = channel.values.begin() + long(key * per_key);
    values.insert(values.end(), first, first + long(per_key));
  }
  channel.times_s = std::move(times), channel.values = std::move(values);
}

void import_channel(Document& document, const Scene& scene, const Json& json, size_t animation, size_t channel,
                    Animation& out) {
  const std::string path = fmt::format("/animations/{}", animation),
                    channel_path = fmt::format("{}/channels/{}", path, channel);
  const Json* target = member(json["channels"][channel], "target");
  const Json* samplers = member(json, "samplers");
  const int sampler_index =
      index_of(document, json["channels"][channel], "sampler", samplers ? samplers->size() : 0, channel_path);
  if (!target || sampler_index < 0)
    document.refuse(channel_path, "a channel needs a sampler and a target (UNDEFINED_PROPERTY)");
  const std::vector<PointerTarget> targets = targets_of(document, scene, *target, channel_path + "/target");
  if (targets.empty()) return;

  const Json& sampler = (*samplers)[size_t(sampler_index)];
  const std::string sampler_path = fmt::format("{}/samplers/{}", path, sampler_index);
  AnimationChannel made;
  made.interpolation = interpolation_of(document, sampler, sampler_path);
  const size_t accessors = document.model.accessors.size();
  made.times_s = read_times(document, index_of(document, sampler, "input", accessors, sampler_path), sampler_path);
  made.values = read_values(document, index_of(document, sampler, "output", accessors, sampler_path), sampler_path);
  const size_t tuples = made.times_s.size() * (made.interpolation == Interpolation::cubic_spline ? 3 : 1);
  for (const PointerTarget& t : targets) {
    if (made.values.size() != tuples * size_t(t.components))
      document.refuse(sampler_path + "/output",
                      "{} numbers where {} keys of {} need {} (ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT)",
                      made.values.size(), made.times_s.size(), t.components, tuples * size_t(t.components));
    document.charge(made.values.size() + made.times_s.size(), sizeof(float), sampler_path);
    sort_keys(made);
    made.path = t.path;
    made.object = t.object;
    made.element = t.element;
    made.components = t.components;
    if (t.path == TargetPath::node_visible && made.interpolation != Interpolation::step) {
      document.warn(sampler_path + "/interpolation",
                    "a truth value can only be animated with STEP; the channel is left out");
      continue;
    }
    out.channels.push_back(made);
  }
  out.end_s = std::max(out.end_s, double(made.times_s.back()));
}

}  // namespace

std::set<std::string> animated_pointers(const Document& document) {
  std::set<std::string> out;
  const Json* animations = member(document.json, "animations");
  if (!animations) return out;
  for (const Json& animation : *animations)
    if (const Json* channels = member(animation, "channels"))
      for (const Json& channel : *channels)
        if (const Json* target = member(channel, "target"))
          if (const Json* e = pointer_extension(*target))
            if (const Json* pointer = member(*e, "pointer"); pointer && pointer->is_string())
              out.insert(pointer->get<std::string>());
  return out;
}

void import_animations(Document& document, bool needed, Scene& scene) {
  const Json* animations = member(document.json, "animations");
  if (!animations) return;
  for (size_t a = 0; a < animations->size(); ++a) {
    const Json& json = (*animations)[a];
    Animation animation;
    animation.name = text(document, json, "name", "", fmt::format("/animations/{}", a));
    const Json* channels = member(json, "channels");
    try {
      for (size_t c = 0; channels && c < channels->size(); ++c) import_channel(document, scene, json, a, c, animation);
    } catch (const Failure& failure) {
      if (needed) throw;
      document.warnings.push_back(failure.error.text() + "; no animation plays");
      animation.channels.clear(), animation.end_s = 0;
    }
    scene.animations.push_back(std::move(animation));
  }
}

}  // namespace candela::gltf
