#include <map>

#include "gltf/validate/internal.h"

namespace candela::validation {
namespace {

class AnimationChecker {
 public:
  AnimationChecker(Document& document, size_t index)
      : d_(document),
        animation_(elements(document.json, "animations")[index]),
        path_(fmt::format("/animations/{}", index)) {}

  void run() {
    const Json& samplers = elements(animation_, "samplers");
    for (size_t i = 0; i < samplers.size(); ++i) sampler(samplers[i], fmt::format("{}/samplers/{}", path_, i));
    const Json& channels = elements(animation_, "channels");
    for (size_t i = 0; i < channels.size(); ++i) channel(channels[i], i);
  }

 private:
  void sampler(const Json& sampler, const std::string& path) {
    if (const AccessorLayout* input = d_.accessor(sampler, "input", path)) {
      const std::string at = path + "/input";
      if (input->type != "SCALAR" || input->component_type != component_float)
        d_.findings.fatal("ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT", at,
                          "invalid accessor format {}, must be {{SCALAR, FLOAT}}", input->format());
      if (!input->has_bounds)
        d_.findings.warning("ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS", at,
                            "accessor.min and accessor.max must be defined");
      if (is_cubic(sampler) && input->count < 2)
        d_.findings.add(input->count == 1 ? Harm::warning : Harm::fatal,
                        "ANIMATION_SAMPLER_INPUT_ACCESSOR_TOO_FEW_ELEMENTS", at,
                        fmt::format("CUBICSPLINE needs at least 2 keys, got {}; one is a constant", input->count));
      view(*input, at);
    }
    if (const AccessorLayout* output = d_.accessor(sampler, "output", path)) view(*output, path + "/output");
  }

  void view(const AccessorLayout& a, const std::string& path) {
    if (a.view_has_stride)
      d_.findings.warning("ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE", path,
                          "byteStride must not be defined for animation data");
    d_.use_view(a, ViewUse::other, path);
  }

  static bool is_cubic(const Json& sampler) { return text(sampler, "interpolation") == "CUBICSPLINE"; }

  void channel(const Json& channel, size_t index) {
    const std::string path = fmt::format("{}/channels/{}", path_, index);
    const Json& samplers = elements(animation_, "samplers");
    const int64_t sampler_index = integer(channel, "sampler", -1);
    const bool resolved = sampler_index >= 0 && uint64_t(sampler_index) < samplers.size();
    if (!resolved)
      d_.findings.fatal("UNRESOLVED_REFERENCE", path + "/sampler", "unresolved reference: {} (there are {} samplers)",
                        sampler_index, samplers.size());
    const Json& target = member(channel, "target");
    const int64_t node = d_.reference(target, "node", "nodes", path + "/target");
    const std::string_view target_path = text(target, "path");
    uint64_t values_per_key = 1;
    if (node >= 0 && target_path != "pointer") {
      node_target(node, target_path, path);
      if (target_path == "weights") values_per_key = morph_targets(node);
      const auto [entry, is_new] = targets_.try_emplace({node, target_path}, index);
      if (!is_new)
        d_.findings.fatal("ANIMATION_DUPLICATE_TARGETS", fmt::format("{}/channels/{}/target", path_, entry->second),
                          "the channel has the same target as channel {}", index);
    }
    if (resolved) output(samplers[sampler_index], target, target_path, node, values_per_key, path + "/sampler");
  }

  uint64_t morph_targets(int64_t node) const {
    const int64_t mesh = integer(elements(d_.json, "nodes")[node], "mesh", -1);
    if (mesh < 0) return 0;
    const Json& primitives = elements(elements(d_.json, "meshes")[mesh], "primitives");
    return primitives.empty() ? 0 : elements(primitives[0], "targets").size();
  }

  void node_target(int64_t index, std::string_view target_path, const std::string& path) {
    const Json& node = elements(d_.json, "nodes")[index];
    if (target_path == "weights") {
      if (morph_targets(index) == 0)
        d_.findings.warning("ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS", path + "/target",
                            "the channel drives weights, but the mesh has no morph targets; ignored");
      return;
    }
    if (target_path != "translation" && target_path != "rotation" && target_path != "scale") return;
    if (node.contains("matrix"))
      d_.findings.fatal("ANIMATION_CHANNEL_TARGET_NODE_MATRIX", path + "/target",
                        "a node with a matrix cannot be animated");
    if (node.contains("skin"))
      d_.findings.warning("ANIMATION_CHANNEL_TARGET_NODE_SKIN", path + "/target/path",
                          "animated TRS properties do not affect a skinned mesh");
  }

  // The kind of value that a pointer drives is the loader's to know; here only whole keys are asked for.
  void output(const Json& sampler, const Json& target, std::string_view target_path, int64_t node,
              uint64_t values_per_key, const std::string& path) {
    const int64_t input_index = integer(sampler, "input", -1), output_index = integer(sampler, "output", -1);
    if (uint64_t(input_index) >= d_.accessors.size() || uint64_t(output_index) >= d_.accessors.size()) return;
    const AccessorLayout &input = d_.accessors[input_index], &a = d_.accessors[output_index];
    const uint64_t keys = input.count * (is_cubic(sampler) ? 3 : 1);
    if (extension(target, "KHR_animation_pointer").is_object() || target_path == "pointer") {
      if (a.count % keys != 0) wrong_count(path, keys, a.count);
      return;
    }
    if (node < 0) return;
    const bool is_rotation = target_path == "rotation", is_weights = target_path == "weights";
    const bool is_vector = target_path == "translation" || target_path == "scale";
    if (!is_rotation && !is_weights && !is_vector) return;
    const bool is_packed = a.normalized && a.component_type != component_uint && !is_vector;
    if (a.type != (is_rotation  ? "VEC4"
                   : is_weights ? "SCALAR"
                                : "VEC3") ||
        (a.component_type != component_float && !is_packed))
      d_.findings.fatal("ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT", path,
                        "invalid accessor format {} for path '{}'", a.format(), target_path);
    if (values_per_key > 0 && a.count != keys * values_per_key) wrong_count(path, keys * values_per_key, a.count);
  }

  void wrong_count(const std::string& path, uint64_t wanted, uint64_t found) {
    d_.findings.fatal("ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT", path,
                      "output accessor of count {} expected, found {}", wanted, found);
  }

  Document& d_;
  const Json& animation_;
  const std::string path_;
  std::map<std::pair<int64_t, std::string_view>, size_t> targets_;
};

}  // namespace

void check_animations(Document& document) {
  for (size_t i = 0; i < document.count("animations"); ++i) AnimationChecker(document, i).run();
}

void check_extensions(Document& d) {
  const Json& used = elements(d.json, "extensionsUsed");
  const Json& required = elements(d.json, "extensionsRequired");
  for (size_t i = 0; i < required.size(); ++i)
    if (std::find(used.begin(), used.end(), required[i]) == used.end())
      d.findings.warning("UNUSED_EXTENSION_REQUIRED", fmt::format("/extensionsRequired/{}", i),
                         "the extension is missing in extensionsUsed");
}

}  // namespace candela::validation
