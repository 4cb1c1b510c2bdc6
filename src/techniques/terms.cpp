#include "passes/surfaces/terms.h"
#include "passes/post/resolve.h"
#include "passes/shared/blended.h"
#include "passes/shared/fog_view.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/sky/background.h"
#include "passes/sky/sky.h"
#include "techniques/technique.h"

namespace candela {
TermImages divide(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                  const Composite& composite, std::string_view instance) {
  const bool wanted = bool(Terms{}.needed(frame.facts, frame.request));
  const std::string name = instance.empty() ? "terms" : fmt::format("{}.terms", instance);
  const ImageHandle depth = wanted ? depth_of_hardware(frame, scene, surfaces, name) : surfaces.depth;
  Terms::In in{scene, surfaces.visible,    surfaces.deformed, lighting,       depth,
               {},    composite.reflected, composite.seen,    composite.depth};
  for (uint32_t i = 0; i < term_count; ++i) in.wanted[i] = frame.request.wants_term(Terms::layers[i].name);
  constexpr size_t background = size_t(Term::background);
  if (in.wanted[background]) {
    const std::string behind = instance.empty() ? "term" : fmt::format("{}.term", instance);
    // Through fog, without the fog's own light: so nothing has to be looked up.
    Lighting clear;
    if (lighting.fog) clear.fog.light = FogLight::nothing;
    in.background = frame.add(Sky{}, {scene, depth, {}, clear, false}, behind).color;
    in.background =
        newest(frame.add(Background{}, {scene, depth, in.background, clear, false}, behind).color, in.background);
  }
  in.without_blended = stores_blended(frame);
  TermImages images = frame.add(Terms{}, in, instance).images;
  // Where nothing is visible there is no pass, and the background is all.
  images[background] = newest(images[background], in.background);
  if (!in.without_blended) return images;
  BlendedIn over{scene, surfaces.visible, surfaces.deformed, of_blended(lighting.unoccluded()), composite.depth, {}};
  if (over.lists.fog) over.lists.fog.light = FogLight::nothing;
  for (uint32_t i = 0; i < term_count; ++i) {
    over.color = images[i];
    if (images[i]) images[i] = part_behind_blended(frame, over, Terms::stored_part(i), Terms::layers[i].name, instance);
  }
  return images;
}

LightGroupImages divide_lights(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces,
                               const Lighting& lighting, const Composite& composite, std::string_view instance) {
  constexpr uint32_t most_images = term_count;  // that one pass draws to
  const std::vector<std::string>& groups = frame.request.light_groups;
  const uint32_t count = uint32_t(groups.size());
  LightGroupImages images(count);
  const std::string name = instance.empty() ? "lights" : fmt::format("{}.lights", instance);
  Terms::In in{scene, surfaces.visible, surfaces.deformed, lighting, {}, {}, {}, composite.seen, composite.depth};
  if (count > 0) in.depth = depth_of_hardware(frame, scene, surfaces, name);
  in.without_blended = stores_blended(frame);
  // All, or the one that a picture shows.
  uint32_t first = 0, end = count;
  while (first < end && !frame.request.wants_light_group(groups[first])) ++first;
  while (end > first && !frame.request.wants_light_group(groups[end - 1])) --end;
  for (in.first_group = first; in.first_group < end; in.first_group += most_images) {
    in.groups = std::min(end - in.first_group, most_images);
    const std::string part = in.first_group == first ? name : fmt::format("{}{}", name, in.first_group);
    const TermImages some = frame.add(Terms{.of_lights = true}, in, part).images;
    std::copy_n(some.begin(), in.groups, images.begin() + in.first_group);
  }
  if (!in.without_blended) return images;
  BlendedIn over{scene, surfaces.visible, surfaces.deformed, of_blended(lighting.unoccluded()), composite.depth, {}};
  if (over.lists.fog) over.lists.fog.light = FogLight::nothing;
  for (uint32_t g = 0; g < count; ++g) {
    over.color = images[g];
    if (images[g]) images[g] = part_behind_blended(frame, over, Terms::stored_group(g), groups[g], instance);
  }
  return images;
}

void publish_light_groups(Frame& frame, const SceneInputs& scene, const LightGroupImages& images) {
  const SubframePart::Role role = frame.request.part.role;
  for (size_t g = 0; g < frame.request.light_groups.size(); ++g) {
    const std::string& layer = frame.request.light_groups[g];
    if (!frame.request.wants_light_group(layer)) continue;
    if (role == SubframePart::Role::mean) {
      frame.builder.publish(layer, mean_of(frame, scene, layer));
      continue;
    }
    ImageHandle image = g < images.size() ? images[g] : ImageHandle{};
    if (image) {
      const Resolve::In in{image, scene.width_px, scene.height_px, scene.samples};
      image = newest(frame.add(Resolve{}, in, layer).resolved, image);
    }
    if (role == SubframePart::Role::subframe)
      add_to_sum(frame, scene, layer, image);
    else if (image)
      frame.builder.publish(layer, image);
  }
}

TermImages publish_terms(Frame& frame, const SceneInputs& scene, TermImages terms) {
  const SubframePart::Role role = frame.request.part.role;
  for (uint32_t i = 0; i < term_count; ++i) {
    if (role == SubframePart::Role::mean && frame.request.wants_term(Terms::layers[i].name)) {
      terms[i] = mean_of(frame, scene, std::string(Terms::layers[i].name));
      frame.builder.publish(std::string(Terms::layers[i].name), terms[i]);
      continue;
    }
    const std::string layer(Terms::layers[i].name);
    if (terms[i]) {
      const Resolve::In in{terms[i], scene.width_px, scene.height_px, scene.samples};
      terms[i] = newest(frame.add(Resolve{}, in, layer).resolved, terms[i]);
    }
    if (role == SubframePart::Role::subframe && frame.request.wants_term(layer))
      add_to_sum(frame, scene, layer, terms[i]);
    else if (terms[i])
      frame.builder.publish(layer, terms[i]);
  }
  return terms;
}

}  // namespace candela
