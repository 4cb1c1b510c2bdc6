#include "passes/volumes/fog_knobs.h"

namespace candela {
namespace {

struct GridSize {
  std::string_view name;
  glm::uvec3 nodes;
};
// The seed's, and finer ones.
constexpr GridSize fog_grids[] = {{"32x18x24", {32, 18, 24}},     {"64x36x32", {64, 36, 32}},
                                  {"96x54x48", {96, 54, 48}},     {"128x72x64", {128, 72, 64}},
                                  {"160x90x128", {160, 90, 128}}, {"256x144x256", {256, 144, 256}}};

}  // namespace

std::span<const Knob> FogKnobs::table() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const GridSize& size : fog_grids) all.push_back(size.name);
    return all;
  }();
  static const Knob table[] = {
      {.name = "method",
       .member = &FogKnobs::method,
       .lowest = 0,
       .highest = 2,
       .levels = {froxels, froxels, froxels, pixels},
       .description = "froxels: light is stored in a grid of rays and depths; march: coarse texels follow rays in "
                      "steps of equal loss of light; pixels: each pixel follows its own ray",
       .choices = {"froxels", "march", "pixels"},
       .sweep = {froxels, march, pixels}},
      {.name = "grid",
       .member = &FogKnobs::grid,
       .lowest = 0,
       .highest = double(std::size(fog_grids) - 1),
       .levels = {0, 2, 3, 5},
       .description = "rays across and down, at most two a pixel, and depths at which the light of fog is kept",
       .choices = names,
       .sweep = {0, 1, 2, 3, 4, 5},
       .required = "fog.method=froxels"},
      {.name = "last",
       .member = &FogKnobs::last,
       .lowest = 0,
       .highest = 2,
       .levels = {0, 1, 1, 2},
       .description = "the slice in which a surface stands: 0 interpolated, so that local lights behind it shine "
                      "through; 1 summed "
                      "by each pixel where local lights are near; 2 everywhere",
       .sweep = {0, 1, 2},
       .required = "fog.method=froxels"},
      {.name = "steps",
       .member = &FogKnobs::steps,
       .lowest = 4,
       .highest = 65536,
       .levels = {64, 128, 128, 512},
       .description = "fog.method=pixels: slices of a ray in which light is summed",
       .sweep = {32, 64, 128, 512},
       .required = "fog.method=pixels"},
      {.name = "march_steps",
       .member = &FogKnobs::march_steps,
       .lowest = 4,
       .highest = 4096,
       .levels = {32, 64, 64, 512},
       .description = "fog.method=march: steps of a ray, at most; the last one takes what is left of it",
       .sweep = {16, 64, 512},
       .required = "fog.method=march"},
      {.name = "march_loss",
       .member = &FogKnobs::march_loss,
       .lowest = 1e-4,
       .highest = 0.5,
       .levels = {0.05, 0.025, 0.025, 0.002},
       .description = "fog.method=march: share of the light from the camera on that a step takes, within 0.0002 to 0.1 "
                      "of how far is drawn",
       .sweep = {0.1, 0.025, 0.002},
       .required = "fog.method=march"},
      {.name = "march_px",
       .member = &FogKnobs::march_px,
       .unit = "px",
       .lowest = 1,
       .highest = 8,
       .levels = {4, 2, 2, 1},
       .description = "fog.method=march: side of a texel that follows a ray: 1 full resolution, 2 half",
       .sweep = {4, 2, 1},
       .required = "fog.method=march"},
      {.name = "local_shadows",
       .member = &FogKnobs::local_shadows,
       .lowest = 0,
       .highest = 64,
       .levels = {0, 1, 1, 4},
       .description = "points of a slice, at least, at which the shadow maps of a local light are asked; 0: local "
                      "lights shine through "
                      "everything in the air",
       .sweep = {0, 1, 2, 4}},
      {.name = "sun_points",
       .member = &FogKnobs::sun_points,
       .lowest = 1,
       .highest = 64,
       .levels = {1, 4, 4, 16},
       .description =
           "points of a slice, along and across it, at which the shadow maps of a sun are asked; with one the "
           "edges of shadows in the air are blotches the size of a cell; fog.method=march asks at one, "
           "displaced by noise",
       .sweep = {1, 2, 4, 16},
       .only = {1, 2, 4, 8, 16, 32, 64}},
      {.name = "sky_directions",
       .member = &FogKnobs::sky_directions,
       .lowest = 1,
       .highest = 4096,
       .levels = {4, 16, 16, 256},
       .description =
           "directions in which the fog before the sky is looked through, for ambient light in fog that has an "
           "end; on surfaces in fog without bounds two elevations for each 16, and no azimuths",
       .sweep = {1, 4, 16, 64, 256}},
  };
  return table;
}

glm::uvec3 FogKnobs::nodes(uint32_t width_px, uint32_t height_px) const {
  // Rays that lie closer than half a pixel tell nothing of the picture.
  if (method == froxels) return glm::min(fog_grids[grid].nodes, glm::uvec3(2 * width_px + 1, 2 * height_px + 1, ~0u));
  // A march says the side of its texels; what is blended before it goes as many steps.
  if (method == march) return glm::uvec3(march_px, march_px, std::min(march_steps, 128));
  return glm::uvec3(width_px, height_px, steps);
}

Need fog_light_needed(const SceneFacts& facts, const FrameRequest& request) {
  if (!request.look.fog) return {false, "the look has no fog (--look)"};
  if (!request.draws_fog()) return {false, "fog is not wanted (--effects)"};
  const bool glows = summed_fog(request.look) > 0 && fog_glows(request.look);
  if (!fog_scatters(request.look) && !glows) return {false, "the fog scatters nothing"};
  if (facts.lights() == 0 && !facts.environment && !request.neutral_light && !glows)
    return {false, "no light is there to be scattered"};
  return {};
}

}  // namespace candela
