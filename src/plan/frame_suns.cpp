#include "plan/frame_suns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/scratch.h"
#include "passes/geometry/depth_views.h"
#include "plan/sun_cascades.h"
#include "scene/largest_score.h"

namespace candela {
namespace {

std::string_view why_none(const SceneFacts& facts, const FrameRequest& request, const SunKnobs& knobs,
                          bool see_through) {
  if (facts.directional_lights == 0) return "no directional light shines";
  if (!facts.takes_light()) return "nothing that is drawn takes light";
  const bool traced = sends_rays(SunMode(knobs.mode));
  if (facts.opaque_items + facts.mask_items + (traced || see_through ? facts.blend_items : 0) +
          (see_through ? facts.refracting_items : 0) ==
      0)
    return "nothing that is drawn casts a shadow";
  if (!request.wants_true(DepthViews::effect)) return "shadows are not wanted (--effects, --quality)";
  if (request.neutral_light) return "the neutral light casts no shadows";
  if (SunMode(knobs.mode) == SunMode::off) return "sun.mode is off";
  if (knobs.lights == 0 && !traced) return "sun.lights is 0";
  return {};
}

SunFit drawn_fit(const Scene& scene, const FrameData& data, const View& view) {
  SunFit fit;
  const double infinity = std::numeric_limits<double>::infinity();
  const glm::dvec3 forward = -glm::dvec3(glm::transpose(view.view_from_relative)[2]);
  fit.nearest_m = infinity;
  for (const DrawItem& item : data.items) {
    const glm::dvec3 centre(item.bounds_relative.centre()), half(item.bounds_relative.extent());
    if (!std::isfinite(centre.x + centre.y + centre.z + half.x + half.y + half.z))
      return {{glm::dvec3(-infinity), glm::dvec3(infinity)}, 0, infinity};
    fit.drawn_relative.add(DAabb{centre - half, centre + half});
    const double depth_m = glm::dot(centre, forward), reach_m = glm::dot(half, glm::abs(forward));
    if (depth_m + reach_m <= 0) continue;  // behind the camera
    fit.nearest_m = std::min(fit.nearest_m, depth_m - reach_m);
    fit.farthest_m = std::max(fit.farthest_m, depth_m + reach_m);
  }
  if (!data.item_groups.empty()) {
    const auto largest = [&](auto score) { return largest_score(scene, data, score, score); };
    DAabb box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto high = [&](const auto& b) { return double(b.centre()[axis]) + double(b.extent()[axis]); };
      const auto low = [&](const auto& b) { return double(b.extent()[axis]) - double(b.centre()[axis]); };
      box.min[axis] = -largest(low), box.max[axis] = largest(high);
    }
    fit.drawn_relative.add(box);
    const auto depth = [&](const auto& b) { return glm::dot(glm::dvec3(b.centre()), forward); };
    const auto reach = [&](const auto& b) { return glm::dot(glm::dvec3(b.extent()), glm::abs(forward)); };
    fit.farthest_m = std::max(fit.farthest_m, largest([&](const auto& b) { return depth(b) + reach(b); }));
    fit.nearest_m =
        std::min(fit.nearest_m,
                 -largest([&](const auto& b) { return depth(b) + reach(b) <= 0 ? -infinity : reach(b) - depth(b); }));
  }
  fit.nearest_m = std::isfinite(fit.nearest_m) ? std::max(fit.nearest_m, 0.0) : 0.0;
  return fit;
}

double brightness_lux(const LightItem& light) {
  return glm::dot(glm::dvec3(light.intensity), glm::dvec3(0.2126, 0.7152, 0.0722));
}

}  // namespace

Expected<void> plan_suns(const Scene& scene, const SurveyedFrame& frame, const PackedFrame& packed,
                         const SunKnobs& knobs, const MapOptions& options, FrameSuns& out) {
  const FrameData& data = frame.data;
  const SceneFacts& facts = frame.facts;
  const FrameRequest& request = frame.request;
  out.clear(), out.shadows.clear();
  out.absence = why_none(facts, request, knobs, options.see_through);
  if (!out.absence.empty()) return {};
  out.traced = sends_rays(SunMode(knobs.mode));
  out.by_voxels = SunMode(knobs.mode) == SunMode::voxels;
  if (out.traced && (!request.draws_fog() || (!options.see_through && facts.opaque_items + facts.mask_items == 0) ||
                     knobs.lights == 0)) {
    fmt::format_to(std::back_inserter(out.absence), "sun.mode is {}: shading sends rays",
                   out.by_voxels ? "voxels" : "traced");
    return {};
  }
  Scratch scratch;
  ScratchVector<size_t> suns(&scratch);
  for (size_t i = 0; i < data.lights.size(); ++i)
    if (data.lights[i].type == LightType::directional) suns.push_back(i);
  std::ranges::sort(suns, [&](size_t a, size_t b) {
    const double lux_a = brightness_lux(data.lights[a]), lux_b = brightness_lux(data.lights[b]);
    return lux_a != lux_b ? lux_a > lux_b : a < b;
  });
  if (suns.size() > size_t(knobs.lights)) {
    out.notes.add("{} of {} directional lights cast no shadows, the dimmest (sun.lights = {}): those of the nodes ",
                  suns.size() - size_t(knobs.lights), suns.size(), knobs.lights);
    for (size_t i = size_t(knobs.lights); i < suns.size(); ++i)
      out.notes.extend("{}{}", i == size_t(knobs.lights) ? "" : ", ", data.lights[suns[i]].node);
    suns.resize(size_t(knobs.lights));
  }
  SunFit fit = drawn_fit(scene, data, frame.view);
  fit.most_px = most_map_px(options.longer_side_px, request.quality);
  fit.scene_size_m = options.scene_size_m;
  const bool single = SunMode(knobs.mode) == SunMode::single;
  if (const int wished = single ? knobs.single_px : knobs.size_px; uint32_t(wished) > fit.most_px)
    out.notes.add(
        "the shadow maps of directional lights have {} texels a side and not {} (sun.{}): "
        "in a picture this small more are not seen",
        fit.most_px, wished, single ? "single_px" : "size_px");
  ViewImage& image = out.image.emplace();
  image.clear();
  image.name = "sun.maps";
  for (const size_t light : suns) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(data.lights[light].direction));
    SunCascades cascades = fit_sun_cascades(direction, frame.view, fit, knobs, uint32_t(image.views.size()), &scratch);
    if (!data.lights[light].is_hard) cascades.shadow.tangent = float(std::tan(data.lights[light].radius_rad));
    out.shadows.push_back(cascades.shadow);
    out.lights.push_back(uint32_t(light));
    image.views.insert(image.views.end(), cascades.views.begin(), cascades.views.end());
  }
  image.layers = uint32_t(image.views.size());
  image.size_px = image.views.front().size_px.x;
  return place_maps(out, data, packed.draws, packed.upload.items, options, knobs.draws, "sun.draws");
}

}  // namespace candela
