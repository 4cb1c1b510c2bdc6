#include "passes/geometry/depth_prepass.h"
#include "passes/post/resolve.h"
#include "passes/shared/blended.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/transparent.h"
#include "passes/transparency/fragments.h"
#include "passes/transparency/moments.h"
#include "passes/transparency/phenomenological.h"
#include "passes/transparency/weighted.h"
#include "techniques/technique.h"

namespace candela {
namespace {

template <class P>
ImageHandle draw_by(Frame& frame, const BlendedIn& in, std::string_view instance) {
  return frame.add(P{}, in, instance).color;
}

// Alone, it draws surfaces that let light through too.
ImageHandle draw_phenomenologically(Frame& frame, const BlendedIn& in, std::string_view instance) {
  Phenomenological::In all{in, {}};
  if (Phenomenological{}.needed(frame.facts, frame.request) && frame.facts.refracting_items > 0) {
    const auto name = [&](std::string_view of) {
      return instance.empty() ? std::string(of) : fmt::format("{}.{}", instance, of);
    };
    const SceneInputs& s = in.scene;
    ImageHandle color = in.color;
    if (frame.facts.blend_items > 0) {
      all.blended.glass = frame.add(DepthPrepass{true}, {s, in.draws, in.deformed}, name(Phenomenological::name)).depth;
      color = newest(frame.add(Phenomenological{.behind = true}, {all.blended, {}}, name("behind")).color, color);
    }
    const Resolve::In resolve{color, s.width_px, s.height_px, s.samples};
    all.picture = newest(frame.add(Resolve{}, resolve, name(Phenomenological::name)).resolved, color);
  }
  return frame.add(Phenomenological{}, all, instance).color;
}

}  // namespace

std::span<const TransparencyMethod> transparency_methods() {
  static constexpr TransparencyMethod table[] = {
      {Transparent::method,
       "back to front by the middles of their bounds: wrong where bounds overlap, and among triangles of one mesh",
       draw_by<Transparent>},
      {Weighted::method, "sums weighted by distance, in any order: the cheapest, and the least exact",
       draw_by<Weighted>},
      {Moments::method, "dimmed by moments of what is absorbed along the ray, in any order: twice the drawing",
       draw_by<Moments>},
      {Fragments::method, "every surface of a pixel stored and sorted: exact, in time and memory as there are layers",
       draw_by<Fragments>},
      {Phenomenological::method,
       "sums that tint, move and blur what is behind, for blended surfaces and for glass, in any order",
       draw_phenomenologically},
  };
  return table;
}

ImageHandle transparent(Frame& frame, const BlendedIn& in, std::string_view instance) {
  ImageHandle color = in.color;
  for (const TransparencyMethod& method : transparency_methods()) {
    const bool chosen = method.name == frame.request.transparency;
    // What is left out is said once, not for each picture of a supersampled frame.
    if (!chosen && !instance.empty() && instance != "s00") continue;
    color = newest(method.draw(frame, in, instance), color);
  }
  return color;
}

bool stores_blended(const Frame& frame) {
  return frame.request.transparency == Fragments::method && frame.facts.blend_items != 0;
}

ImageHandle part_behind_blended(Frame& frame, BlendedIn in, std::string_view shader, std::string_view layer,
                                std::string_view instance) {
  const std::string name = instance.empty() ? std::string(layer) : fmt::format("{}.{}", instance, layer);
  return newest(frame.add(Fragments{.part = std::string(shader)}, in, name).color, in.color);
}

}  // namespace candela
