// Regions and overscan: of one pixel, at the picture's borders, in the overscan, all of it, and what is refused.
#include "stability/stage.h"

namespace candela::stability {
namespace {

// The room is of 64x48 pixels; the reference traces the region alone.
void add(Recipes& all, const char* name, const char* what, std::optional<PixelRect> region, Overscan overscan = {},
         bool refused = false) {
  all.push_back({"regions", name, what, [=](StabilityInput& in) {
                   GlbWriter out;
                   lit_room(out, in.rng);
                   StabilityScene scene = scene_of(out);
                   scene.job.region = region, scene.job.overscan = overscan;
                   scene.refused = refused;
                   return scene;
                 }});
}
void refused(Recipes& all, const char* name, const char* what, std::optional<PixelRect> region,
             Overscan overscan = {}) {
  add(all, name, what, region, overscan, true);
}

}  // namespace

void add_regions(Recipes& all) {
  const PixelRect whole{0, 0, 64, 48};
  add(all, "a pixel", "in the middle", PixelRect{32, 24, 1, 1});
  add(all, "the first pixel", "in the upper left corner", PixelRect{0, 0, 1, 1});
  add(all, "the last pixel", "in the lower right corner", PixelRect{63, 47, 1, 1});
  add(all, "the last column", "one pixel wide", PixelRect{63, 0, 1, 48});
  add(all, "the last row", "one pixel high", PixelRect{0, 47, 64, 1});
  add(all, "all of it", "the region is the picture", whole);
  add(all, "all but a pixel's border", "on all four sides", PixelRect{1, 1, 62, 46});
  add(all, "overscan of a pixel", "on each side", {}, {1, false});
  add(all, "overscan of 70 pixels", "wider than the picture", {}, {70, false});
  add(all, "overscan of 110 %", "likewise", {}, {110, true});
  add(all, "the overscan's first pixel", "beyond the picture", PixelRect{-300, -300, 1, 1}, {300, false});
  add(all, "the overscan's last pixel", "likewise", PixelRect{363, 347, 1, 1}, {300, false});
  add(all, "the picture of an overscan", "nothing of the overscan is put out", whole, {40, false});
  add(all, "across the picture's corner", "half of it is overscan", PixelRect{-8, -8, 16, 16}, {20, true});
  refused(all, "a row too high", "larger than the picture", PixelRect{0, 0, 64, 49});
  refused(all, "beyond the last pixel", "no pixel of it is in the picture", PixelRect{64, 0, 1, 1});
  refused(all, "before the first pixel", "there is no overscan", PixelRect{-1, 0, 2, 2});
  refused(all, "no pixel", "an empty region", PixelRect{10, 10, 0, 5});
  refused(all, "beyond the overscan", "by a pixel", PixelRect{-21, 0, 2, 2}, {20, false});
  refused(all, "overscan larger than images", "of 20,000 pixels", {}, {20000, false});
  refused(all, "overscan that is no number", "not finite", {}, {std::numeric_limits<double>::quiet_NaN(), false});
}

}  // namespace candela::stability
