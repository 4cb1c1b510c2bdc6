#include "passes/geometry/occlusion_cull_knobs.h"

namespace candela {

std::span<const Knob> OcclusionCullKnobs::table() {
  static const Knob table[] = {
      {.name = "mode",
       .member = &OcclusionCullKnobs::mode,
       .lowest = off,
       .highest = automatic,
       .levels = {automatic},
       .description =
           "whether items behind large ones are left out; auto: in scenes of many items and triangles; changes "
           "time, never the image",
       .choices = {"off", "on", "auto"},
       .kind = Trades::time,
       .sweep = {off, on, automatic}},
      {.name = "first_share",
       .member = &OcclusionCullKnobs::first_fraction,
       .lowest = 0,
       .highest = 1,
       .levels = {0.005},
       .description = "an item whose box covers at least this share of the picture is drawn first, to hide others; "
                      "changes time, never the image",
       .kind = Trades::time,
       .sweep = {0, 0.05, 0.005}},
  };
  return table;
}

namespace {
// Below these two phases may cost more than they save (docs/building/decisions.md).
constexpr uint32_t least_items = 256, least_triangles = 100000;
}  // namespace

Need needs_occlusion_culling(const SceneFacts& facts, const OcclusionCullKnobs& knobs) {
  if (const Need need = needed_for_solid_surfaces(facts); !need) return need;
  if (knobs.mode == OcclusionCullKnobs::off) return {false, "occlusion culling is off (occlusion_cull.mode)"};
  if (knobs.mode == OcclusionCullKnobs::on) return {};
  return needed_if(facts.draw_items >= least_items && facts.triangles >= least_triangles,
                   fmt::format("{} items of {} triangles are too few for it to pay (occlusion_cull.mode)",
                               facts.draw_items, facts.triangles));
}

}  // namespace candela
